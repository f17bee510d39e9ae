//! When a joint path is where: the fastest that the arm's limits allow.
//!
//! Time-optimal path parametrisation by reachability (TOPP-RA, Pham and Pham 2018): the path is a curve q(s), and what is
//! sought is the square of its speed, x = ṡ², on a grid of s. Velocity limits bound x; acceleration limits are linear in
//! x and the path's acceleration u = s̈. A pass from the end to the start finds the largest x from which the end
//! can still be reached at rest, and a pass back accelerates as much as that allows.
//!
//! Such a law jumps in acceleration. The mean of the positions over a short window, sample by sample, makes
//! ramps of the jumps, and keeps the limits of velocity and acceleration, since a mean of values within a limit is within it.
//! What comes out is checked against all limits at every control period, and slowed where it breaks one.
//!
//! Joint torques are not limited here: within these accelerations they stay below what the joints can.

use ramp_robot::arm::{ArmJoint, ArmModel};
use ramp_robot::{DOF, PERIOD};

use crate::space::Joints;
use crate::spline::{Point, Spline};
use crate::trajectory::Trajectory;

/// Grid points for each knot of a path.
const GRID: usize = 4;
/// Fewest grid points of a path: a short one has few knots, but as many phases as a long one.
const FEWEST: usize = 60;
/// Halvings of the interval in which the largest speed is sought: to a billionth of it.
const HALVINGS: usize = 30;
/// Slope below which a joint does not move along the path, rad a knot.
const FLAT: f64 = 1e-9;
/// The least limit of a joint's speed, rad/s: at the end of its range it is zero, and a path that began there would take
/// for ever.
const SLOWEST: f64 = 0.01;
/// Relative error of differences of doubles that still counts as within a limit.
const ROUNDING: f64 = 1e-6;

/// How much of the arm's limits a motion uses, and how soft it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Share of the limits of the joints' velocities, 0 to 1.
    pub velocity: f64,
    /// Share of the limits of their accelerations, 0 to 1.
    pub acceleration: f64,
    /// Share of the limits of their jerks, 0 to 1.
    pub jerk: f64,
    /// Time in which the acceleration may change between its extremes, s: longer where the jerk asks for it.
    pub ramp: f64,
}

/// The limits that motions keep.
#[derive(Clone, Debug)]
pub struct TimeLaw {
    /// Of which the limits of velocity depend on the angle, near the ends of the ranges.
    joints: [ArmJoint; DOF],
    /// Share of those limits.
    share: f64,
    /// rad/s².
    acceleration: Joints,
    /// rad/s³.
    jerk: Joints,
    /// Samples of which each sample of a trajectory is the mean.
    window: usize,
}

/// The largest share of each limit that a trajectory uses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Use {
    /// Of velocity.
    pub velocity: f64,
    /// Of acceleration.
    pub acceleration: f64,
    /// Of jerk.
    pub jerk: f64,
}

impl Use {
    /// By how much time has to be stretched for all of them to be within their limits.
    fn excess(&self) -> f64 {
        self.velocity.max(self.acceleration.sqrt()).max(self.jerk.cbrt())
    }
}

impl TimeLaw {
    /// The law for these shares of the limits of `arm`.
    pub fn new(arm: &ArmModel, pace: &Pace) -> TimeLaw {
        let limits = |limit: fn(&ramp_robot::arm::ArmJoint) -> f64| {
            Joints::from_fn(|joint, _| limit(&arm.joints[joint]))
        };
        let acceleration = limits(|joint| joint.acceleration) * pace.acceleration;
        let jerk = limits(|joint| joint.jerk) * pace.jerk;
        // From full braking to full acceleration.
        let ramp = (2.0 * acceleration).component_div(&jerk).max().max(pace.ramp);
        let window = ((ramp / PERIOD).ceil() as usize).max(1);
        TimeLaw { joints: arm.joints.clone(), share: pace.velocity, acceleration, jerk, window }
    }

    /// The fastest trajectory along the samples of a path, at rest at both ends. The samples, at least one, follow each
    /// other at even distances.
    pub fn time(&self, path: &[Joints]) -> Trajectory {
        let (first, last) = (path[0], path[path.len() - 1]);
        let still = path.iter().all(|q| (q - first).amax() < FLAT);
        if path.len() < 2 || still {
            return Trajectory::resting(last);
        }
        let spline = Spline::new(path);
        let law = Law::fastest(self, &spline);
        let mut stretch = 1.0;
        loop {
            let samples = self.smooth(&law.samples(&spline, stretch));
            let excess = self.used(&samples).excess();
            if excess <= 1.0 + ROUNDING {
                return Trajectory::through(samples).unwrap_or_else(|| Trajectory::resting(last));
            }
            // The mean is not stretched along, so that one step may not be enough.
            stretch *= 1.0 + 1.01 * (excess - 1.0).max(1e-3);
        }
    }

    /// The mean of each sample and those before it in the window; before the start and after the end it rests.
    fn smooth(&self, raw: &[Joints]) -> Vec<Joints> {
        let last = raw.len() - 1;
        let mut sum = raw[0] * self.window as f64;
        let mut smooth = vec![raw[0]];
        for index in 1..raw.len() + self.window - 1 {
            sum += raw[index.min(last)] - raw[index.saturating_sub(self.window)];
            smooth.push(sum / self.window as f64);
        }
        // Free of what sums round.
        let end = smooth.len() - 1;
        smooth[end] = raw[last];
        smooth
    }

    /// How much of these limits a trajectory uses, from differences of its samples, with rest before and after.
    pub fn used(&self, samples: &[Joints]) -> Use {
        let mut used = Use { velocity: 0.0, acceleration: 0.0, jerk: 0.0 };
        let last = samples.len() - 1;
        let mut before = [samples[0]; 3];
        for index in 1..=last + 3 {
            let now = samples[index.min(last)];
            let [a, b, c] = before;
            let share = |change: Joints, order: i32, limits: &Joints| {
                change.component_div(limits).amax() / PERIOD.powi(order)
            };
            let speeds = (now - a) / PERIOD;
            used.velocity = used.velocity.max(speeds.component_div(&self.velocity(&a, &speeds)).amax());
            used.acceleration = used.acceleration.max(share(now - 2.0 * a + b, 2, &self.acceleration));
            used.jerk = used.jerk.max(share(now - 3.0 * a + 3.0 * b - c, 3, &self.jerk));
            before = [now, a, b];
        }
        used
    }
}

/// The speed along a path, on a grid.
struct Law {
    /// Distance between grid points, knots.
    step: f64,
    /// The square of the speed at each grid point, knots²/s².
    squares: Vec<f64>,
    /// When the path is there, s.
    times: Vec<f64>,
}

impl Law {
    fn fastest(limits: &TimeLaw, spline: &Spline) -> Law {
        let count = (spline.end() as usize * GRID).max(FEWEST);
        let step = spline.end() / count as f64;
        let points: Vec<Point> = (0..=count).map(|i| spline.at(i as f64 * step)).collect();
        // Largest squares from which the end can still be reached at rest.
        let mut reach = vec![0.0; count + 1];
        for i in (0..count).rev() {
            let most = |x: f64| {
                let (low, high) = limits.accelerations(&points[i], &points[i + 1], step, x);
                let (stop, go) = (-x / (2.0 * step), (reach[i + 1] - x) / (2.0 * step));
                low.max(stop) <= high.min(go)
            };
            let (mut low, mut high) = (0.0, limits.largest_square(&points[i]));
            if most(high) {
                low = high;
            }
            for _ in 0..HALVINGS {
                let middle = (low + high) / 2.0;
                if most(middle) { low = middle } else { high = middle }
            }
            reach[i] = low;
        }
        let mut squares = vec![0.0; count + 1];
        let mut times = vec![0.0; count + 1];
        for i in 0..count {
            let x: f64 = squares[i];
            let (low, high) = limits.accelerations(&points[i], &points[i + 1], step, x);
            let u = high.min((reach[i + 1] - x) / (2.0 * step)).max(low);
            squares[i + 1] = (x + 2.0 * step * u).clamp(0.0, reach[i + 1]);
            times[i + 1] = times[i] + 2.0 * step / (x.sqrt() + squares[i + 1].sqrt()).max(f64::MIN_POSITIVE);
        }
        Law { step, squares, times }
    }

    /// Joint positions at every control period, with all times stretched by a factor.
    fn samples(&self, spline: &Spline, stretch: f64) -> Vec<Joints> {
        let last = self.times.len() - 1;
        let duration = self.times[last];
        let periods = (duration * stretch / PERIOD).ceil() as usize;
        let mut index = 0;
        let sample = |period: usize| {
            let time = (period as f64 * PERIOD / stretch).min(duration);
            while index + 1 < last && self.times[index + 1] <= time {
                index += 1;
            }
            let passed = time - self.times[index];
            // The acceleration along the path is constant between two grid points.
            let u = (self.squares[index + 1] - self.squares[index]) / (2.0 * self.step);
            let way = passed * (self.squares[index].sqrt() + 0.5 * u * passed);
            spline.at((index as f64 * self.step + way).min((index + 1) as f64 * self.step)).position
        };
        (0..=periods).map(sample).collect()
    }
}

impl TimeLaw {
    /// The largest speeds of the joints at angles `q` (rad) in the directions of `way`, rad/s.
    fn velocity(&self, q: &Joints, way: &Joints) -> Joints {
        Joints::from_fn(|joint, _| {
            let [backwards, forwards] = self.joints[joint].velocity_at(q[joint]);
            let most = if way[joint] < 0.0 { -backwards } else { forwards };
            self.share * most.max(SLOWEST)
        })
    }

    /// The largest square of the speed along the path that keeps the limits of velocity, and those of
    /// acceleration at constant speed.
    fn largest_square(&self, point: &Point) -> f64 {
        let velocity = self.velocity(&point.position, &point.slope);
        (0..DOF)
            .map(|joint| (velocity[joint] / point.slope[joint].abs().max(FLAT)).powi(2))
            .fold(f64::MAX, f64::min)
    }

    /// The range of accelerations along the path at a point that keep the limits there and, with what they make of the
    /// speed `x` (squared), at the next point one `step` on. Empty (low above high) when none does.
    fn accelerations(&self, here: &Point, next: &Point, step: f64, x: f64) -> (f64, f64) {
        let (mut low, mut high) = (f64::MIN, f64::MAX);
        for joint in 0..DOF {
            let limit = self.acceleration[joint];
            // q̈ = slope · u + bend · x, and x grows by 2 step u to the next point.
            let here = (here.slope[joint], here.bend[joint] * x);
            let next = (next.slope[joint] + 2.0 * step * next.bend[joint], next.bend[joint] * x);
            for (factor, rest) in [here, next] {
                if factor.abs() < FLAT {
                    if rest.abs() > limit {
                        return (f64::MAX, f64::MIN);
                    }
                    continue;
                }
                let (a, b) = ((-limit - rest) / factor, (limit - rest) / factor);
                low = low.max(a.min(b));
                high = high.min(a.max(b));
            }
        }
        (low, high)
    }
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use super::*;
    use std::path::Path;

    fn panda() -> ArmModel {
        ArmModel::read(Path::new("../../data/arms/panda.json")).unwrap()
    }

    const ALL: Pace = Pace { velocity: 1.0, acceleration: 1.0, jerk: 1.0, ramp: 0.0 };

    fn waves() -> Vec<Joints> {
        (0..40).map(|i| Joints::from_fn(|j, _| (i as f64 * 0.03 * (1.0 + j as f64 * 0.2)).sin())).collect()
    }

    /// A joint that broke one of its limits would stop a real arm with a reflex.
    #[test]
    fn every_limit_is_kept_at_every_period() {
        let arm = panda();
        let short: Vec<Joints> = (0..3).map(|i| Joints::repeat(i as f64 * 1e-3)).collect();
        let corner: Vec<Joints> = (0..60)
            .map(|i| Joints::from_fn(|j, _| if j == 0 { i.min(30) } else { i.max(30) } as f64 * 0.02))
            .collect();
        let pace = Pace { velocity: 0.9, acceleration: 0.5, jerk: 0.3, ramp: 0.02 };
        for path in [waves(), short, corner] {
            for pace in [ALL, pace] {
                let law = TimeLaw::new(&arm, &pace);
                let trajectory = law.time(&path);
                let used = law.used(trajectory.samples());
                assert!(used.excess() <= 1.0 + ROUNDING, "{used:?}");
                assert!(used.velocity.max(used.acceleration) > 0.9, "slower than it need be: {used:?}");
                assert!((trajectory.samples()[0] - path[0]).amax() < 1e-12);
                assert!((trajectory.end() - path[path.len() - 1]).amax() < 1e-12);
            }
        }
    }

    /// One joint on a straight path: accelerate, go on at the limit, brake. Its time is known.
    #[test]
    fn a_straight_path_takes_the_time_that_it_must() {
        let arm = panda();
        let way = 2.0;
        let path: Vec<Joints> = (0..=20)
            .map(|i| Joints::from_fn(|j, _| if j == 0 { way * f64::from(i) / 20.0 } else { 0.0 }))
            .collect();
        let trajectory = TimeLaw::new(&arm, &ALL).time(&path);
        let (v, a) = (arm.joints[0].velocity, arm.joints[0].acceleration);
        let least = way / v + v / a;
        assert!(
            (0.0..0.02).contains(&(trajectory.duration() - least)),
            "{} for {least}",
            trajectory.duration()
        );
    }

    /// A path that goes nowhere takes no time.
    #[test]
    fn rest_takes_no_time() {
        let q = Joints::repeat(0.3);
        assert_eq!(TimeLaw::new(&panda(), &ALL).time(&[q; 5]).duration(), 0.0);
        assert_eq!(TimeLaw::new(&panda(), &ALL).time(&[q]).end(), q);
    }
}
