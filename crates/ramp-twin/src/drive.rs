//! The drives: from the torques that the inner loops request to those at the joints, and the torque sensors.
//!
//! Requested torques pass the handover from mode to mode, the compensation of friction, the limits of the
//! controller and the [`line`](crate::line) to the motors; [`joint_friction`](crate::joint_friction) brakes
//! the joints. After a period the torque sensors are read, and the external wrench is estimated from them.

use nalgebra::{SMatrix, UnitQuaternion, Vector3, Vector6};
use ramp_control::{
    ArmState, Compensation, Handover, Jacobian, JointVector, Mode, WrenchEstimate, limit_rate, limit_torques,
};
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;
use ramp_robot::{ArmCommand, DOF, PERIOD, RobotError};
use ramp_world::Physics;
use ramp_world::groups::Controller;

use crate::joint_friction::{JointFriction, shares};
use crate::line::Line;

/// Share by which a limit may be exceeded, for rounding.
const ROUNDING: f64 = 1e-6;
/// Readings of the torque sensors at rest before the episode from which their zero is known. Chosen: a tenth
/// of a second.
const ZERO_READINGS: f64 = 100.0;
/// Torque rate from which on it is not limited, N·m/s.
const NO_RATE: f64 = 1e8;

/// The drives of the arm with their sensors.
#[derive(Clone)]
pub(crate) struct Drive {
    /// Deflection of the bristles that hold each joint, rad.
    bristles: JointVector,
    line: Line,
    handover: Handover,
    compensation: Compensation,
    estimate: WrenchEstimate,
    noise: Stream,
    /// Readings of the torque sensors at the start, N·m.
    zero: JointVector,
    /// The torques that were sent last, N·m.
    sent: JointVector,
    /// The torques on the motors in this period, N·m.
    commanded: JointVector,
    /// The torques of friction in this period, N·m.
    braked: JointVector,
    /// Readings of the torque sensors, N·m.
    measured: JointVector,
}

impl Drive {
    /// At rest at `home` (rad).
    pub fn new(physics: &Physics, home: &[f64; DOF], seed: u64) -> Drive {
        let model = JointVector::from_fn(|joint, _| {
            physics.friction.coulomb[joint] * (1.0 + physics.controller.model_error[joint])
        });
        let controller = &physics.controller;
        let mut noise = Stream::new(seed, "torques");
        let sigma = physics.sensing.torque_noise / ZERO_READINGS.sqrt();
        let zero =
            bias(physics, &JointVector::from(*home)) + JointVector::from_fn(|_, _| noise.normal(sigma));
        Drive {
            bristles: JointVector::zeros(),
            line: Line::new(&physics.line, seed),
            handover: Handover::default(),
            compensation: Compensation::new(controller.compensation, controller.compensation_rate, &model),
            estimate: WrenchEstimate::new(physics.sensing.bandwidth),
            noise,
            zero,
            sent: JointVector::zeros(),
            commanded: JointVector::zeros(),
            braked: JointVector::zeros(),
            measured: JointVector::zeros(),
        }
    }

    /// The torques on the motors for one period, N·m, when the inner loop of `command` wants `wanted`.
    ///
    /// # Errors
    /// [`RobotError::TorqueJump`] when torques are commanded that change faster than the controller allows.
    pub fn command(
        &mut self,
        controller: &Controller,
        arm: &ArmModel,
        command: &ArmCommand,
        wanted: JointVector,
    ) -> Result<JointVector, RobotError> {
        let rate = controller.torque_rate;
        if rate >= NO_RATE {
            let torques = limit_torques(arm, wanted + self.compensation.torques());
            self.commanded = self.line.send(torques);
            return Ok(self.commanded);
        }
        let before = self.handover.last();
        let torques = self.handover.over(Mode::of(command), &wanted);
        if let ArmCommand::JointTorques(_) = command {
            for joint in 0..DOF {
                let found = (torques[joint] - before[joint]).abs() / PERIOD;
                if found > rate * (1.0 + ROUNDING) {
                    return Err(RobotError::TorqueJump { joint: joint + 1, rate: found, limit: rate });
                }
            }
        }
        let torques = limit_torques(arm, torques + self.compensation.torques());
        self.sent = limit_rate(&self.sent, &torques, rate);
        self.commanded = self.line.send(self.sent);
        Ok(self.commanded)
    }

    /// Whether the line has been silent for so long that the arm stops.
    pub fn has_stopped(&self) -> bool {
        self.line.has_stopped()
    }

    /// Makes the arm ready again after a stop.
    pub fn restart(&mut self) {
        self.line.restart();
        self.handover = Handover::default();
        self.sent = JointVector::zeros();
    }

    /// The torques that act on the joints in this period beside those of the motors, N·m: friction, and the
    /// weight of a mass that the gravity compensation does not know (kg), at `p_unknown` (m, in the world).
    pub fn load(
        &mut self,
        friction: &JointFriction,
        unknown_mass: f64,
        state: &ArmState,
        p_unknown: &Vector3<f64>,
    ) -> JointVector {
        self.braked = friction.step(&mut self.bristles, &state.velocities);
        let weight = Vector3::new(0.0, 0.0, -unknown_mass * crate::engine::GRAVITY);
        let moment = (p_unknown - state.x_wt.translation.vector).cross(&weight);
        let wrench = Vector6::new(weight.x, weight.y, weight.z, moment.x, moment.y, moment.z);
        self.braked + state.jacobian.transpose() * wrench
    }

    /// Updates the torque sensors after a period. `inertia` (kg·m²) is that of the joints with the drives;
    /// the velocities (rad/s) are those before and after the period, the positions (rad) those before it, and
    /// `coriolis` the torques of Coriolis and centrifugal forces, N·m.
    pub fn sensed(
        &mut self,
        physics: &Physics,
        inertia: &SMatrix<f64, DOF, DOF>,
        [before, after]: [&JointVector; 2],
        coriolis: &JointVector,
        positions: &JointVector,
    ) {
        let accelerations = (after - before) / PERIOD;
        let armature = JointVector::from(physics.arm.armature);
        let viscous = JointVector::from(physics.friction.viscous);
        let drives = armature.component_mul(&accelerations);
        let [motor, _] = shares(&physics.friction);
        let sigma = physics.sensing.torque_noise;
        let noise = JointVector::from_fn(|_, _| self.noise.normal(sigma));
        let link = self.commanded + motor * self.braked - viscous.component_mul(after) - drives;
        self.measured = link + bias(physics, positions) - self.zero + noise;
        self.compensation.sensed(&self.commanded, &self.measured, &drives);
        let links = inertia - SMatrix::<f64, DOF, DOF>::from_diagonal(&armature);
        self.estimate.sensed(&links, &accelerations, coriolis, &self.measured);
    }

    /// Readings of the torque sensors, N·m.
    pub fn torques(&self) -> &JointVector {
        &self.measured
    }

    /// The wrench of the hand on the world at the point of `jacobian` as the arm estimates it, N, N·m.
    pub fn wrench(&self, jacobian: &Jacobian) -> Vector6<f64> {
        self.estimate.wrench(jacobian)
    }

    /// Checks the external force (N) and the estimated external torques against the limits of the reflex
    /// stop.
    ///
    /// # Errors
    /// [`RobotError::Reflex`].
    pub fn check_reflex(&self, controller: &Controller, force: f64) -> Result<(), RobotError> {
        if force > controller.reflex_force {
            let of = "the external force".to_string();
            return Err(RobotError::Reflex { of, value: force, limit: controller.reflex_force, unit: "N" });
        }
        let external = self.estimate.torques();
        for joint in 0..DOF {
            let value = external[joint].abs();
            if value > controller.reflex_torque {
                let of = format!("the external torque of joint {}", joint + 1);
                return Err(RobotError::Reflex { of, value, limit: controller.reflex_torque, unit: "N·m" });
            }
        }
        Ok(())
    }
}

/// Bias of the torque sensors at these positions (rad), N·m.
fn bias(physics: &Physics, positions: &JointVector) -> JointVector {
    let sensing = &physics.sensing;
    JointVector::from_fn(|joint, _| {
        sensing.torque_bias[joint] + sensing.torque_wave[joint] * positions[joint].sin()
    })
}

/// The multiple of `step` that is nearest to `value`; `value` itself without a step.
pub(crate) fn in_steps(value: f64, step: f64) -> f64 {
    if step > 0.0 { (value / step).round() * step } else { value }
}

/// The arm's state by its own model, from joint positions with the errors of its joint sensors, their noise
/// and their step.
pub(crate) fn believed(physics: &Physics, noise: &mut Stream, state: ArmState) -> ArmState {
    let Physics { arm, sensing, .. } = physics;
    let off = JointVector::from_fn(|joint, _| {
        let position = state.positions[joint];
        let mut off = arm.offset[joint] + arm.wave[joint] * (position + arm.wave_begin[joint]).sin();
        if sensing.encoder_noise > 0.0 {
            off += noise.normal(sensing.encoder_noise);
        }
        if sensing.encoder_step > 0.0 {
            off = in_steps(position + off, sensing.encoder_step) - position;
        }
        off
    });
    if off == JointVector::zeros() {
        return state;
    }
    // Milliradians: the tip follows them in a straight line to a micrometre.
    let shift = state.jacobian * off;
    let mut believed = state;
    believed.positions += off;
    believed.x_wt.translation.vector += shift.fixed_rows::<3>(0).into_owned();
    let turn = UnitQuaternion::from_scaled_axis(shift.fixed_rows::<3>(3).into_owned());
    believed.x_wt.rotation = turn * believed.x_wt.rotation;
    believed
}
