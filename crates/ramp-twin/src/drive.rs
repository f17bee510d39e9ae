//! The drives: from the torques that the controller sends to those at the joints, and the torque sensors.
//!
//! Torques pass the [`line`](crate::line) to the motors; [`joint_friction`](crate::joint_friction) brakes the
//! joints. After a period the torque sensors are read, and the external wrench is estimated from them.

use nalgebra::{SMatrix, Vector3, Vector6};
use ramp_control::{ArmState, Jacobian, JointVector, WrenchEstimate};
use ramp_robot::random::Stream;
use ramp_robot::{DOF, GRAVITY, PERIOD, RobotError};
use ramp_world::Physics;
use ramp_world::groups::Controller;

use crate::joint_friction::{JointFriction, shares};
use crate::line::Line;

/// Readings of the torque sensors at rest before the episode from which their zero is known. Chosen: a tenth
/// of a second.
const ZERO_READINGS: f64 = 100.0;
/// The drives of the arm with their sensors.
#[derive(Clone)]
pub(crate) struct Drive {
    /// Deflection of the bristles that hold each joint, rad.
    bristles: JointVector,
    line: Line,
    estimate: WrenchEstimate,
    /// Whether anything was estimated: an arm with a sensor at its wrist may have none in its joints.
    estimated: bool,
    noise: Stream,
    /// Readings of the torque sensors at the start, N·m.
    zero: JointVector,
    /// The torques on the motors in this period, N·m.
    motors: JointVector,
    /// The torques of friction in this period, N·m.
    braked: JointVector,
    /// Readings of the torque sensors, N·m.
    measured: JointVector,
}

impl Drive {
    /// At rest at `home` (rad).
    pub fn new(physics: &Physics, home: &[f64; DOF], seed: u64) -> Drive {
        let mut noise = Stream::new(seed, "torques");
        let sigma = physics.sensing.torque_noise / ZERO_READINGS.sqrt();
        let zero =
            bias(physics, &JointVector::from(*home)) + JointVector::from_fn(|_, _| noise.normal(sigma));
        Drive {
            bristles: JointVector::zeros(),
            line: Line::new(&physics.line, seed),
            estimate: WrenchEstimate::new(physics.sensing.bandwidth),
            estimated: false,
            noise,
            zero,
            motors: JointVector::zeros(),
            braked: JointVector::zeros(),
            measured: JointVector::zeros(),
        }
    }

    /// Sends torques for one period. Returns those on the motors, N·m.
    pub fn command(&mut self, torques: &JointVector) -> JointVector {
        self.motors = self.line.send(*torques);
        self.motors
    }

    /// The arm's own controller sets the torques for one period, without a line between. Returns those on the
    /// motors, N·m.
    pub fn hold(&mut self, torques: &JointVector) -> JointVector {
        self.line.hold(*torques);
        self.motors = *torques;
        self.motors
    }

    /// The torques that the arm received last, N·m.
    pub fn received(&self) -> JointVector {
        self.line.received()
    }

    /// Whether the line has been silent for so long that the arm stops.
    pub fn has_stopped(&self) -> bool {
        self.line.has_stopped()
    }

    /// Makes the arm ready again after a stop.
    pub fn restart(&mut self) {
        self.line.restart();
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
        let weight = Vector3::new(0.0, 0.0, -unknown_mass * GRAVITY);
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
        let link = self.motors + motor * self.braked - viscous.component_mul(after) - drives;
        self.measured = link + bias(physics, positions) - self.zero + noise;
        let links = inertia - SMatrix::<f64, DOF, DOF>::from_diagonal(&armature);
        self.estimated = true;
        self.estimate.sensed(&links, &accelerations, coriolis, &self.measured);
    }

    /// Readings of the torque sensors, N·m.
    pub fn torques(&self) -> &JointVector {
        &self.measured
    }

    /// The external torques on the joints as the arm estimates them, N·m; `None` before there is an estimate.
    pub fn external(&self) -> Option<JointVector> {
        self.estimated.then_some(*self.estimate.torques())
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

/// Joint positions (rad) as the joints report them: with the errors of their sensors, their noise and their
/// step.
pub(crate) fn reported(physics: &Physics, noise: &mut Stream, positions: &JointVector) -> JointVector {
    let Physics { arm, sensing, .. } = physics;
    JointVector::from_fn(|joint, _| {
        let position = positions[joint];
        let mut reported = position + arm.offset[joint];
        reported += arm.wave[joint] * (position + arm.wave_begin[joint]).sin();
        if sensing.encoder_noise > 0.0 {
            reported += noise.normal(sensing.encoder_noise);
        }
        in_steps(reported, sensing.encoder_step)
    })
}
