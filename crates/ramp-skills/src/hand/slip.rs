//! A held part that slips, as tactile sensors in the fingers tell.

use ramp_robot::{GripperCommand, Observation};

use crate::parameters::hand::SlipParameters;

/// Whether the fingers hold a part too weakly for it to stay where it is: both press less than they would
/// under this command, which the gripper has carried out. Fingers without sensors never tell.
pub fn is_loose(seen: &Observation, told: &GripperCommand, parameters: &SlipParameters) -> bool {
    seen.touch.is_some_and(|touch| {
        !seen.gripper_busy
            && told.force > parameters.told
            && touch.fingers.iter().all(|finger| finger.force.y.abs() < parameters.press)
    })
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use nalgebra::Vector3;
    use ramp_robot::{DOF, FingerTouch, Pose, Touch};

    use super::*;
    use crate::parameters::Parameters;

    /// A weak grip is one that was meant to be strong.
    #[test]
    fn a_grip_that_fails_is_told_apart_from_a_gentle_one() {
        let parameters = Parameters::baseline().slip;
        let seen = |press: Option<f64>| Observation {
            time: 0.0,
            positions: [0.0; DOF],
            velocities: [0.0; DOF],
            torques: [0.0; DOF],
            x_wt: Pose::identity(),
            wrench: nalgebra::Vector6::zeros(),
            width: 0.02,
            gripper_busy: false,
            touch: press.map(|press| Touch {
                fingers: [-press, press]
                    .map(|y| FingerTouch { force: Vector3::new(0.0, y, 0.0), centre: None }),
            }),
        };
        let told = |force| GripperCommand { width: 0.0, force };
        assert!(is_loose(&seen(Some(9.0)), &told(60.0), &parameters));
        assert!(!is_loose(&seen(Some(20.0)), &told(60.0), &parameters));
        assert!(!is_loose(&seen(Some(5.0)), &told(5.0), &parameters));
        assert!(!is_loose(&seen(None), &told(60.0), &parameters));
    }
}
