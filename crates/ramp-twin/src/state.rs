//! The part of a twin that changes during an episode. A snapshot is a clone of it, and of MuJoCo's data.

use std::sync::Arc;

use mujoco_rs::prelude::*;
use nalgebra::{Vector3, Vector6};
use ramp_control::{ArmState, GripperLoop, JointVector};
use ramp_robot::random::Stream;
use ramp_robot::{DOF, Observation, PERIOD, RobotError};

use crate::cameras::CamerasState;
use crate::drive::{Drive, in_steps};
use crate::engine::rotation_from_rows;
use crate::fault::{Injector, Start};
use crate::scene::Scene;
use crate::sensors;
use crate::setup::Setup;
use crate::slow_gripper::SlowGripper;
use crate::targets::{START_WIDTH, Targets};
use crate::witness::Witness;

/// Share of a new reading in the wrist sensor's low-pass filter: a time constant of 20 ms.
const WRENCH_FILTER: f64 = 0.05;

type Data = MjData<Arc<MjModel>>;

/// Everything of a twin that changes, except MuJoCo's data.
#[derive(Clone)]
pub(crate) struct State {
    /// Control periods since the episode began.
    pub steps: u64,
    /// The error that stopped the arm. Every later call returns it again.
    pub failed: Option<RobotError>,
    pub targets: Targets,
    pub drive: Drive,
    pub gripper: GripperLoop,
    pub slow_gripper: SlowGripper,
    /// State of the arm as its joint sensors report it.
    pub arm: ArmState,
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
        let arm = sensors::arm_state(scene, data, &mut encoder_noise);
        let wrench = if sensors::has_wrist_sensor(physics) {
            sensors::read_wrist(scene, data)
        } else {
            Vector6::zeros()
        };
        let observation = Observation {
            time: 0.0,
            positions: arm.positions.into(),
            velocities: arm.velocities.into(),
            torques: [0.0; DOF],
            x_wt: arm.x_wt,
            wrench,
            width: START_WIDTH,
            gripper_busy: false,
        };
        State {
            steps: 0,
            failed: None,
            targets: Targets::new(&setup.arm.home),
            drive: Drive::new(physics, &setup.arm.home, setup.seed),
            gripper: GripperLoop::new(START_WIDTH / 2.0),
            slow_gripper: SlowGripper::new(&physics.gripper, START_WIDTH),
            arm,
            torques: JointVector::zeros(),
            wrench,
            encoder_noise,
            wrist_noise: Stream::new(setup.seed, "wrist"),
            reading_noise: Stream::new(setup.seed, "readings"),
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
    /// Updates torques and wrench after a period: the wrench from the sensor at the wrist, or as the arm
    /// estimates it from its joint torques. `before` is the arm before the period, `reading` the noise-free
    /// wrist reading after it.
    pub fn feel(&mut self, scene: &Scene, data: &Data, before: &ArmState, reading: &Vector6<f64>) {
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
            let after = JointVector::from_column_slice(&data.qvel()[..DOF]);
            let velocities = [&before.velocities, &after];
            self.drive.sensed(physics, &before.inertia, velocities, &coriolis, &before.positions);
        }
        if has_torque_sensors {
            self.torques = *self.drive.torques();
        }
        let fault_bias = self.fault_bias(scene, data);
        if sensors::has_wrist_sensor(physics) {
            let wrench = reading + fault_bias + sensors::sensor_bias(scene, data) + noise;
            self.wrench += (wrench - self.wrench) * WRENCH_FILTER;
        } else {
            let jacobian = sensors::wrist_jacobian(scene, data, &self.arm);
            self.wrench = self.drive.wrench(&jacobian) + fault_bias;
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
        let gripper = self.targets.command.as_ref().map(|command| command.gripper);
        let (width, gripper_busy) = match gripper {
            Some(gripper) => self.slow_gripper.sensed(width, gripper),
            None => (width, false),
        };
        self.observation = Observation {
            time: self.time(),
            positions: self.arm.positions.into(),
            velocities: self.arm.velocities.into(),
            torques: self.torques.into(),
            x_wt: self.arm.x_wt,
            wrench: self.wrench,
            width: in_steps(width, scene.physics.gripper.width_step),
            gripper_busy,
        };
    }
}
