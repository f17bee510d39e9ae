//! The command that an agent sends to the robot, once per control period.

use crate::arm::DOF;
use crate::pose::Pose;
use nalgebra::Vector6;

/// The arm's command for the next control period.
#[derive(Clone, Debug, PartialEq)]
pub enum ArmCommand {
    /// Joint positions, rad; the inner loop tracks them stiffly.
    JointPositions([f64; DOF]),
    /// Joint velocities, rad/s.
    JointVelocities([f64; DOF]),
    /// Joint torques on top of gravity compensation, N·m.
    JointTorques([f64; DOF]),
    /// The pose of the tip in the world, tracked stiffly.
    CartesianPose(Pose),
    /// A spring and damper between the tip and a target pose.
    CartesianImpedance(Impedance),
}

/// A Cartesian impedance at the tip, axes of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Impedance {
    /// Equilibrium pose of the spring: the tip in the world. The damper acts relative to this
    /// pose's own motion from command to command.
    pub x_wt: Pose,
    /// Stiffness: three translational, N/m, then three rotational, N·m/rad.
    pub stiffness: Vector6<f64>,
    /// Damping ratio of the spring with the mass the arm shows at its tip; 1 is critical.
    pub damping_ratio: f64,
    /// Wrench added to the spring's, at the tip, axes of the world: force in N, then moment in N·m.
    /// For example, the weight of a held part.
    pub feed_forward: Vector6<f64>,
    /// Preferred joint positions in the arm's null space, rad.
    pub posture: [f64; DOF],
}

/// The gripper's command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GripperCommand {
    /// Wanted distance between the two fingers, m: the sum of the two finger joints, 0 to 0.08.
    pub width: f64,
    /// Largest force of each finger, N.
    pub force: f64,
}

/// One control period's command.
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// The arm's part.
    pub arm: ArmCommand,
    /// The gripper's part.
    pub gripper: GripperCommand,
}
