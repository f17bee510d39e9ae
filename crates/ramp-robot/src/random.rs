//! Random numbers, all from an episode's seed, through named streams.
//!
//! Two streams of one seed are independent. Drawing more numbers from one never changes another, so
//! a new noise source does not change results that do not use it.

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// One named stream of an episode's seed.
///
/// ```
/// let mut layout = ramp_robot::random::Stream::new(1, "layout");
/// let mut again = ramp_robot::random::Stream::new(1, "layout");
/// assert_eq!(layout.uniform(), again.uniform());
/// ```
#[derive(Clone, Debug)]
pub struct Stream(Pcg64Mcg);

impl Stream {
    /// The stream called `name` of `seed`.
    pub fn new(seed: u64, name: &str) -> Stream {
        // FNV-1a over the seed and the name; the generator's own seeding spreads the bits.
        let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
        for byte in seed.to_le_bytes().into_iter().chain(name.bytes()) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
        Stream(Pcg64Mcg::seed_from_u64(hash))
    }

    /// Uniform in 0 ≤ x < 1.
    pub fn uniform(&mut self) -> f64 {
        // 53 random bits fill a double's mantissa.
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform in −a ≤ x < a.
    pub fn symmetric(&mut self, a: f64) -> f64 {
        a * (2.0 * self.uniform() - 1.0)
    }

    /// Normal with mean zero and standard deviation `sigma` (Box and Muller's transform).
    pub fn normal(&mut self, sigma: f64) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        sigma * radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}
