//! The true pose of every part at one moment, and parts that are in each other: passed from a world to the
//! referee, never to an agent.

use ramp_kit::Pose;

/// The true poses, for the referee alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Robot time, s.
    pub time: f64,
    /// Pose of each part's frame in the world. The world names the parts, in the same order.
    pub x_wp: Vec<Pose>,
}

/// Two parts that are in each other: in a simulation, contacts give a little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penetration {
    /// Indices into [`Truth::x_wp`].
    pub parts: [usize; 2],
    /// Depth, m.
    pub depth: f64,
}
