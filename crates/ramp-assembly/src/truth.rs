//! The true pose of every part at one moment: passed from a world to the referee, never to an
//! agent.

use ramp_kit::Pose;

/// The true poses, for the referee alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Robot time, s.
    pub time: f64,
    /// Pose of each part's frame in the world. The world names the parts, in the same order.
    pub x_wp: Vec<Pose>,
}
