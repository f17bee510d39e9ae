//! Rigid poses.

/// A rigid pose; `x_wt` is the pose of the tip T in the world W.
pub type Pose = nalgebra::Isometry3<f64>;
