//! The straight motion with which a beam gets to its place, as a plan gives it.

use nalgebra::Vector3;
use ramp_planner::Entry;

/// Insertion path of a beam: a straight motion.
#[derive(Clone, Debug, PartialEq)]
pub struct InsertionPath {
    /// Its direction in the assembly frame, a unit vector.
    pub direction: Vector3<f64>,
    /// Its length, m: at its start the beam is clear of everything.
    pub distance: f64,
    /// The distance that the beam first goes beyond its place, m.
    pub depth: f64,
}

impl From<&Entry> for InsertionPath {
    fn from(entry: &Entry) -> InsertionPath {
        let Entry { direction, distance, depth, .. } = entry;
        InsertionPath { direction: Vector3::from(*direction), distance: *distance, depth: *depth }
    }
}
