//! The two spaces of motion: poses of the tip and positions of the joints.

/// A rigid pose.
pub type Pose = nalgebra::Isometry3<f64>;

/// Joint positions (rad), or one number for each joint.
pub type Joints = nalgebra::SVector<f64, { ramp_robot::DOF }>;
