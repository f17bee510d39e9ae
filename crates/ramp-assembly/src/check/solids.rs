//! Beams in their goal poses: gaps and overlaps between them.

use crate::assembly::PlacedBeam;
use crate::block::TOUCH;
use crate::sweep::Solid;
use ramp_kit::shape::beam_shapes;

/// The space between two beams.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Index of the first beam.
    pub first: usize,
    /// Index of the second beam.
    pub second: usize,
    /// Its width, m.
    pub width: f64,
}

/// Two beams that overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Index of the first beam.
    pub first: usize,
    /// Index of the second beam.
    pub second: usize,
    /// Depth, m.
    pub depth: f64,
}

/// The beams of an assembly in their goal poses.
pub(crate) struct Solids(Vec<Solid>);

impl Solids {
    /// All beams, in their order.
    pub fn new(beams: &[PlacedBeam]) -> Solids {
        let solid = |placed: &PlacedBeam| Solid::new(&beam_shapes(&placed.beam), &placed.x_ab);
        Solids(beams.iter().map(solid).collect())
    }

    fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        (0..self.0.len()).flat_map(|first| (first + 1..self.0.len()).map(move |second| (first, second)))
    }

    /// The beams that overlap.
    pub fn overlaps(&self) -> Vec<Overlap> {
        let overlap = |(first, second): (usize, usize)| {
            let depth = self.0[first].overlap(&self.0[second], TOUCH)?;
            Some(Overlap { first, second, depth })
        };
        self.pairs().filter_map(overlap).collect()
    }

    /// Whether any of the beams overlap.
    pub fn overlaps_any(&self, first: usize) -> bool {
        let into = |second: usize| self.0[first].overlaps(&self.0[second], TOUCH);
        (0..self.0.len()).any(|second| second != first && into(second))
    }

    /// The smallest gap between two beams, m.
    pub fn gap(&self, first: usize, second: usize) -> f64 {
        self.0[first].gap(&self.0[second])
    }

    /// The two closest beams.
    pub fn smallest_gap(&self) -> Option<Gap> {
        let mut smallest: Option<Gap> = None;
        for (first, second) in self.pairs() {
            let least = self.0[first].least_gap(&self.0[second]);
            if smallest.is_some_and(|gap| gap.width <= least) {
                continue;
            }
            let width = self.gap(first, second);
            if smallest.is_none_or(|gap| width < gap.width) {
                smallest = Some(Gap { first, second, width });
            }
        }
        smallest
    }
}
