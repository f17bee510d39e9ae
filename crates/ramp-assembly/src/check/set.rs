//! Sets of beams, one bit each.

/// Largest number of beams in one goal.
pub const MAX_BEAMS: usize = 256;

const WORDS: usize = MAX_BEAMS / 64;

/// A set of at most [`MAX_BEAMS`] beams.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Set([u64; WORDS]);

impl Set {
    /// The first `count` beams.
    pub(super) fn first(count: usize) -> Set {
        (0..count).fold(Set::default(), Set::with)
    }

    pub(super) fn holds(&self, beam: usize) -> bool {
        self.0[beam / 64] >> (beam % 64) & 1 == 1
    }

    /// The same set with `beam`.
    #[must_use]
    pub(super) fn with(mut self, beam: usize) -> Set {
        self.0[beam / 64] |= 1 << (beam % 64);
        self
    }

    /// The same set without `beam`.
    #[must_use]
    pub(super) fn without(mut self, beam: usize) -> Set {
        self.0[beam / 64] &= !(1 << (beam % 64));
        self
    }

    /// Its beams.
    pub(super) fn beams(self) -> impl Iterator<Item = usize> {
        (0..MAX_BEAMS).filter(move |&beam| self.holds(beam))
    }

    /// Number of beams of this set that are not in the other one.
    pub(super) fn beyond(&self, other: &Set) -> u32 {
        self.0.iter().zip(other.0).map(|(a, b)| (a & !b).count_ones()).sum()
    }
}
