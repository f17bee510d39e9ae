//! Compensation of the friction in the joints, from what their torque sensors measure.
//!
//! The motor's torque is commanded, and the torque on the link is measured. Their difference, less the torque
//! that accelerates the drive itself, is friction. [`Compensation`] tracks it and adds it to the next
//! commands. It needs no model of friction, only a bound. Friction past the sensor is not measured and not
//! compensated.

use ramp_robot::PERIOD;

use crate::state::JointVector;

/// Largest compensation, as a multiple of the controller's model of dry friction: friction that breaks away
/// is more than that of a joint that moves, and the model may be half of it.
const BOUND: f64 = 2.0;

/// Follows the friction before the torque sensors.
#[derive(Clone, Debug)]
pub struct Compensation {
    share: f64,
    /// Share of the difference that is followed each period.
    step: f64,
    /// N·m.
    bound: JointVector,
    /// The friction that is believed, N·m.
    friction: JointVector,
}

impl Compensation {
    /// Compensates `share` of the measured friction, follows it with `rate` (1/s), and never adds more than
    /// twice the dry friction of `model` (N·m).
    pub fn new(share: f64, rate: f64, model: &JointVector) -> Compensation {
        Compensation {
            share,
            step: 1.0 - (-rate * PERIOD).exp(),
            bound: BOUND * model,
            friction: JointVector::zeros(),
        }
    }

    /// Torques to add to those requested at the joints, N·m.
    pub fn torques(&self) -> JointVector {
        self.friction * self.share
    }

    /// Updates after a period with the torques commanded and those measured on the links (N·m), and the
    /// torque that speeds up the drives (N·m).
    pub fn sensed(&mut self, commanded: &JointVector, measured: &JointVector, drives: &JointVector) {
        let lost = commanded - measured - drives;
        self.friction += (lost - self.friction) * self.step;
        self.friction = self.friction.zip_map(&self.bound, |friction, bound| friction.clamp(-bound, bound));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A joint that sticks with 0.8 N·m: the torque on its link reaches the requested one. One that sticks
    /// with more than twice the model is compensated up to the bound.
    #[test]
    fn friction_is_added_up_to_the_bound() {
        for (friction, expected) in [(0.8, 0.8), (3.0, 2.0)] {
            let mut compensation = Compensation::new(1.0, 50.0, &JointVector::repeat(1.0));
            let wanted = JointVector::repeat(0.5);
            for _ in 0..500 {
                let commanded = wanted + compensation.torques();
                let measured = commanded - JointVector::repeat(friction);
                compensation.sensed(&commanded, &measured, &JointVector::zeros());
            }
            assert!((compensation.torques() - JointVector::repeat(expected)).amax() < 1e-6);
        }
    }
}
