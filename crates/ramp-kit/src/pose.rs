//! Rigid poses.

/// A rigid pose of one frame in another. The variable's name gives both: `x_wb` is B in W.
pub type Pose = nalgebra::Isometry3<f64>;
