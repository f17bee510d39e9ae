//! The twin itself: a robot to drive, and the truth for the referee.
//!
//! A twin is a scene that is built once, MuJoCo's data and a state that change, and buffers.

mod rigid;
pub mod served;
pub mod snapshot;

use std::sync::Arc;

use mujoco_rs::prelude::*;
use nalgebra::Vector3;
use ramp_assembly::Truth;
use ramp_render::{Looks, LooksError};
use ramp_robot::{
    Camera, CameraModel, Command, DOF, Image, ImageWidth, Observation, PERIOD, PartReading, Robot,
    RobotError, Track,
};

use crate::broad_phase::BroadPhase;
use crate::drawing::{Drawing, Drawn, Renderers, index};
use crate::engine::body_pose;
use crate::fault::{FaultReport, Injector, Start};
use crate::layout::Layout;
use crate::mjcf::SceneOptions;
use crate::scene::Scene;
pub use crate::sensors::{READING_DROPPED, READING_NOISE, READING_STEPS};
use crate::setup::{Setup, TwinError};
use crate::state::{START_WIDTH, State, Stop};
use crate::witness::Moment;
use crate::{period, rest, sensors, witness};

/// The simulated world with its robot.
pub struct Twin {
    pub(crate) scene: Arc<Scene>,
    pub(crate) data: MjData<Arc<MjModel>>,
    state: State,
    workspace: Workspace,
}

/// Buffers. They carry nothing from one period or image to the next.
struct Workspace {
    broad_phase: BroadPhase,
    renderers: Renderers,
}

impl Workspace {
    fn new(scene: &Scene) -> Workspace {
        Workspace { broad_phase: BroadPhase::new(&scene.model), renderers: Renderers::default() }
    }
}

impl Twin {
    /// Builds the scene and puts every part at its start, or where the setup's state has it.
    ///
    /// # Errors
    /// When MuJoCo refuses the scene.
    pub fn new(setup: &Setup) -> Result<Twin, TwinError> {
        let mut layout = Layout::on_track(setup.assembly, setup.start, setup.track, setup.seed);
        if let Some(state) = setup.state {
            state.place(&mut layout);
        }
        Twin::with_layout(setup, layout)
    }

    /// Builds the scene with every part at its pose in `layout`.
    ///
    /// # Errors
    /// When MuJoCo refuses the scene.
    pub fn with_layout(setup: &Setup, layout: Layout) -> Result<Twin, TwinError> {
        Twin::with_options(setup, layout, &SceneOptions::default())
    }

    /// As [`Twin::with_layout`], with options for the scene. `layout` may leave out parts, but not the
    /// clamped beam.
    ///
    /// # Errors
    /// When MuJoCo refuses the scene, or, on a track that gives images, when meshes and textures for images
    /// cannot be loaded.
    pub fn with_options(setup: &Setup, layout: Layout, options: &SceneOptions) -> Result<Twin, TwinError> {
        if let Some(part) = &layout.unplaced {
            let (start, part) = (setup.start.name.clone(), part.clone());
            return Err(TwinError::NoPlace { start, part });
        }
        let start = Start::new(setup);
        let scene = Scene::new(setup, layout, options, &start)?;
        if setup.track.gives_images() {
            scene.cameras.looks(&scene.arm)?;
        }
        let mut data = MjData::new(Arc::clone(&scene.model));
        data.qpos_mut()[..DOF].copy_from_slice(&setup.arm.home);
        data.qpos_mut()[DOF..DOF + 2].copy_from_slice(&[START_WIDTH / 2.0; 2]);
        data.forward();
        let state = State::new(setup, &start, &scene, &data);
        let workspace = Workspace::new(&scene);
        Ok(Twin { scene: Arc::new(scene), data, state, workspace })
    }

    /// Gives a part that is not clamped a velocity, in axes of the world: of its frame's origin (m/s) and
    /// about it (rad/s). For starts that differ from the sheet's, before [`Twin::begin`].
    pub fn knock(&mut self, part: &str, linear: &Vector3<f64>, angular: &Vector3<f64>) {
        let Some((_, body)) = self.scene.parts.iter().find(|(name, _)| name == part) else { return };
        let Ok(from) = usize::try_from(self.scene.model.body_dofadr()[*body]) else { return };
        // MuJoCo has the angular velocity of a free body in the body's own axes.
        let own_angular = body_pose(&self.data, *body).rotation.inverse() * angular;
        let velocity = &mut self.data.qvel_mut()[from..from + 6];
        velocity[..3].copy_from_slice(linear.as_slice());
        velocity[3..].copy_from_slice(own_angular.as_slice());
    }

    /// Runs `periods` periods with the arm at home.
    ///
    /// # Errors
    /// When the physics diverge.
    pub fn settle(&mut self, periods: u32) -> Result<(), RobotError> {
        self.hold(periods)
    }

    /// Begins the episode: sets the robot time, the deepest penetration and the largest force to zero.
    pub fn begin(&mut self) {
        self.state.steps = 0;
        self.state.deepest = 0.0;
        self.state.largest_force = 0.0;
        self.state.stops.clear();
        self.state.observe(&self.scene, &self.data);
    }

    /// The scene as MJCF, as the engine has it. [`Twin::export`] writes it for other programs.
    pub fn scene(&self) -> &str {
        &self.scene.xml
    }

    /// Distance from the hand's frame to the tip along z, m.
    pub(crate) fn hand_tip(&self) -> f64 {
        self.scene.arm.hand.tip
    }

    /// MuJoCo's model.
    pub fn model(&self) -> &MjModel {
        &self.scene.model
    }

    /// The full physics state: joint positions of the arm, the fingers and all parts.
    pub fn qpos(&self) -> &[f64] {
        self.data.qpos()
    }

    /// Actuator commands of the last step.
    pub fn ctrl(&self) -> &[f64] {
        self.data.ctrl()
    }

    /// Names of all beams and pegs, in the order of [`Truth::x_wp`].
    pub fn part_names(&self) -> impl Iterator<Item = &str> {
        self.scene.parts.iter().map(|(name, _)| name.as_str())
    }

    /// The true poses of all parts.
    pub fn truth(&self) -> Truth {
        self.scene.truth(&self.data, self.state.time())
    }

    /// The deepest contact of a beam or peg with anything now: the names of both, and its depth, m.
    pub fn deepest_contact(&self) -> Option<([String; 2], f64)> {
        self.scene.deepest_contact(&self.data)
    }

    /// Records the true world every `periods` control periods from now on, also within calls that take
    /// longer. [`Twin::moments`] has to be called after each of them: nothing is forgotten.
    pub fn record_moments(&mut self, periods: u64) {
        self.state.witness.every = Some(periods.max(1));
    }

    /// The moments since the last call of this function, in order.
    pub fn moments(&mut self) -> Vec<Moment> {
        std::mem::take(&mut self.state.witness.moments)
    }

    /// The true world now, whether or not a moment is due.
    pub fn moment(&mut self) -> Moment {
        witness::now(&self.scene, &self.data, &mut self.state.witness, self.state.steps)
    }

    /// The true world as it would be if the fingers let go now and the arm were gone, over the next
    /// `seconds`: a moment every `periods` control periods, and one at the end. The last one has the
    /// penetrations of its period. The twin does not change.
    pub fn without_arm(&self, seconds: f64, periods: u64) -> Vec<Moment> {
        rest::without_arm(&self.scene, &self.data, [self.state.time(), seconds], periods)
    }

    /// The true model of a camera, with its error of calibration: to judge perception, never for an agent.
    pub fn true_camera(&self, camera: Camera) -> CameraModel {
        self.scene.cameras.model(camera).clone()
    }

    /// Meshes and textures of all bodies as the cameras of this episode see them, for pictures from any
    /// viewpoint. They are made when they are first asked for, and shared by copies of the twin.
    ///
    /// # Errors
    /// When they cannot be loaded.
    pub fn looks(&self) -> Result<Arc<Looks>, LooksError> {
        self.scene.cameras.looks(&self.scene.arm)
    }

    /// The poses of all bodies that `looks` can draw now, for pictures from any viewpoint.
    pub fn picture(&self, looks: &Looks) -> ramp_render::Scene {
        self.scene.picture(&self.data, looks)
    }

    /// Deepest penetration between two parts in any step so far, m.
    pub fn deepest_penetration(&self) -> f64 {
        self.state.deepest
    }

    /// The largest force between the hand and the objects that it touches or holds so far, N: at the wrist,
    /// after the sensor's filter (time constant 20 ms), without its noise.
    pub fn largest_force(&self) -> f64 {
        self.state.largest_force
    }

    /// The stops so far after which the arm was ready again, in order.
    pub fn stops(&self) -> &[Stop] {
        &self.state.stops
    }

    /// Report of the episode's fault so far; `None` without one.
    pub fn fault(&self) -> Option<&FaultReport> {
        self.state.fault.as_ref().map(Injector::report)
    }

    /// The last command; `None` before the first one.
    pub fn commanded(&self) -> Option<&Command> {
        self.state.command.as_ref()
    }

    /// Robot time, s: counted in steps, so that it carries no rounding error.
    pub fn time(&self) -> f64 {
        self.state.time()
    }

    /// Hash of positions and velocities: equal for two runs only if every bit of their physics state is
    /// equal.
    pub fn state_hash(&self) -> u64 {
        let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
        for value in self.data.qpos().iter().chain(self.data.qvel()) {
            for byte in value.to_bits().to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        }
        hash
    }

    /// Runs periods under the last command; before the first one the arm stays at home. Afterwards a
    /// commanded motion continues as if no period had passed.
    fn hold(&mut self, periods: u32) -> Result<(), RobotError> {
        (0..periods).try_for_each(|_| self.advance(None))
    }

    /// Runs a period under a command, or under the last one.
    fn advance(&mut self, command: Option<&Command>) -> Result<(), RobotError> {
        self.check_running()?;
        let broad_phase = &mut self.workspace.broad_phase;
        let run = period::run(&self.scene, &mut self.data, &mut self.state, broad_phase, command);
        run.inspect_err(|error| self.state.failed = Some(error.clone()))
    }

    /// As [`Twin::hold`] for calls of an agent: the arm may recover from a stop.
    fn hold_recovering(&mut self, periods: u32) -> Result<(), RobotError> {
        self.hold(periods).map_err(|error| self.recovered(error))
    }

    /// Lets the arm stand after a stop by reflex or for the speed of a joint, in a world whose controller
    /// recovers from it. Returns what the agent is told: that the arm is ready again, or what stopped it for
    /// good.
    fn recovered(&mut self, error: RobotError) -> RobotError {
        let recovers = matches!(error, RobotError::Reflex { .. } | RobotError::JointVelocity { .. });
        let begin = self.state.steps;
        let after = self.scene.physics.controller.recovery;
        if !recovers || after <= 0.0 {
            return error;
        }
        self.stand();
        let broad_phase = &mut self.workspace.broad_phase;
        if let Err(error) = period::stand(&self.scene, &mut self.data, &mut self.state, broad_phase, after) {
            self.state.failed = Some(error.clone());
            return error;
        }
        // A new motion begins where the arm stands, wherever it was pushed meanwhile.
        self.stand();
        let why = error.to_string();
        let after = (self.state.steps - begin) as f64 * PERIOD;
        let time = begin as f64 * PERIOD;
        self.state.stops.push(Stop { time, why: why.clone(), after });
        RobotError::Recovered { why, after }
    }

    /// The error that stopped the arm, if one did.
    fn check_running(&self) -> Result<(), RobotError> {
        self.state.failed.clone().map_or(Ok(()), Err)
    }

    /// Refuses images on track `noisy`.
    fn check_images(&self) -> Result<(), RobotError> {
        match self.scene.track {
            Track::Noisy => Err(RobotError::NotOnTrack { track: Track::Noisy, what: "images" }),
            Track::State | Track::Tags | Track::Colour | Track::Depth => Ok(()),
        }
    }

    /// The number of the exposure of which this camera gives an image next: the oldest that waits for it, or
    /// a new one.
    fn exposure(&mut self, camera: Camera) -> usize {
        let now = self.state.steps;
        let cameras = &mut self.state.cameras;
        cameras.shutters.forget(now);
        cameras.shutters.waiting(camera).unwrap_or_else(|| {
            // This camera has delivered all its images, so they are available and make room.
            self.scene.cameras.open(cameras, now, false);
            cameras.shutters.newest()
        })
    }

    /// Everything that the image of a camera takes, from the exposure with this number.
    fn drawing(
        &mut self,
        camera: Camera,
        width: Option<ImageWidth>,
        number: usize,
    ) -> Result<Drawing, RobotError> {
        let stopped = RobotError::CameraStopped { camera };
        let exposure = self.state.cameras.shutters.take(camera, number);
        let Some(middle) = exposure.middle() else { return Err(stopped) };
        let Scene { cameras, arm, .. } = &*self.scene;
        let drawing = cameras.drawing(&mut self.state.cameras, arm, (camera, width), (&exposure, middle));
        drawing.map_err(|_| stopped)
    }

    /// Takes back the sensor of an image that was drawn. Gives the image.
    pub fn drawn(&mut self, drawn: Drawn) -> Image {
        let Drawn { image, eye } = drawn;
        self.state.cameras.eyes[index(image.camera)] = Some(eye);
        image
    }
}

impl Robot for Twin {
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError> {
        self.advance(Some(command)).map_err(|error| self.recovered(error))?;
        Ok(self.state.observation.clone())
    }

    fn observe(&self) -> Observation {
        self.state.observation.clone()
    }

    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        self.check_running()?;
        match self.scene.track {
            Track::State => Ok(sensors::exact_reading(&self.scene, &self.data)),
            Track::Noisy => {
                self.hold_recovering(READING_STEPS)?;
                Ok(sensors::noisy_reading(&self.scene, &self.data, &mut self.state.reading_noise))
            }
            track @ (Track::Tags | Track::Colour | Track::Depth) => {
                Err(RobotError::NotOnTrack { track, what: "poses of parts" })
            }
        }
    }

    fn expose(&mut self) -> Result<(), RobotError> {
        self.check_running()?;
        self.check_images()?;
        self.scene.cameras.open(&mut self.state.cameras, self.state.steps, true);
        Ok(())
    }

    fn look_sized(&mut self, camera: Camera, width: Option<ImageWidth>) -> Result<Image, RobotError> {
        self.check_running()?;
        self.check_images()?;
        let number = self.exposure(camera);
        let wait = self.state.cameras.shutters.available(number).saturating_sub(self.state.steps);
        self.hold_recovering(u32::try_from(wait).unwrap_or(u32::MAX))?;
        let drawing = self.drawing(camera, width, number)?;
        let drawn = drawing.draw(&mut self.workspace.renderers);
        Ok(self.drawn(drawn))
    }

    fn camera(&self, camera: Camera) -> CameraModel {
        CameraModel::nominal(camera, self.scene.arm.hand.tip)
    }
}
