//! Tracking in joint space, and the limits of the joints' torques.

use ramp_robot::DOF;
use ramp_robot::arm::ArmModel;

use crate::state::{ArmState, JointVector};

/// Stiffness of joint tracking, N·m/rad.
const JOINT_STIFFNESS: [f64; DOF] = [4000.0, 4000.0, 3000.0, 3000.0, 1200.0, 1200.0, 600.0];
/// Damping of joint tracking, N·m·s/rad: about critical with the inertia each joint carries.
const JOINT_DAMPING: [f64; DOF] = [140.0, 140.0, 90.0, 90.0, 30.0, 30.0, 16.0];

/// Torques that track joint positions (rad) moving at `velocities` (rad/s) with `accelerations` (rad/s²),
/// N·m. The accelerations are fed forward with the arm's inertia, so that the arm does not lag behind.
pub fn track_joints(
    state: &ArmState,
    positions: &JointVector,
    velocities: &JointVector,
    accelerations: &JointVector,
) -> JointVector {
    let inertial = state.inertia * accelerations;
    JointVector::from_fn(|joint, _| {
        JOINT_STIFFNESS[joint] * (positions[joint] - state.positions[joint])
            + JOINT_DAMPING[joint] * (velocities[joint] - state.velocities[joint])
            + inertial[joint]
    })
}

/// Torques that track joint velocities (rad/s) that change with `accelerations` (rad/s²), N·m.
pub fn track_velocities(
    state: &ArmState,
    velocities: &JointVector,
    accelerations: &JointVector,
) -> JointVector {
    let inertial = state.inertia * accelerations;
    JointVector::from_fn(|joint, _| {
        JOINT_DAMPING[joint] * (velocities[joint] - state.velocities[joint]) + inertial[joint]
    })
}

/// Keeps each torque within its joint's limit, N·m.
pub fn limit_torques(arm: &ArmModel, torques: JointVector) -> JointVector {
    JointVector::from_fn(|joint, _| {
        let limit = arm.joints[joint].torque;
        torques[joint].clamp(-limit, limit)
    })
}
