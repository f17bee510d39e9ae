//! What tactile sensors in the fingers tell: a grip that is too weak, and a part that an open finger touches.

use nalgebra::Vector3;
use ramp_robot::{GripperCommand, PERIOD, Touch};

use crate::parameters::hand::FeltParameters;

/// Forces of both fingers on what they touch, smoothed; N, axes of the tip.
#[derive(Clone, Debug)]
pub struct Felt {
    /// Of each finger.
    forces: [Vector3<f64>; 2],
    /// The same when the fingers last touched nothing: the drift of the sensors.
    nothing: [Vector3<f64>; 2],
}

impl Felt {
    /// Begins with this reading, of fingers that touch nothing.
    pub fn new(touch: &Touch) -> Felt {
        let forces = touch.fingers.map(|finger| finger.force);
        Felt { forces, nothing: forces }
    }

    /// Takes the reading of another control period.
    pub fn sense(&mut self, touch: &Touch, parameters: &FeltParameters) {
        for (felt, finger) in self.forces.iter_mut().zip(&touch.fingers) {
            *felt += (finger.force - *felt) * (PERIOD / parameters.smooth);
        }
    }

    /// The fingers touch nothing now.
    pub fn zero(&mut self) {
        self.nothing = self.forces;
    }

    /// The larger of the forces of both fingers since they touched nothing, N.
    pub fn touched(&self) -> f64 {
        let force = |finger: usize| (self.forces[finger] - self.nothing[finger]).norm();
        force(0).max(force(1))
    }

    /// Whether the fingers hold a part too weakly for it to stay where it is: both press less than they would
    /// under this command, which the gripper has carried out.
    pub fn is_loose(&self, told: &GripperCommand, parameters: &FeltParameters) -> bool {
        told.force > parameters.told && self.forces.iter().all(|force| force.y.abs() < parameters.press)
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

    /// A weak grip is one that was meant to be strong.
    #[test]
    fn a_grip_that_fails_is_told_apart_from_a_gentle_one() {
        let parameters = Parameters::baseline().felt.clone();
        let told = |force| GripperCommand { width: 0.0, force };
        assert!(Felt::new(&touch(9.0)).is_loose(&told(60.0), &parameters));
        assert!(!Felt::new(&touch(20.0)).is_loose(&told(60.0), &parameters));
        assert!(!Felt::new(&touch(5.0)).is_loose(&told(5.0), &parameters));
    }

    /// Drift alone is no contact.
    #[test]
    fn drift_is_not_felt() {
        let parameters = Parameters::baseline().felt.clone();
        let mut felt = Felt::new(&touch(0.7));
        assert!(felt.touched() < 1e-12);
        (0..1000).for_each(|_| felt.sense(&touch(2.0), &parameters));
        assert!((felt.touched() - 1.3).abs() < 1e-6);
        felt.zero();
        assert!(felt.touched() < 1e-12);
    }
}
