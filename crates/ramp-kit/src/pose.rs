//! Rigid poses.

/// A rigid pose: where a frame stands in another. The name of a variable says which: `x_wb` is B in W.
pub type Pose = nalgebra::Isometry3<f64>;
