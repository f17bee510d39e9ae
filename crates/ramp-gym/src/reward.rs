//! Rewards, term by term.

use ramp_abilities::manipulation::Progress;

/// Terms of a reward. Weights are in units of the reward.
#[derive(Clone, Debug, PartialEq)]
pub struct Weights {
    /// For being near: over a whole episode at the place itself.
    pub progress: f64,
    /// At this distance, m, being near is worth nothing.
    pub scale: f64,
    /// For success.
    pub success: f64,
    /// For success at once; less in proportion to the time that has passed.
    pub haste: f64,
    /// For a part that leaves the hand, or an arm that stops: a penalty, given as a positive number.
    pub lost: f64,
    /// For 8 N sideways during a whole episode: a penalty, given as a positive number.
    pub force: f64,
}

impl Weights {
    /// 1 for success and nothing else.
    pub fn sparse() -> Weights {
        Weights { progress: 0.0, scale: 0.04, success: 1.0, haste: 0.0, lost: 0.0, force: 0.0 }
    }

    /// With terms that lead to success.
    pub fn shaped() -> Weights {
        Weights { progress: 1.0, scale: 0.04, success: 1.0, haste: 1.0, lost: 0.3, force: 0.2 }
    }
}

/// The terms of the reward of one step; their sum is the reward.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RewardTerms {
    /// For being near.
    pub progress: f64,
    /// For success, with what haste adds.
    pub success: f64,
    /// For what was lost.
    pub lost: f64,
    /// For pressing sideways.
    pub force: f64,
}

impl RewardTerms {
    /// The reward.
    pub fn sum(&self) -> f64 {
        self.progress + self.success + self.lost + self.force
    }
}

/// Outcome of a step.
pub(crate) struct Outcome {
    pub progress: Progress,
    pub success: bool,
    pub lost: bool,
    /// Force of the hand on the world along the table, N.
    pub sideways: f64,
    /// The share of an episode's time that the step took, and that is left.
    pub took: f64,
    pub left: f64,
}

impl Weights {
    pub(crate) fn terms(&self, outcome: &Outcome) -> RewardTerms {
        let near = (1.0 - outcome.progress.distance() / self.scale).clamp(0.0, 1.0);
        RewardTerms {
            progress: self.progress * near * outcome.took,
            success: if outcome.success { self.success + self.haste * outcome.left } else { 0.0 },
            lost: if outcome.lost { -self.lost } else { 0.0 },
            force: -self.force * (outcome.sideways / 8.0).min(4.0) * outcome.took,
        }
    }
}
