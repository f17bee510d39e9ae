//! What the twin asks of a command before it moves.

use nalgebra::Vector6;
use ramp_robot::{ArmCommand, Command, Impedance, PERIOD, Pose, RobotError};

/// Velocity of a Cartesian target from one period to the next, limited to what can be a motion and not a jump:
/// m/s and rad/s, axes of the world.
pub(crate) fn target_velocity(before: Option<&Pose>, now: &Pose) -> Vector6<f64> {
    const LIMIT: f64 = 0.5;
    let Some(before) = before else { return Vector6::zeros() };
    let shift = (now.translation.vector - before.translation.vector) / PERIOD;
    let turn = (now.rotation * before.rotation.inverse()).scaled_axis() / PERIOD;
    Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z).map(|value| value.clamp(-LIMIT, LIMIT))
}

/// Refuses what is not finite or not sensible, before anything moves.
pub(crate) fn check_command(command: &Command) -> Result<(), RobotError> {
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
