//! Parts that were too deep in each other, until they have been apart.

use nalgebra::Vector3;
use ramp_assembly::{Penetration, Truth};
use ramp_kit::joint::WALL;

/// Largest depth of two parts in each other at which what they pin counts, m: half a wall. A part that went
/// through a wall was deeper.
pub const DEEPEST: f64 = WALL / 2.0;

/// Distance by which two parts have to move relative to each other before a penetration is forgotten, m.
/// Chosen: nearly twice the length of a stem, so a peg is out of its hole.
pub const APART: f64 = 60.0e-3;

/// All penetrations that still matter.
#[derive(Clone, Debug, Default)]
pub(crate) struct Penetrations(Vec<Remembered>);

#[derive(Clone, Debug)]
struct Remembered {
    penetration: Penetration,
    /// Position of the second part in the first one's frame, m.
    offset: Vector3<f64>,
}

/// Position of the second part in the first one's frame, m.
fn offset(truth: &Truth, [one, other]: [usize; 2]) -> Option<Vector3<f64>> {
    Some((truth.x_wp.get(one)?.inverse() * truth.x_wp.get(other)?).translation.vector)
}

impl Penetrations {
    /// Remembers those that are deeper than [`DEEPEST`], each with the poses of `truth`.
    pub fn add(&mut self, truth: &Truth, penetrations: &[Penetration]) {
        for penetration in penetrations.iter().filter(|penetration| penetration.depth > DEEPEST) {
            let Some(offset) = offset(truth, penetration.parts) else { continue };
            match self.0.iter_mut().find(|known| known.penetration.parts == penetration.parts) {
                Some(known) => {
                    known.penetration.depth = known.penetration.depth.max(penetration.depth);
                    known.offset = offset;
                }
                None => self.0.push(Remembered { penetration: *penetration, offset }),
            }
        }
    }

    /// Forgets those of parts that have moved apart.
    pub fn part(&mut self, truth: &Truth) {
        self.0.retain(|known| {
            offset(truth, known.penetration.parts).is_none_or(|now| (now - known.offset).norm() <= APART)
        });
    }

    /// The deepest one of parts that `concern` accepts.
    pub fn deepest(&self, concern: impl Fn([usize; 2]) -> bool) -> Option<Penetration> {
        let concerned = self.0.iter().map(|known| known.penetration).filter(|it| concern(it.parts));
        concerned.max_by(|one, other| one.depth.total_cmp(&other.depth))
    }
}
