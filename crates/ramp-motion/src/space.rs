//! The two spaces of motion: poses of the tip and positions of the joints.

/// A rigid pose.
pub type Pose = nalgebra::Isometry3<f64>;

/// Joint positions (rad), or one number for each joint of an arm with `N` of them.
pub type Joints<const N: usize = { ramp_robot::DOF }> = nalgebra::SVector<f64, N>;
