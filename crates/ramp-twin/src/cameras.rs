//! The twin's cameras: when they expose, how far they are from where the agent is told, and what they are pointed at.

use std::sync::Arc;

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_kit::Kit;
use ramp_render::looks::HOUSING;
use ramp_render::{Looks, LooksError, Renderer, Scene, Sensor};
use ramp_robot::arm::ArmModel;
use ramp_robot::camera::Mount;
use ramp_robot::random::Stream;
use ramp_robot::{Camera, CameraModel, PERIOD, Pose};
use ramp_world::groups;

/// How long the shutter is open, in control periods of a millisecond.
pub const EXPOSURE_STEPS: u32 = 8;

/// A camera as it really is in the episode of this seed: the nominal one with an error of calibration, 1 σ for each axis: m
/// and rad.
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

/// Both cameras of an episode, and what they look at.
pub(crate) struct Cameras {
    kit: Kit,
    arm: ArmModel,
    seed: u64,
    physics: groups::Cameras,
    /// How late each image is.
    jitter: Stream,
    /// A tag that is covered.
    covered: Option<u32>,
    looks: Option<Arc<Looks>>,
    eyes: [Option<Eye>; 2],
}

/// What both cameras saw at one moment; an image is drawn when it is asked for.
#[derive(Clone)]
pub(crate) struct Exposure {
    /// Where everything was; `None` when it cannot be drawn.
    pub scene: Option<Scene>,
    /// The tip in the world.
    pub x_wt: Pose,
    /// Robot time, s.
    pub time: f64,
    /// Whether the cameras give their last images again.
    pub frozen: bool,
    /// The period in which the images are there.
    pub there: u64,
    /// Whose image has been handed out.
    pub taken: Vec<Camera>,
}

/// What changes of the cameras from image to image.
#[derive(Clone)]
pub(crate) struct CamerasState {
    jitter: Stream,
    /// Sensor and last image of each camera that has taken one.
    eyes: [Option<(Sensor, Vec<u8>)>; 2],
}

struct Eye {
    model: CameraModel,
    renderer: Renderer,
    sensor: Sensor,
    /// The image that it took last.
    last: Vec<u8>,
}

impl Cameras {
    pub fn new(
        kit: &Kit,
        arm: &ArmModel,
        seed: u64,
        covered: Option<u32>,
        physics: &groups::Cameras,
    ) -> Cameras {
        Cameras {
            kit: kit.clone(),
            arm: arm.clone(),
            seed,
            physics: physics.clone(),
            jitter: Stream::new(seed, "images"),
            covered,
            looks: None,
            eyes: [None, None],
        }
    }

    /// The same cameras before any image, which share what everything looks like.
    pub fn fresh(&self) -> Cameras {
        let Cameras { kit, arm, seed, physics, jitter, covered, looks, eyes: _ } = self;
        Cameras {
            kit: kit.clone(),
            arm: arm.clone(),
            seed: *seed,
            physics: physics.clone(),
            jitter: jitter.clone(),
            covered: *covered,
            looks: looks.clone(),
            eyes: [None, None],
        }
    }

    /// What changes from image to image.
    pub fn state(&self) -> CamerasState {
        let Cameras { kit: _, arm: _, seed: _, physics: _, jitter, covered: _, looks: _, eyes } = self;
        let eyes = eyes.each_ref().map(|eye| {
            let Eye { model: _, renderer: _, sensor, last } = eye.as_ref()?;
            Some((sensor.clone(), last.clone()))
        });
        CamerasState { jitter: jitter.clone(), eyes }
    }

    /// Takes over a state of cameras of the same episode.
    ///
    /// # Errors
    /// When there is nothing to draw.
    pub fn recall(&mut self, state: &CamerasState) -> Result<(), LooksError> {
        let CamerasState { jitter, eyes } = state;
        self.jitter.clone_from(jitter);
        for (index, saved) in eyes.iter().enumerate() {
            let Some((sensor, last)) = saved else {
                self.eyes[index] = None;
                continue;
            };
            let looks = self.looks()?;
            let model = self.true_camera(if index == 0 { Camera::Wrist } else { Camera::BirdsEye });
            let eye = self.eyes[index].get_or_insert_with(|| Eye {
                renderer: Renderer::new(looks, &model),
                sensor: sensor.clone(),
                model,
                last: Vec::new(),
            });
            eye.sensor.clone_from(sensor);
            eye.last.clone_from(last);
        }
        Ok(())
    }

    /// From the end of the exposure until the agent has the image, in control periods: reading it out and sending it.
    pub fn latency(&mut self) -> u32 {
        let groups::Cameras { latency, jitter, .. } = self.physics;
        let late = if jitter > 0.0 { jitter * self.jitter.uniform() } else { 0.0 };
        ((latency + late) / PERIOD).round() as u32
    }

    /// What everything looks like; made when it is first asked for.
    pub fn looks(&mut self) -> Result<Arc<Looks>, LooksError> {
        if let Some(looks) = &self.looks {
            return Ok(Arc::clone(looks));
        }
        let mut looks = Looks::shared(&self.kit, &self.arm)?;
        if let Some(tag) = self.covered {
            looks = Arc::new(looks.with_covered_tag(tag));
        }
        self.looks = Some(Arc::clone(&looks));
        Ok(looks)
    }

    pub fn true_camera(&self, camera: Camera) -> CameraModel {
        let physics = &self.physics;
        true_camera(camera, &self.arm, self.seed, [physics.position_error, physics.angle_error])
    }

    /// Takes an image: its width, its height, and red, green and blue of each pixel. A frozen camera gives its last
    /// image again, if it has taken one.
    pub fn take(
        &mut self,
        camera: Camera,
        mut scene: Scene,
        x_wt: &Pose,
        frozen: bool,
    ) -> Result<(usize, usize, Vec<u8>), LooksError> {
        let looks = self.looks()?;
        // The wrist camera sits inside its own housing.
        if camera == Camera::Wrist {
            let housing = looks.body(HOUSING);
            scene.bodies.retain(|(index, _)| Some(*index) != housing);
        }
        let (seed, model, light) = (self.seed, self.true_camera(camera), self.physics.light);
        let slot = &mut self.eyes[usize::from(camera == Camera::BirdsEye)];
        let eye = slot.get_or_insert_with(|| Eye {
            renderer: Renderer::new(looks, &model),
            sensor: Sensor::new(seed, camera.name()).with_light(light),
            model,
            last: Vec::new(),
        });
        if !frozen || eye.last.is_empty() {
            eye.last = eye.renderer.render(&scene, &eye.model.x_wc(x_wt), &mut eye.sensor);
        }
        Ok((eye.model.width, eye.model.height, eye.last.clone()))
    }
}
