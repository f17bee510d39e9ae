//! Where every part really is at one moment: what a world tells the referee, and never an agent.

use ramp_kit::Pose;

/// Where everything really is: for the referee alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Robot time, s.
    pub time: f64,
    /// Pose of each part's frame in the world. The world names the parts, in the same order.
    pub x_wp: Vec<Pose>,
}
