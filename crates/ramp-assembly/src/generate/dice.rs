//! Random choices, reproducible from the seed.

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Random choices, all from the seed.
pub(crate) struct Dice(Pcg64Mcg);

impl Dice {
    /// The choices of a seed.
    pub fn new(seed: u64) -> Dice {
        // The generator's own seeding spreads the bits, so neighbouring seeds give unrelated
        // streams.
        Dice(Pcg64Mcg::seed_from_u64(seed ^ 0x7261_6d70_2067_6f61))
    }

    /// A whole number from 0 to `count` − 1; 0 when `count` is 0.
    pub fn below(&mut self, count: usize) -> usize {
        if count == 0 { 0 } else { (self.0.next_u64() % count as u64) as usize }
    }

    /// True with probability 1/`in_all`.
    pub fn once_in(&mut self, in_all: usize) -> bool {
        self.below(in_all) == 0
    }

    /// One element, chosen uniformly.
    pub fn choose<'a, T>(&mut self, from: &'a [T]) -> Option<&'a T> {
        from.get(self.below(from.len()))
    }
}
