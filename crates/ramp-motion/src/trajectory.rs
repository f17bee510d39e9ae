//! A joint path with its times.

use ramp_robot::{DOF, PERIOD};

use crate::space::Joints;

/// Joint positions for every control period, at rest at both ends. Made by a [`TimeLaw`](crate::TimeLaw).
#[derive(Clone, Debug)]
pub struct Trajectory<const N: usize = DOF> {
    /// One for each period, at least one, rad.
    samples: Vec<Joints<N>>,
}

impl<const N: usize> Trajectory<N> {
    /// A trajectory that stays at `q`.
    pub fn resting(q: Joints<N>) -> Trajectory<N> {
        Trajectory { samples: vec![q] }
    }

    /// Through these samples, one for each period; `None` without any.
    pub(crate) fn through(samples: Vec<Joints<N>>) -> Option<Trajectory<N>> {
        (!samples.is_empty()).then_some(Trajectory { samples })
    }

    /// This trajectory and then `next`, which begins where this one ends.
    pub fn then(mut self, next: Trajectory<N>) -> Trajectory<N> {
        self.samples.extend(next.samples.into_iter().skip(1));
        self
    }

    /// s.
    pub fn duration(&self) -> f64 {
        (self.samples.len() - 1) as f64 * PERIOD
    }

    /// Joint positions for every control period, rad.
    pub fn samples(&self) -> &[Joints<N>] {
        &self.samples
    }

    /// Its last joint positions, rad.
    pub fn end(&self) -> Joints<N> {
        self.samples[self.samples.len() - 1]
    }
}
