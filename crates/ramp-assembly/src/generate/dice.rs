//! Random choices, always the same for the same seed.

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Random choices, all from the seed.
pub(crate) struct Dice(Pcg64Mcg);

impl Dice {
    /// The choices of a seed.
    pub fn new(seed: u64) -> Dice {
        // Neighbouring seeds shall not give similar streams: the generator's own seeding spreads the bits.
        Dice(Pcg64Mcg::seed_from_u64(seed ^ 0x7261_6d70_2067_6f61))
    }

    /// A whole number from 0 to `count` − 1; 0 where there is nothing to choose.
    pub fn below(&mut self, count: usize) -> usize {
        if count == 0 { 0 } else { (self.0.next_u64() % count as u64) as usize }
    }

    /// True once in `in_all` times.
    pub fn once_in(&mut self, in_all: usize) -> bool {
        self.below(in_all) == 0
    }

    /// One of these.
    pub fn choose<'a, T>(&mut self, from: &'a [T]) -> Option<&'a T> {
        from.get(self.below(from.len()))
    }
}
