//! The belief about one part, and the detection of deviating readings.

use nalgebra::Vector6;

use super::estimate::Estimate;
use crate::parameters::belief::BeliefParameters;

/// Where a part is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// In the world, where nothing moves it.
    Clamped,
    /// In the world.
    World,
    /// In the tip's frame.
    Tip,
}

/// The belief about one part.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its pose in that frame.
    pub estimate: Estimate,
    /// The frame in which it is known.
    pub frame: Frame,
    /// It was detected, or placed by a known action.
    pub seen: bool,
    /// The last reading, in the same frame, if it was too far off to be believed.
    pub odd: Option<Estimate>,
    /// Images since the last sighting that showed it lying otherwise than is believed.
    pub doubts: usize,
    /// Running mean of the innovations, each whitened by its covariance.
    pub drift: Vector6<f64>,
}

impl Part {
    /// Readings that are each within reason but all on one side say that the part has moved: the estimate
    /// then forgets as much as they differ from it.
    pub fn watch(&mut self, seen: &Estimate, parameters: &BeliefParameters) {
        let Some((white, root)) = self.estimate.whitened(seen) else { return };
        let drift = parameters.drift;
        self.drift += (white - self.drift) * drift;
        // The mean of white noise so weighed has this share of its variance.
        let share = drift / (2.0 - drift);
        if self.drift.norm_squared() / share > parameters.gate {
            let off = root * self.drift;
            self.estimate.spread([off[0], off[1], off[2]], [off[3], off[4], off[5]]);
            self.drift = Vector6::zeros();
        }
    }

    /// Begins to be known in another frame.
    pub fn rebase(&mut self, frame: Frame, estimate: Estimate) {
        self.estimate = estimate;
        self.frame = frame;
        self.odd = None;
        self.drift = Vector6::zeros();
    }
}
