//! Checks of a command before the arm moves.

use ramp_robot::{ArmCommand, Command, Impedance, Pose, RobotError};

/// Refuses values that are not finite or out of range, before the arm moves.
///
/// # Errors
/// [`RobotError::BadCommand`].
pub fn check_command(command: &Command) -> Result<(), RobotError> {
    let finite = |values: &[f64], what| {
        if values.iter().all(|value| value.is_finite()) {
            Ok(())
        } else {
            Err(RobotError::BadCommand { what })
        }
    };
    let pose = |x: &Pose, what| {
        finite(x.translation.vector.as_slice(), what)?;
        finite(x.rotation.coords.as_slice(), what)
    };
    match &command.arm {
        ArmCommand::JointPositions(values) => finite(values, "joint positions")?,
        ArmCommand::JointVelocities(values) => finite(values, "joint velocities")?,
        ArmCommand::JointTorques(values) => finite(values, "joint torques")?,
        ArmCommand::CartesianPose(x) => pose(x, "pose")?,
        ArmCommand::CartesianImpedance(Impedance {
            x_wt,
            stiffness,
            damping_ratio,
            feed_forward,
            posture,
        }) => {
            pose(x_wt, "target pose")?;
            finite(stiffness.as_slice(), "stiffness")?;
            finite(&[*damping_ratio], "damping ratio")?;
            finite(feed_forward.as_slice(), "feed-forward wrench")?;
            finite(posture, "posture")?;
            if stiffness.iter().any(|value| *value < 0.0) || *damping_ratio < 0.0 {
                return Err(RobotError::BadCommand { what: "stiffness or damping ratio" });
            }
        }
    }
    finite(&[command.gripper.width, command.gripper.force], "gripper width or force")?;
    if command.gripper.width < 0.0 || command.gripper.force < 0.0 {
        return Err(RobotError::BadCommand { what: "gripper width or force" });
    }
    Ok(())
}
