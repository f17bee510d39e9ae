//! The twin's cameras: their true poses, and their images.

use std::sync::{Arc, OnceLock};

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_kit::Kit;
use ramp_render::looks::{Difference, HOUSING};
use ramp_render::{Looks, LooksError, Sensor, StereoErrors, StereoSensor};
use ramp_robot::arm::ArmModel;
use ramp_robot::camera::Mount;
use ramp_robot::random::Stream;
use ramp_robot::{Camera, CameraModel, ImageWidth, PERIOD, Pose};
use ramp_world::{Physics, groups};

use crate::drawing::{Drawing, Eye, Pixels, index};
use crate::fault::FaultKind;
use crate::mjcf::{PartShape, Printed};
use crate::setup::Setup;
pub use crate::shutters::EXPOSURE_STEPS;
use crate::shutters::{Exposure, Moment, Shutters};

/// The true camera in the episode of this seed: the nominal one with the errors of its mounting and of its
/// lens that the world has.
pub fn true_camera(camera: Camera, arm: &ArmModel, seed: u64, physics: &groups::Cameras) -> CameraModel {
    let mut stream = Stream::new(seed, &format!("calibration-{}", camera.name()));
    let mut three = |sigma: f64| Vector3::from_fn(|_, _| stream.normal(sigma));
    let (shift, turn) = (three(physics.position_error), three(physics.angle_error));
    let error = Pose::from_parts(Translation3::from(shift), UnitQuaternion::from_scaled_axis(turn));
    let mut model = CameraModel::nominal(camera, arm.hand.tip);
    model.mount = match model.mount {
        Mount::Tip(x_tc) => Mount::Tip(x_tc * error),
        Mount::World(x_wc) => Mount::World(x_wc * error),
    };
    let mut lens = Stream::new(seed, &format!("lens-{}", camera.name()));
    let longer = 1.0 + lens.normal(physics.focal_error);
    model.focal = model.focal.map(|focal| focal * longer);
    model.centre = model.centre.map(|centre| centre + lens.normal(physics.centre_error));
    model
}

/// The errors of the depth sensors in a world.
pub fn stereo_errors(physics: &groups::Cameras) -> StereoErrors {
    let groups::Cameras { depth_noise, depth_bias, depth_spread, depth_holes, .. } = *physics;
    StereoErrors { noise: depth_noise, bias: depth_bias, spread: depth_spread, holes: depth_holes }
}

/// Looks with the shapes, brightness and glints that these parts have in the episode of this seed. In a world
/// in which they are as drawn, they are the same.
pub fn looks_in_world<'a>(
    looks: &Arc<Looks>,
    kit: &Kit,
    parts: impl IntoIterator<Item = &'a str>,
    (world, seed): (&Physics, u64),
) -> Arc<Looks> {
    let printed = Printed { physics: world, seed };
    let drawn: Vec<(&str, Option<PartShape>, f64)> = parts
        .into_iter()
        .map(|name| {
            let mut stream = Stream::new(seed, &format!("tone-{name}"));
            (name, printed.shape(kit, name), 1.0 + stream.symmetric(world.cameras.tone))
        })
        .filter(|(_, shape, tone)| shape.is_some() || *tone != 1.0)
        .collect();
    if drawn.is_empty() && world.cameras.glint == 0.0 {
        return Arc::clone(looks);
    }
    let mut own = Looks::clone(looks).with_glint(world.cameras.glint);
    for (part, shape, tone) in &drawn {
        let place = |p| shape.as_ref().map_or_else(Pose::identity, |shape| shape.place(p));
        let place = shape.is_some().then_some(&place as &dyn Fn(_) -> _);
        own.change(part, &Difference { place, tone: *tone });
    }
    Arc::new(own)
}

/// Both cameras of an episode: everything that does not change.
pub(crate) struct Cameras {
    kit: Kit,
    seed: u64,
    physics: groups::Cameras,
    /// All that the episode drew.
    world: Physics,
    /// A tag that is covered with white.
    covered: Option<u32>,
    /// The beams and pegs of the scene.
    parts: Vec<String>,
    /// Whether tags stick on the parts and are printed on the sheet.
    tags: bool,
    /// Whether images come with depth.
    depth: bool,
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
    /// Sensor and last image of each camera that has taken one, unless an image of it is being drawn.
    pub eyes: [Option<Eye>; 2],
    pub shutters: Shutters,
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
    pub fn new(setup: &Setup, parts: Vec<String>, covered: Option<u32>, world: &Physics) -> Cameras {
        let physics = &world.cameras;
        let model = |camera| true_camera(camera, setup.arm, setup.seed, physics);
        Cameras {
            kit: (*setup.assembly.kit).clone(),
            seed: setup.seed,
            physics: physics.clone(),
            world: world.clone(),
            covered,
            parts,
            tags: setup.track.has_tags(),
            depth: setup.track.has_depth(),
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
        let mut looks = match self.tags {
            true => Looks::shared(&self.kit, arm)?,
            false => Looks::shared_without_tags(&self.kit, arm)?,
        };
        if let Some(tag) = self.covered {
            looks = Arc::new(looks.with_covered_tag(tag));
        }
        let parts = self.parts.iter().map(String::as_str);
        let looks = looks_in_world(&looks, &self.kit, parts, (&self.world, self.seed));
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

    /// Everything that an image of an exposure takes, of the camera's own width or of another one. A camera
    /// that has not given back its last image is not asked for the next.
    ///
    /// # Errors
    /// When meshes and textures cannot be loaded.
    pub fn drawing(
        &self,
        state: &mut CamerasState,
        arm: &ArmModel,
        (camera, width): (Camera, Option<ImageWidth>),
        (exposure, middle): (&Exposure, &Moment),
    ) -> Result<Drawing, LooksError> {
        let looks = self.looks(arm)?;
        // The wrist camera sits inside its own housing.
        let housing = looks.body(HOUSING).filter(|_| camera == Camera::Wrist);
        let model = self.model(camera);
        let eye = state.eyes[index(camera)].take().unwrap_or_else(|| Eye {
            sensor: Sensor::new(self.seed, camera.name()).with_light(self.physics.light),
            stereo: self.depth.then(|| StereoSensor::new(self.seed, camera, stereo_errors(&self.physics))),
            last: Pixels::default(),
        });
        let seen = exposure.shown(camera).into_iter().map(|moment| {
            let mut scene = moment.scene.clone();
            scene.bodies.retain(|(index, _)| Some(*index) != housing);
            (scene, model.x_wc(&moment.x_wt))
        });
        Ok(Drawing {
            camera,
            width,
            time: middle.time,
            x_wt: middle.x_wt,
            frozen: exposure.frozen,
            remembers: self.freeze,
            seen: seen.collect(),
            looks,
            model: model.clone(),
            eye,
        })
    }
}
