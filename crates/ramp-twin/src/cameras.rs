//! The twin's cameras: their true poses, and their images.

use std::sync::{Arc, OnceLock};

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_kit::Kit;
use ramp_render::looks::HOUSING;
use ramp_render::{Looks, LooksError, Renderer, Scene, Sensor};
use ramp_robot::arm::ArmModel;
use ramp_robot::camera::Mount;
use ramp_robot::random::Stream;
use ramp_robot::{Camera, CameraModel, ImageWidth, PERIOD, Pose};
use ramp_world::groups;

use crate::fault::FaultKind;
use crate::setup::Setup;
pub use crate::shutters::EXPOSURE_STEPS;
use crate::shutters::{Exposure, Shutters};

/// The true camera in the episode of this seed: the nominal one with an error of calibration. `position` (m)
/// and `angle` (rad) are the standard deviation of that error for each axis.
pub fn true_camera(camera: Camera, arm: &ArmModel, seed: u64, [position, angle]: [f64; 2]) -> CameraModel {
    let mut stream = Stream::new(seed, &format!("calibration-{}", camera.name()));
    let mut three = |sigma: f64| Vector3::from_fn(|_, _| stream.normal(sigma));
    let error =
        Pose::from_parts(Translation3::from(three(position)), UnitQuaternion::from_scaled_axis(three(angle)));
    let mut model = CameraModel::nominal(camera, arm.hand.tip);
    model.mount = match model.mount {
        Mount::Tip(x_tc) => Mount::Tip(x_tc * error),
        Mount::World(x_wc) => Mount::World(x_wc * error),
    };
    model
}

/// Both cameras of an episode: everything that does not change.
pub(crate) struct Cameras {
    kit: Kit,
    seed: u64,
    physics: groups::Cameras,
    /// A tag that is covered with white.
    covered: Option<u32>,
    /// Whether cameras may freeze.
    freeze: bool,
    /// True models, in the order of [`index`].
    models: [CameraModel; 2],
    /// Meshes and textures of all bodies, loaded when they are first needed.
    looks: OnceLock<Arc<Looks>>,
}

/// The state of both cameras.
#[derive(Clone)]
pub(crate) struct CamerasState {
    /// Random delays of the images.
    jitter: Stream,
    /// Sensor and last image of each camera that has taken one.
    eyes: [Option<Eye>; 2],
    pub shutters: Shutters,
}

#[derive(Clone)]
struct Eye {
    sensor: Sensor,
    /// The last image. Without pixels before the first, and in an episode in which no camera freezes.
    last: Pixels,
}

/// An image without its time and place.
#[derive(Clone, Default)]
pub(crate) struct Pixels {
    pub width: usize,
    pub height: usize,
    /// Red, green and blue of each pixel, row by row from the top left.
    pub rgb: Vec<u8>,
}

impl Pixels {
    /// With another number of pixels: each is the nearest of this image.
    fn with_size(&self, width: usize, height: usize) -> Pixels {
        if (self.width, self.height) == (width, height) {
            return self.clone();
        }
        let nearest = |pixel: usize, count: usize, own: usize| (2 * pixel + 1) * own / (2 * count);
        let mut rgb = Vec::with_capacity(3 * width * height);
        for row in (0..height).map(|row| nearest(row, height, self.height)) {
            for column in (0..width).map(|column| nearest(column, width, self.width)) {
                rgb.extend_from_slice(&self.rgb[3 * (row * self.width + column)..][..3]);
            }
        }
        Pixels { width, height, rgb }
    }
}

/// Renderers of one camera, made when they are first needed: of its own width, and of the last other one.
/// They carry nothing from one image to the next.
#[derive(Default)]
pub(crate) struct CameraRenderers {
    own: Option<Renderer>,
    other: Option<(ImageWidth, Renderer)>,
}

/// Renderers of both cameras.
pub(crate) type Renderers = [CameraRenderers; 2];

impl CameraRenderers {
    /// The renderer for images of this width.
    fn get(&mut self, looks: Arc<Looks>, model: &CameraModel, width: Option<ImageWidth>) -> &mut Renderer {
        let Some(width) = width else {
            return self.own.get_or_insert_with(|| Renderer::new(looks, model));
        };
        if self.other.as_ref().is_some_and(|(last, _)| *last != width) {
            self.other = None;
        }
        &mut self.other.get_or_insert_with(|| (width, Renderer::new(looks, &model.with_width(width)))).1
    }
}

/// Number of a camera in arrays.
fn index(camera: Camera) -> usize {
    usize::from(camera == Camera::BirdsEye)
}

impl CamerasState {
    /// Before any image.
    pub fn new(seed: u64) -> CamerasState {
        CamerasState {
            jitter: Stream::new(seed, "images"),
            eyes: [None, None],
            shutters: Shutters::default(),
        }
    }
}

impl Cameras {
    /// The cameras of an episode, in which one tag may be `covered`.
    pub fn new(setup: &Setup, covered: Option<u32>, physics: &groups::Cameras) -> Cameras {
        let error = [physics.position_error, physics.angle_error];
        let model = |camera| true_camera(camera, setup.arm, setup.seed, error);
        Cameras {
            kit: (*setup.assembly.kit).clone(),
            seed: setup.seed,
            physics: physics.clone(),
            covered,
            freeze: setup.fault.as_ref().is_some_and(|fault| fault.kind == FaultKind::CameraFrozen),
            models: [model(Camera::Wrist), model(Camera::BirdsEye)],
            looks: OnceLock::new(),
        }
    }

    /// The true model of a camera.
    pub fn model(&self, camera: Camera) -> &CameraModel {
        &self.models[index(camera)]
    }

    /// Meshes and textures of all bodies.
    ///
    /// # Errors
    /// When they cannot be loaded.
    pub fn looks(&self, arm: &ArmModel) -> Result<Arc<Looks>, LooksError> {
        if let Some(looks) = self.looks.get() {
            return Ok(Arc::clone(looks));
        }
        let mut looks = Looks::shared(&self.kit, arm)?;
        if let Some(tag) = self.covered {
            looks = Arc::new(looks.with_covered_tag(tag));
        }
        Ok(Arc::clone(self.looks.get_or_init(|| looks)))
    }

    /// Opens the shutters of both cameras as soon as they are free, unless as many exposures as can be kept
    /// still wait for their images. `kept` images stay until they are read.
    pub fn open(&self, state: &mut CamerasState, now: u64, kept: bool) {
        if state.shutters.make_room(now) {
            let latency = self.latency(&mut state.jitter);
            state.shutters.open(now, self.interval(), latency, kept);
        }
    }

    /// Time from the end of an exposure until the agent has the image, in control periods: readout and
    /// transfer.
    fn latency(&self, stream: &mut Stream) -> u32 {
        let groups::Cameras { latency, jitter, .. } = self.physics;
        let late = if jitter > 0.0 { jitter * stream.uniform() } else { 0.0 };
        ((latency + late) / PERIOD).round() as u32
    }

    /// Time from the beginning of an exposure until that of the next, in control periods.
    fn interval(&self) -> u64 {
        ((self.physics.interval / PERIOD).round() as u64).max(u64::from(EXPOSURE_STEPS))
    }

    /// The image of an exposure, of the camera's own width or of another one. A frozen camera repeats its
    /// last image, if it has taken one.
    ///
    /// # Errors
    /// When meshes and textures cannot be loaded.
    pub fn take(
        &self,
        state: &mut CamerasState,
        renderers: &mut Renderers,
        arm: &ArmModel,
        (camera, width): (Camera, Option<ImageWidth>),
        exposure: &Exposure,
    ) -> Result<Pixels, LooksError> {
        let looks = self.looks(arm)?;
        // The wrist camera sits inside its own housing.
        let housing = looks.body(HOUSING).filter(|_| camera == Camera::Wrist);
        let model = self.model(camera);
        let size = width.map_or_else(|| model.clone(), |width| model.with_width(width));
        let eye = state.eyes[index(camera)].get_or_insert_with(|| Eye {
            sensor: Sensor::new(self.seed, camera.name()).with_light(self.physics.light),
            last: Pixels::default(),
        });
        if exposure.frozen && !eye.last.rgb.is_empty() {
            return Ok(eye.last.with_size(size.width, size.height));
        }
        let renderer = renderers[index(camera)].get(looks, model, width);
        let seen = exposure.shown(camera).into_iter().map(|moment| {
            let mut scene = moment.scene.clone();
            scene.bodies.retain(|(index, _)| Some(*index) != housing);
            (scene, model.x_wc(&moment.x_wt))
        });
        let seen: Vec<(Scene, Pose)> = seen.collect();
        let rgb = match &seen[..] {
            [(scene, x_wc)] => renderer.render(scene, x_wc, &mut eye.sensor),
            moving => renderer.render_moving(moving, &mut eye.sensor),
        };
        let image = Pixels { width: size.width, height: size.height, rgb };
        if self.freeze {
            eye.last.clone_from(&image);
        }
        Ok(image)
    }
}
