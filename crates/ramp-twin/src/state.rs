//! The part of a twin that changes during an episode. A snapshot is a clone of it, and of MuJoCo's data.

use std::sync::Arc;

use mujoco_rs::prelude::*;
use nalgebra::{Vector3, Vector6};
use ramp_control::{ArmController, ArmState, ControllerSettings, GripperLoop, JointVector, Sensed};
use ramp_robot::random::Stream;
use ramp_robot::{Command, DOF, GripperCommand, Observation, PERIOD, RobotError};
use ramp_world::Physics;

use crate::cameras::CamerasState;
use crate::drive::{Drive, in_steps};
use crate::engine::rotation_from_rows;
use crate::fault::{Injector, Start};
use crate::scene::Scene;
use crate::sensors;
use crate::setup::Setup;
use crate::slow_gripper::SlowGripper;
use crate::touch::TouchSensors;
use crate::witness::Witness;

/// Share of a new reading in the wrist sensor's low-pass filter: a time constant of 20 ms.
const WRENCH_FILTER: f64 = 0.05;
/// Width of the gripper at the start, m.
pub(crate) const START_WIDTH: f64 = 0.04;
/// Command of the gripper before the first command.
const START_GRIPPER: GripperCommand = GripperCommand { width: START_WIDTH, force: 10.0 };
/// Torque rate from which on it is not limited, N·m/s.
const NO_RATE: f64 = 1e8;

type Data = MjData<Arc<MjModel>>;

/// A stop of the arm after which it was ready again.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    /// Robot time at which it stopped, s.
    pub time: f64,
    /// The error that stopped it.
    pub why: String,
    /// Robot time for which it stood, s.
    pub after: f64,
}

/// The settings of a controller that knows the arm of these physics as the twin's own does.
pub fn controller_settings(physics: &Physics) -> ControllerSettings {
    let controller = &physics.controller;
    let measures = physics.sensing.torque_sensors >= 0.5;
    ControllerSettings {
        armature: JointVector::from(physics.arm.armature),
        friction: JointVector::from_fn(|joint, _| {
            physics.friction.coulomb[joint] * (1.0 + controller.model_error[joint])
        }),
        // Nothing is compensated that is not measured.
        compensation: if measures { controller.compensation } else { 0.0 },
        compensation_rate: controller.compensation_rate,
        torque_rate: (controller.torque_rate < NO_RATE).then_some(controller.torque_rate),
    }
}

/// Everything of a twin that changes, except MuJoCo's data.
#[derive(Clone)]
pub(crate) struct State {
    /// Control periods since the episode began.
    pub steps: u64,
    /// The error that stopped the arm for good. Every later call returns it again.
    pub failed: Option<RobotError>,
    /// The stops after which the arm was ready again.
    pub stops: Vec<Stop>,
    /// The arm's controller, with the state of the arm as its joints report it.
    pub controller: ArmController,
    /// The last command; `None` before the first one.
    pub command: Option<Command>,
    /// The command that the gripper holds.
    pub gripper_command: GripperCommand,
    pub drive: Drive,
    pub gripper: GripperLoop,
    pub slow_gripper: SlowGripper,
    /// Joint torques that the arm reports, N·m.
    pub torques: JointVector,
    /// Wrench of the hand on the world that the arm reports, N and N·m, axes of the world.
    pub wrench: Vector6<f64>,
    /// Noise of the joints' encoders.
    pub encoder_noise: Stream,
    /// Noise of the wrist sensor.
    pub wrist_noise: Stream,
    /// Noise of the readings of parts.
    pub reading_noise: Stream,
    /// The tactile sensors in the fingers; `None` in a world without.
    pub touch: Option<TouchSensors>,
    pub cameras: CamerasState,
    pub fault: Option<Injector>,
    /// Deepest penetration between two parts so far, m.
    pub deepest: f64,
    /// Force of the hand on the world after the sensor's filter, without noise, N.
    pub pressed: Vector3<f64>,
    /// Largest norm of `pressed` so far, N.
    pub largest_force: f64,
    /// The observation of the last period.
    pub observation: Observation,
    /// Recorder of what the referee has to see.
    pub witness: Witness,
}

impl State {
    /// The state at the start, with the arm at rest where `data` has it.
    pub fn new(setup: &Setup, start: &Start, scene: &Scene, data: &Data) -> State {
        let physics = &scene.physics;
        let mut encoder_noise = Stream::new(setup.seed, "encoders");
        let positions = sensors::positions(scene, data, &mut encoder_noise);
        let controller = ArmController::new(&scene.arm, &controller_settings(physics), &positions);
        let arm = controller.state();
        let wrench = if sensors::has_wrist_sensor(physics) {
            sensors::read_wrist(scene, data)
        } else {
            Vector6::zeros()
        };
        let touch = scene.pads.is_some().then(|| TouchSensors::new(physics, setup.seed));
        let observation = Observation {
            time: 0.0,
            positions: arm.positions.into(),
            velocities: arm.velocities.into(),
            torques: [0.0; DOF],
            x_wt: arm.x_wt,
            wrench,
            width: START_WIDTH,
            gripper_busy: false,
            touch: touch.as_ref().map(TouchSensors::reading),
        };
        State {
            steps: 0,
            failed: None,
            stops: Vec::new(),
            command: None,
            gripper_command: START_GRIPPER,
            drive: Drive::new(physics, &setup.arm.home, setup.seed),
            gripper: GripperLoop::new(START_WIDTH / 2.0),
            slow_gripper: SlowGripper::new(&physics.gripper, START_WIDTH),
            controller,
            torques: JointVector::zeros(),
            wrench,
            encoder_noise,
            wrist_noise: Stream::new(setup.seed, "wrist"),
            reading_noise: Stream::new(setup.seed, "readings"),
            touch,
            cameras: CamerasState::new(setup.seed),
            fault: Injector::new(setup, start, scene),
            deepest: 0.0,
            pressed: Vector3::zeros(),
            largest_force: 0.0,
            observation,
            witness: Witness::default(),
        }
    }

    /// Robot time, s: counted in periods, so that it carries no rounding error.
    pub fn time(&self) -> f64 {
        self.steps as f64 * PERIOD
    }

    /// Reads the sensors of the joints and of the wrist after a period. The wrench is that of the sensor at
    /// the wrist, or the one that the arm estimates from its joint torques. `before` is the arm before the
    /// period, `reading` the noise-free wrist reading after it.
    pub fn sense(&mut self, scene: &Scene, data: &Data, before: &ArmState, reading: &Vector6<f64>) {
        let positions = sensors::positions(scene, data, &mut self.encoder_noise);
        let physics = &scene.physics;
        let sensing = &physics.sensing;
        let (force, moment) = (sensing.force_noise, sensing.moment_noise);
        let noise =
            Vector6::from_fn(|axis, _| self.wrist_noise.normal(if axis < 3 { force } else { moment }));
        let has_torque_sensors = sensing.torque_sensors >= 0.5;
        if has_torque_sensors || !sensors::has_wrist_sensor(physics) {
            // Coriolis and centrifugal torques: the engine's bias without the weights that it compensates.
            let coriolis = JointVector::from_column_slice(&data.qfrc_bias()[..DOF])
                - JointVector::from_column_slice(&data.qfrc_gravcomp()[..DOF]);
            let velocities = [&before.velocities, &sensors::velocities(data)];
            self.drive.sensed(physics, &before.inertia, velocities, &coriolis, &before.positions);
        }
        if has_torque_sensors {
            self.torques = *self.drive.torques();
        }
        self.controller.sensed(&Sensed {
            positions,
            velocities: sensors::velocities(data),
            torques: self.torques,
            received: self.drive.received(),
        });
        let fault_bias = self.fault_bias(scene, data);
        if sensors::has_wrist_sensor(physics) {
            let wrench = reading + fault_bias + sensors::sensor_bias(scene, data) + noise;
            self.wrench += (wrench - self.wrench) * WRENCH_FILTER;
        } else {
            let jacobian = sensors::wrist_jacobian(scene.arm.hand.tip, self.controller.state());
            self.wrench = self.drive.wrench(&jacobian) + fault_bias;
        }
        if let (Some(touch), Some(pads)) = (&mut self.touch, &scene.pads) {
            touch.step(pads, physics, data, self.steps);
        }
        self.pressed += (reading.fixed_rows::<3>(0) - self.pressed) * WRENCH_FILTER;
        self.largest_force = self.largest_force.max(self.pressed.norm());
    }

    /// Bias that the injected fault adds to the wrist wrench, N and N·m, axes of the world.
    fn fault_bias(&self, scene: &Scene, data: &Data) -> Vector6<f64> {
        let Some(fault) = &self.fault else { return Vector6::zeros() };
        let force = rotation_from_rows(&data.site_xmat()[scene.wrist_site]) * fault.bias();
        Vector6::new(force.x, force.y, force.z, 0.0, 0.0, 0.0)
    }

    /// Updates the observation.
    pub fn observe(&mut self, scene: &Scene, data: &Data) {
        let width = data.qpos()[DOF] + data.qpos()[DOF + 1];
        let (width, gripper_busy) = self.slow_gripper.sensed(width, self.gripper_command);
        let arm = self.controller.state();
        self.observation = Observation {
            time: self.time(),
            positions: arm.positions.into(),
            velocities: arm.velocities.into(),
            torques: self.torques.into(),
            x_wt: arm.x_wt,
            wrench: self.wrench,
            width: in_steps(width, scene.physics.gripper.width_step),
            gripper_busy,
            touch: self.touch.as_ref().map(TouchSensors::reading),
        };
    }
}
