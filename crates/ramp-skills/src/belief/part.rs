//! The belief about one part, and the detection of deviating readings.

use nalgebra::{Translation3, UnitQuaternion, Vector3, Vector6};

use super::estimate::Estimate;
use crate::Pose;
use crate::grasp::yaw_of;
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
    /// The poses on the outlines on which it may lie at the start; none where it may lie anywhere.
    pub outlines: Vec<Pose>,
    /// The belief before the part was seen.
    pub prior: Estimate,
    /// Its pose when it was first known well, before anything touched it.
    pub found: Option<Pose>,
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

    /// A part that was never seen lies on that of its outlines from which a reading differs least, and one
    /// without outlines where the reading says, on the face on which it is believed to lie.
    pub fn suppose_outline(&mut self, seen: &Estimate) {
        let on = |x: &Pose| Estimate { x: *x, covariance: self.estimate.covariance };
        let surprise = |x: &&Pose| on(x).surprise(seen);
        if let Some(x) = self.outlines.iter().min_by(|a, b| surprise(a).total_cmp(&surprise(b))) {
            self.estimate.x = *x;
        }
        if self.outlines.is_empty() {
            let (at, turn) = (seen.x.translation.vector, yaw_of(&seen.x) - yaw_of(&self.estimate.x));
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
            let height = self.estimate.x.translation.z;
            let there = Translation3::new(at.x, at.y, height);
            self.estimate.x = Pose::from_parts(there, turn * self.estimate.x.rotation);
        }
    }

    /// Keeps the pose as the place where the part was found, once it is known well.
    pub fn find(&mut self, parameters: &BeliefParameters) {
        let covariance = &self.estimate.covariance;
        let across = covariance[(0, 0)].max(covariance[(1, 1)]).sqrt();
        if self.found.is_none() && self.frame == Frame::World && across < parameters.found {
            self.found = Some(self.estimate.x);
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
