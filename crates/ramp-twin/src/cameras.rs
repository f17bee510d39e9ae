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
/// The periods after its opening at which is kept where everything is: the image carries the pose of the middle one, and shows
/// the others together if the hand moved.
const MOMENTS: [u64; 5] = [1, 3, 4, 5, 7];
/// See [`MOMENTS`].
const MIDDLE: usize = 2;
/// A hand that moves no further than this while the shutter is open (m, and rad) blurs nothing: a fifth of a pixel or less.
const AT_REST: (f64, f64) = (1.0e-4, 3.0e-4);

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

/// Where everything was at a moment.
#[derive(Clone)]
pub(crate) struct Moment {
    pub scene: Scene,
    /// The tip in the world.
    pub x_wt: Pose,
    /// Robot time, s.
    pub time: f64,
}

/// What both cameras see while their shutters are open together; an image is drawn when it is asked for.
#[derive(Clone)]
pub(crate) struct Exposure {
    /// The period in which the shutters open.
    begin: u64,
    /// The period in which the images are there.
    pub there: u64,
    /// Asked for ahead of its images: they are kept until somebody wants them.
    pub kept: bool,
    /// At each of [`MOMENTS`] so far; nothing when it cannot be drawn.
    moments: Vec<Moment>,
    /// Whether the cameras give their last images again.
    pub frozen: bool,
    /// Whose image has been handed out.
    pub taken: Vec<Camera>,
}

impl Exposure {
    pub fn new(begin: u64, latency: u32, kept: bool) -> Exposure {
        let there = begin + u64::from(EXPOSURE_STEPS + latency);
        Exposure { begin, there, kept, moments: Vec::new(), frozen: false, taken: Vec::new() }
    }

    /// Does it want to know where everything is at the end of this period?
    pub fn is_due(&self, period: u64) -> bool {
        period.checked_sub(self.begin).is_some_and(|since| MOMENTS.contains(&since))
    }

    /// Takes in where everything is, and whether the cameras are frozen.
    pub fn add(&mut self, moment: Moment, frozen: bool) {
        self.moments.push(moment);
        self.frozen = frozen;
    }

    /// What the images carry: where everything was in the middle.
    pub fn middle(&self) -> Option<&Moment> {
        self.moments.get(MIDDLE)
    }

    /// What is in the images: the middle alone, or where the hand moved the moments before and after.
    fn shown(&self) -> Vec<&Moment> {
        let ([first, .., last], Some(middle)) = (&self.moments[..], self.middle()) else { return Vec::new() };
        let moved = (last.x_wt.translation.vector - first.x_wt.translation.vector).norm();
        if moved < AT_REST.0 && last.x_wt.rotation.angle_to(&first.x_wt.rotation) < AT_REST.1 {
            return vec![middle];
        }
        let aside = self.moments.iter().enumerate().filter(|(index, _)| *index != MIDDLE);
        aside.map(|(_, moment)| moment).collect()
    }
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

    /// From the beginning of an exposure until that of the next, in control periods.
    pub fn interval(&self) -> u64 {
        ((self.physics.interval / PERIOD).round() as u64).max(u64::from(EXPOSURE_STEPS))
    }

    /// Takes an image: its width, its height, and red, green and blue of each pixel. A frozen camera gives its last
    /// image again, if it has taken one.
    pub fn take(
        &mut self,
        camera: Camera,
        exposure: &Exposure,
    ) -> Result<(usize, usize, Vec<u8>), LooksError> {
        let looks = self.looks()?;
        // The wrist camera sits inside its own housing.
        let housing = looks.body(HOUSING).filter(|_| camera == Camera::Wrist);
        let (seed, model, light) = (self.seed, self.true_camera(camera), self.physics.light);
        let slot = &mut self.eyes[usize::from(camera == Camera::BirdsEye)];
        let eye = slot.get_or_insert_with(|| Eye {
            renderer: Renderer::new(looks, &model),
            sensor: Sensor::new(seed, camera.name()).with_light(light),
            model,
            last: Vec::new(),
        });
        if !exposure.frozen || eye.last.is_empty() {
            let seen = exposure.shown().into_iter().map(|moment| {
                let mut scene = moment.scene.clone();
                scene.bodies.retain(|(index, _)| Some(*index) != housing);
                (scene, eye.model.x_wc(&moment.x_wt))
            });
            let seen: Vec<(Scene, Pose)> = seen.collect();
            eye.last = match &seen[..] {
                [(scene, x_wc)] => eye.renderer.render(scene, x_wc, &mut eye.sensor),
                moving => eye.renderer.render_moving(moving, &mut eye.sensor),
            };
        }
        Ok((eye.model.width, eye.model.height, eye.last.clone()))
    }
}
