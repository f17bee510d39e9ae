//! The largest numbers that a command may hold. A command beyond them ends the episode. They are
//! well above the limits of the arm, so that no agent reaches them by accident.

use crate::command::{ArmCommand, Command};
use crate::error::RobotError;

/// Largest force of a finger, N: the maximum of Franka's hand.
pub const GRIPPER_FORCE: f64 = 140.0;
/// Largest commanded distance of the fingers, m; they open to 0.08.
pub const GRIPPER_WIDTH: f64 = 0.1;
/// Largest force, N, and moment or joint torque, N·m; the strongest joint gives 87.
pub const WRENCH: f64 = 1000.0;
/// Largest joint angle, rad, and joint velocity, rad/s.
pub const JOINT: f64 = 10.0;
/// Largest coordinate of a pose, m.
pub const PLACE: f64 = 10.0;
/// Largest stiffness, N/m or N·m/rad.
pub const STIFFNESS: f64 = 1.0e5;
/// Largest damping ratio.
pub const DAMPING_RATIO: f64 = 100.0;

impl Command {
    /// Checks that every number is within the limits of this module. NaN and infinities are left to
    /// the robot.
    ///
    /// # Errors
    /// [`RobotError::TooMuch`] for the first number beyond its limit.
    ///
    /// ```
    /// use ramp_robot::{ArmCommand, Command, GripperCommand};
    /// let gripper = GripperCommand { width: 0.04, force: 1e12 };
    /// let command = Command { arm: ArmCommand::JointTorques([0.0; 7]), gripper };
    /// let error = command.check_limits().unwrap_err();
    /// assert_eq!(error.to_string(), "the command's gripper force is 1e12, above the limit of 140 N");
    /// ```
    pub fn check_limits(&self) -> Result<(), RobotError> {
        match &self.arm {
            ArmCommand::JointPositions(values) => within("joint position", values, JOINT, "rad")?,
            ArmCommand::JointVelocities(values) => within("joint velocity", values, JOINT, "rad/s")?,
            ArmCommand::JointTorques(values) => within("joint torque", values, WRENCH, "N·m")?,
            ArmCommand::CartesianPose(x_wt) => {
                within("pose", x_wt.translation.vector.as_slice(), PLACE, "m")?;
            }
            ArmCommand::CartesianImpedance(it) => {
                within("target pose", it.x_wt.translation.vector.as_slice(), PLACE, "m")?;
                within("stiffness", it.stiffness.as_slice(), STIFFNESS, "N/m or N·m/rad")?;
                within("damping ratio", &[it.damping_ratio], DAMPING_RATIO, "(critical is 1)")?;
                within("feed-forward wrench", it.feed_forward.as_slice(), WRENCH, "N or N·m")?;
                within("posture", &it.posture, JOINT, "rad")?;
            }
        }
        within("gripper width", &[self.gripper.width], GRIPPER_WIDTH, "m")?;
        within("gripper force", &[self.gripper.force], GRIPPER_FORCE, "N")
    }
}

fn within(what: &'static str, values: &[f64], limit: f64, unit: &'static str) -> Result<(), RobotError> {
    match values.iter().find(|value| value.abs() > limit) {
        Some(&value) => Err(RobotError::TooMuch { what, value, limit, unit }),
        None => Ok(()),
    }
}
