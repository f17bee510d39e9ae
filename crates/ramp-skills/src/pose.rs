//! Poses.

/// A rigid pose.
pub type Pose = nalgebra::Isometry3<f64>;
