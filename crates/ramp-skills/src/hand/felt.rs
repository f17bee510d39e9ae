//! The sense of touch of tactile sensors in the fingers: it notices a grip that is too weak.

use nalgebra::Vector3;
use ramp_robot::{GripperCommand, PERIOD, Touch};

use crate::parameters::hand::FeltParameters;

/// Forces of both fingers on what they touch, smoothed; N, axes of the tip.
#[derive(Clone, Debug)]
pub struct Felt([Vector3<f64>; 2]);

impl Felt {
    /// Begins with this reading.
    pub fn new(touch: &Touch) -> Felt {
        Felt(touch.fingers.map(|finger| finger.force))
    }

    /// Takes the reading of another control period.
    pub fn sense(&mut self, touch: &Touch, parameters: &FeltParameters) {
        for (felt, finger) in self.0.iter_mut().zip(&touch.fingers) {
            *felt += (finger.force - *felt) * (PERIOD / parameters.smooth);
        }
    }

    /// Whether the fingers hold a part too weakly for it to stay where it is: both press less than they would
    /// under this command, which the gripper has carried out.
    pub fn is_loose(&self, told: &GripperCommand, parameters: &FeltParameters) -> bool {
        told.force > parameters.told && self.0.iter().all(|force| force.y.abs() < parameters.press)
    }
}

#[cfg(test)]
mod tests {
    use ramp_robot::FingerTouch;

    use super::*;
    use crate::parameters::Parameters;

    fn touch(press: f64) -> Touch {
        Touch {
            fingers: [-press, press].map(|y| FingerTouch { force: Vector3::new(0.0, y, 0.0), centre: None }),
        }
    }

    /// A weak grip is one that was meant to be strong, and lasts longer than a reading or two.
    #[test]
    fn a_grip_that_fails_is_told_apart_from_a_gentle_one() {
        let parameters = Parameters::baseline().felt.clone();
        let told = |force| GripperCommand { width: 0.0, force };
        let mut felt = Felt::new(&touch(20.0));
        assert!(!felt.is_loose(&told(60.0), &parameters));
        (0..10).for_each(|_| felt.sense(&touch(9.0), &parameters));
        assert!(!felt.is_loose(&told(60.0), &parameters));
        (0..90).for_each(|_| felt.sense(&touch(9.0), &parameters));
        assert!(felt.is_loose(&told(60.0), &parameters));
        assert!(!felt.is_loose(&told(5.0), &parameters));
    }
}
