//! Boxes along the axes of a frame, around bodies.

use nalgebra::{Matrix3, Vector3};

/// A box, along the axes of whatever frame it is in.
#[derive(Clone, Copy)]
pub(crate) struct Extent {
    pub centre: Vector3<f64>,
    pub half: Vector3<f64>,
}

impl Extent {
    /// Whether the two have a point in common.
    pub fn touches(&self, other: &Extent) -> bool {
        let (apart, reach) = ((self.centre - other.centre).abs(), self.half + other.half);
        apart.x <= reach.x && apart.y <= reach.y && apart.z <= reach.z
    }

    /// The box around this one, in the world, when its frame is at `at` (m) with the rotation `turn` (rows),
    /// enlarged by `room` (m).
    pub fn placed(&self, at: &[f64; 3], turn: &[f64; 9], room: f64) -> Extent {
        let turn = Matrix3::from_row_slice(turn);
        let centre = Vector3::from(*at) + turn * self.centre;
        Extent { centre, half: turn.abs() * self.half + Vector3::repeat(room) }
    }

    /// The smallest box around two.
    pub fn union(&self, other: &Extent) -> Extent {
        let low = (self.centre - self.half).inf(&(other.centre - other.half));
        let high = (self.centre + self.half).sup(&(other.centre + other.half));
        Extent { centre: (low + high) / 2.0, half: (high - low) / 2.0 }
    }
}
