//! The agent's journal: its events, and observations with which later ones are compared.

use std::collections::BTreeMap;

use nalgebra::Point2;
use ramp_robot::Event;

/// The pose of a beam in the assembly, as far as the table shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// Positions of its ends on the table, m in the world.
    pub ends: [Point2<f64>; 2],
    /// Standard deviation of them, m.
    pub deviation: f64,
}

/// The agent's journal.
#[derive(Clone, Debug, Default)]
pub struct Journal {
    /// Events that are not yet reported.
    pub events: Vec<Event>,
    /// A bias of the wrist sensor was reported.
    pub force_bias: bool,
    /// The beams of the assembly as the hand last left them, by index.
    pub stood: BTreeMap<usize, Stand>,
}
