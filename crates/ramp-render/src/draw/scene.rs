//! Poses of all bodies.

use ramp_robot::Pose;

/// Poses of all bodies.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Index of each body that is there ([`Looks::bodies`](crate::Looks::bodies)) and its pose in the world.
    pub bodies: Vec<(usize, Pose)>,
}
