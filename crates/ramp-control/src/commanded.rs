//! Commanded motions: how a target moves from one command to the next, and whether an arm can be asked for
//! that.
//!
//! A position or a pose is commanded once each period. Differences from the target of the period before give
//! velocity, acceleration and jerk of the command. [`JointMotion`] does so for joints, [`PoseMotion`] for the
//! tip. Their `check` holds them against the arm's limits, as the controller of a real arm does.

use nalgebra::{Vector3, Vector6};
use ramp_robot::arm::{ArmModel, CartesianLimits};
use ramp_robot::{DOF, PERIOD, Pose, RobotError};

use crate::state::JointVector;

/// Largest distance of the first target of a motion from the arm's position, rad. Chosen: the stiffest joint
/// then feels half of its largest torque.
const START: f64 = 0.01;
/// The same for a pose: m, and rad. Chosen: half of a centimetre.
const START_POSE: [f64; 2] = [0.005, 0.02];
/// Share by which a limit may be exceeded, for rounding.
const ROUNDING: f64 = 1e-6;
/// The names and units of the quantities that are checked of a joint.
const OF_JOINT: [(&str, &str); 3] = [("velocity", "rad/s"), ("acceleration", "rad/s²"), ("jerk", "rad/s³")];
/// The same for the tip's point.
const OF_POINT: [(&str, &str); 3] = [("velocity", "m/s"), ("acceleration", "m/s²"), ("jerk", "m/s³")];

/// Joint targets, and how they move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointMotion {
    /// rad.
    pub positions: JointVector,
    /// rad/s.
    pub velocities: JointVector,
    /// rad/s².
    pub accelerations: JointVector,
}

impl JointMotion {
    /// The first target (rad) of a motion, which begins at rest.
    pub fn at_rest(positions: JointVector) -> JointMotion {
        JointMotion { positions, velocities: JointVector::zeros(), accelerations: JointVector::zeros() }
    }

    /// The motion one period later, with its target at `positions` (rad) then.
    pub fn next(&self, positions: JointVector) -> JointMotion {
        let velocities = (positions - self.positions) / PERIOD;
        JointMotion { positions, velocities, accelerations: (velocities - self.velocities) / PERIOD }
    }

    /// Whether an arm can be asked to begin here, when it is at `positions` (rad).
    ///
    /// # Errors
    /// [`RobotError::NotSmooth`].
    pub fn check_start(&self, positions: &JointVector) -> Result<(), RobotError> {
        let off = self.positions - positions;
        for joint in 0..DOF {
            let distance = ("first step", "rad");
            check(|| format!("joint {}", joint + 1), distance, off[joint].abs(), START)?;
        }
        Ok(())
    }

    /// Checks that an arm can continue with this target after `before`.
    ///
    /// # Errors
    /// [`RobotError::NotSmooth`], with the first limit that is broken.
    pub fn check(&self, before: &JointMotion, arm: &ArmModel) -> Result<(), RobotError> {
        for (joint, limits) in arm.joints.iter().enumerate() {
            let velocity = self.velocities[joint];
            let [backward, forward] = limits.velocity_at(self.positions[joint]);
            let fastest = if velocity < 0.0 { -backward } else { forward };
            let jerk = (self.accelerations[joint] - before.accelerations[joint]) / PERIOD;
            let values = [velocity, self.accelerations[joint], jerk];
            let most = [fastest, limits.acceleration, limits.jerk];
            for ((what, value), limit) in OF_JOINT.into_iter().zip(values).zip(most) {
                check(|| format!("joint {}", joint + 1), what, value.abs(), limit)?;
            }
        }
        Ok(())
    }
}

/// A target of the tip, and how it moves, in axes of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseMotion {
    /// In the world.
    pub x_wt: Pose,
    /// m/s, then rad/s.
    pub velocity: Vector6<f64>,
    /// m/s², then rad/s².
    pub acceleration: Vector6<f64>,
}

impl PoseMotion {
    /// The first target of a motion, which begins at rest.
    pub fn at_rest(x_wt: Pose) -> PoseMotion {
        PoseMotion { x_wt, velocity: Vector6::zeros(), acceleration: Vector6::zeros() }
    }

    /// The motion one period later, with its target at `x_wt` then.
    pub fn next(&self, x_wt: Pose) -> PoseMotion {
        let shift = (x_wt.translation.vector - self.x_wt.translation.vector) / PERIOD;
        let turn = (x_wt.rotation * self.x_wt.rotation.inverse()).scaled_axis() / PERIOD;
        let velocity = Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z);
        PoseMotion { x_wt, velocity, acceleration: (velocity - self.velocity) / PERIOD }
    }

    /// Whether an arm can be asked to begin here, when its tip is at `x_wt`.
    ///
    /// # Errors
    /// [`RobotError::NotSmooth`].
    pub fn check_start(&self, x_wt: &Pose) -> Result<(), RobotError> {
        let [most, most_turn] = START_POSE;
        let shift = (self.x_wt.translation.vector - x_wt.translation.vector).norm();
        check(|| "the tip".to_string(), ("first step", "m"), shift, most)?;
        let turn = self.x_wt.rotation.angle_to(&x_wt.rotation);
        check(|| "the tip".to_string(), ("first turn", "rad"), turn, most_turn)
    }

    /// Checks that an arm can continue with this target after `before`.
    ///
    /// # Errors
    /// [`RobotError::NotSmooth`], with the first limit that is broken.
    pub fn check(&self, before: &PoseMotion, limits: &CartesianLimits) -> Result<(), RobotError> {
        let jerk = (self.acceleration - before.acceleration) / PERIOD;
        let most = [limits.velocity, limits.acceleration, limits.jerk];
        for (part, (of, names)) in
            [("the tip", OF_POINT), ("the tip's turn", OF_JOINT)].into_iter().enumerate()
        {
            for ((name, vector), limit) in
                names.into_iter().zip([&self.velocity, &self.acceleration, &jerk]).zip(most)
            {
                let size = Vector3::from(vector.fixed_rows::<3>(3 * part)).norm();
                check(|| of.to_string(), name, size, limit[part])?;
            }
        }
        Ok(())
    }
}

fn check(
    of: impl Fn() -> String,
    (quantity, unit): (&'static str, &'static str),
    value: f64,
    limit: f64,
) -> Result<(), RobotError> {
    if value <= limit * (1.0 + ROUNDING) {
        return Ok(());
    }
    Err(RobotError::NotSmooth { of: of(), quantity, value, limit, unit })
}
