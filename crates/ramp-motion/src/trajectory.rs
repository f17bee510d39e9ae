//! A joint path, timed within the arm's limits.

use ramp_robot::DOF;
use ramp_robot::arm::ArmModel;

use crate::space::Joints;

/// Samples on which a time law is checked against the limits.
const CHECKS: usize = 200;

/// A path through knots, at rest at both ends: a natural cubic spline through the knots and a fifth-order time
/// law along it, slow enough that no joint exceeds its limits.
#[derive(Clone, Debug)]
pub struct Trajectory {
    knots: Vec<Joints>,
    /// Second derivatives at the knots, by knot number.
    bends: Vec<Joints>,
    duration: f64,
}

impl Trajectory {
    /// Times the path through `knots` (at least one) with `share` (0 to 1) of the arm's limits of velocity,
    /// acceleration and jerk.
    pub fn new(arm: &ArmModel, knots: Vec<Joints>, share: f64) -> Trajectory {
        let bends = spline_bends(&knots);
        let mut trajectory = Trajectory { knots, bends, duration: 1.0 };
        // Time scales speed by 1/T, acceleration by 1/T², jerk by 1/T³: one pass over T = 1 gives the least T.
        let mut duration: f64 = 0.0;
        let h = 1.0 / CHECKS as f64;
        let samples: Vec<Joints> = (0..=CHECKS).map(|i| trajectory.at(i as f64 * h)).collect();
        for i in 0..CHECKS {
            let velocity = (samples[i + 1] - samples[i]) / h;
            for joint in 0..DOF {
                duration = duration.max(velocity[joint].abs() / (share * arm.joints[joint].velocity));
            }
            if i + 2 <= CHECKS {
                let acceleration = (samples[i + 2] - 2.0 * samples[i + 1] + samples[i]) / (h * h);
                for joint in 0..DOF {
                    let needed = acceleration[joint].abs() / (share * arm.joints[joint].acceleration);
                    duration = duration.max(needed.sqrt());
                }
            }
            if i + 3 <= CHECKS {
                let change = samples[i + 3] - 3.0 * samples[i + 2] + 3.0 * samples[i + 1] - samples[i];
                for joint in 0..DOF {
                    let needed = (change[joint] / (h * h * h)).abs() / (share * arm.joints[joint].jerk);
                    duration = duration.max(needed.cbrt());
                }
            }
        }
        trajectory.duration = duration;
        trajectory
    }

    /// s.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Joint positions `time` seconds after the start, rad; before and after, those at the ends.
    pub fn at(&self, time: f64) -> Joints {
        let tau = if self.duration > 0.0 { (time / self.duration).clamp(0.0, 1.0) } else { 1.0 };
        // 10 τ³ − 15 τ⁴ + 6 τ⁵: speed and acceleration vanish at both ends.
        let s = tau * tau * tau * (10.0 - tau * (15.0 - 6.0 * tau));
        let last = self.knots.len() - 1;
        let position = s * last as f64;
        let index = (position.floor() as usize).min(last.saturating_sub(1));
        if last == 0 {
            return self.knots[0];
        }
        let b = position - index as f64;
        let a = 1.0 - b;
        self.knots[index] * a
            + self.knots[index + 1] * b
            + (self.bends[index] * (a * a * a - a) + self.bends[index + 1] * (b * b * b - b)) / 6.0
    }
}

/// Second derivatives of the natural cubic spline through equally spaced knots (the tridiagonal system is solved
/// by elimination).
fn spline_bends(knots: &[Joints]) -> Vec<Joints> {
    let n = knots.len();
    let mut bends = vec![Joints::zeros(); n];
    if n < 3 {
        return bends;
    }
    let mut factor = vec![0.0; n];
    let mut right = vec![Joints::zeros(); n];
    for i in 1..n - 1 {
        let pivot = 4.0 - factor[i - 1];
        factor[i] = 1.0 / pivot;
        right[i] = ((knots[i + 1] - 2.0 * knots[i] + knots[i - 1]) * 6.0 - right[i - 1]) / pivot;
    }
    for i in (1..n - 1).rev() {
        bends[i] = right[i] - bends[i + 1] * factor[i];
    }
    bends
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn a_trajectory_keeps_the_limits_and_reaches_its_ends() {
        let arm = ArmModel::read(Path::new("../../data/arms/panda.json")).unwrap();
        let knots: Vec<Joints> = (0..40)
            .map(|i| Joints::from_fn(|j, _| (i as f64 * 0.03 * (1.0 + j as f64 * 0.2)).sin()))
            .collect();
        let (first, last) = (knots[0], knots[39]);
        let trajectory = Trajectory::new(&arm, knots, 1.0);
        assert!((trajectory.at(0.0) - first).norm() < 1e-12);
        assert!((trajectory.at(trajectory.duration()) - last).norm() < 1e-12);
        let h = trajectory.duration() / 1000.0;
        let mut fastest: f64 = 0.0;
        for i in 0..1000 {
            let velocity = (trajectory.at((i + 1) as f64 * h) - trajectory.at(i as f64 * h)) / h;
            for j in 0..DOF {
                let share = velocity[j].abs() / arm.joints[j].velocity;
                assert!(share < 1.02, "joint {j}: {share}");
                fastest = fastest.max(share);
            }
        }
        assert!(fastest > 0.2, "slower than it need be");
    }
}
