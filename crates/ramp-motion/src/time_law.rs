//! When a joint path is where: the fastest that the arm's limits allow.
//!
//! Time-optimal path parametrisation by reachability (TOPP-RA, Pham and Pham 2018): the path is a curve q(s),
//! and the unknown is the square of its speed, x = ṡ², on a grid of s. Velocity limits bound x;
//! acceleration limits are linear in x and the path's acceleration u = s̈. A pass from the end to the start
//! finds the largest x from which the end can still be reached at rest, and a pass back accelerates as much
//! as that allows.
//!
//! Such a law jumps in acceleration. The mean of the positions over a short window, sample by sample, makes
//! ramps of the jumps, and keeps the limits of velocity and acceleration, since a mean of values within a
//! limit is within it. The result is checked against all limits at every control period, and slowed where it
//! exceeds one.
//!
//! Torques are linear in x and u, too: on the way q(s) they are τ = M q′ u + (M q″ + C(q, q′)) x + g. Their
//! limits, and how fast they may change, hold with an empty hand, or with the load of [`TimeLaw::carrying`].
//! The choice between paths ignores them.

use ramp_robot::arm::{ArmJoint, ArmModel};
use ramp_robot::{DOF, PERIOD};

use crate::dynamics::{Dynamics, Inertia};
use crate::space::Joints;
use crate::spline::{Point, Spline};
use crate::trajectory::Trajectory;

/// Grid points for each knot of a path.
const GRID: usize = 4;
/// Fewest grid points of a path: a short one has few knots, but as many phases as a long one.
const FEWEST: usize = 60;
/// Most steps in which the largest speed at a point is found; it takes two or three.
const LARGEST_TURNS: usize = 50;
/// Share of that speed (squared) that is used.
const SHORT: f64 = 1.0 - 1e-9;
/// Slope below which a joint does not move along the path, rad a knot.
const FLAT: f64 = 1e-9;
/// The least limit of a joint's speed, rad/s: at the end of its range it is zero, and a path that began there
/// would take for ever.
const SLOWEST: f64 = 0.01;
/// Factor on the length of a ramp for the largest torque jump: another jump may be near. Chosen.
const ENOUGH: f64 = 1.05;
/// Factor by which a ramp grows in one iteration where torques change too fast.
const WIDER: f64 = 8.0;
/// The longest ramp that the rate of torque makes, in control periods: 0.2 s. After that the motion becomes
/// slower.
const WIDEST: usize = 200;
/// Share of a joint's torque that counts as left where gravity takes more: such an arm moves slowly.
const LEFT: f64 = 0.05;
/// Relative error of differences of doubles that still counts as within a limit.
const ROUNDING: f64 = 1e-6;

/// Share of the arm's limits that a motion uses, and its smoothness.
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
pub struct TimeLaw<const N: usize = DOF> {
    /// Of which the limits of velocity depend on the angle, near the ends of the ranges.
    joints: [ArmJoint; N],
    /// Share of those limits.
    share: f64,
    /// rad/s².
    acceleration: Joints<N>,
    /// rad/s³.
    jerk: Joints<N>,
    /// N·m, and N·m/s.
    torque: Joints<N>,
    torque_rate: Joints<N>,
    dynamics: Dynamics<N>,
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
    /// Of torque: of what gravity leaves of it, where it takes more than all.
    pub torque: f64,
    /// Of the rate of torque.
    pub torque_rate: f64,
}

impl Use {
    /// Factor by which time must be stretched so that all of them are within their limits.
    fn excess(&self) -> f64 {
        let second = self.acceleration.max(self.torque).sqrt();
        self.velocity.max(second).max(self.jerk.max(self.torque_rate).cbrt())
    }
}

impl<const N: usize> TimeLaw<N> {
    /// The law for these shares of the limits of `arm`.
    pub fn new(arm: &ArmModel<N>, pace: &Pace) -> TimeLaw<N> {
        let limits = |limit: fn(&ramp_robot::arm::ArmJoint) -> f64| {
            Joints::<N>::from_fn(|joint, _| limit(&arm.joints[joint]))
        };
        let acceleration = limits(|joint| joint.acceleration) * pace.acceleration;
        let jerk = limits(|joint| joint.jerk) * pace.jerk;
        // From full braking to full acceleration.
        let ramp = (2.0 * acceleration).component_div(&jerk).max().max(pace.ramp);
        let window = ((ramp / PERIOD).ceil() as usize).max(1);
        TimeLaw {
            joints: arm.joints.clone(),
            share: pace.velocity,
            acceleration,
            jerk,
            torque: limits(|joint| joint.torque),
            torque_rate: limits(|joint| joint.torque_rate),
            dynamics: Dynamics::new(arm),
            window,
        }
    }

    /// The same with `load` in the hand, given in the tip's frame.
    #[must_use]
    pub fn carrying(mut self, load: &Inertia) -> TimeLaw<N> {
        self.dynamics = self.dynamics.carrying(load);
        self
    }

    /// The fastest trajectory along the samples of a path, at rest at both ends. The samples, at least one,
    /// follow each other at even distances.
    pub fn time(&self, path: &[Joints<N>]) -> Trajectory<N> {
        let (first, last) = (path[0], path[path.len() - 1]);
        let still = path.iter().all(|q| (q - first).amax() < FLAT);
        if path.len() < 2 || still {
            return Trajectory::resting(last);
        }
        let spline = Spline::new(path);
        let count = (spline.end() as usize * GRID).max(FEWEST);
        let law = Law::fastest(self, &spline, count, true);
        let jump = (ENOUGH * law.jump / PERIOD).ceil() as usize;
        let (mut stretch, mut window) = (1.0, self.window.max(jump.min(WIDEST)));
        loop {
            let samples = smooth(&law.samples(&spline, stretch), window);
            let used = self.used(&samples);
            if used.excess() <= 1.0 + ROUNDING {
                return Trajectory::through(samples).unwrap_or_else(|| Trajectory::resting(last));
            }
            // A jump of acceleration is one of torque, which a longer ramp makes slower.
            let rate = used.torque_rate.min(WIDER);
            if rate > 1.0 && window < WIDEST {
                window = ((window as f64 * rate * 1.01).ceil() as usize).min(WIDEST);
                continue;
            }
            // The mean is not stretched along, so that one step may not be enough.
            stretch *= 1.0 + 1.01 * (used.excess() - 1.0).max(1e-3);
        }
    }

    /// About the time along the samples of a path, s: the law on a coarser grid.
    pub(crate) fn estimate(&self, path: &[Joints<N>]) -> f64 {
        if path.len() < 2 {
            return 0.0;
        }
        let spline = Spline::new(path);
        let law = Law::fastest(self, &spline, path.len() - 1, false);
        law.times[path.len() - 1] + self.window as f64 * PERIOD
    }

    /// A lower bound on the time between joint positions, s: each joint straight from rest to rest.
    pub fn least_time(&self, from: &Joints<N>, to: &Joints<N>) -> f64 {
        let joint = |joint: usize| {
            let (way, a) = ((to[joint] - from[joint]).abs(), self.acceleration[joint]);
            let v = self.share * self.joints[joint].velocity;
            if way < v * v / a { 2.0 * (way / a).sqrt() } else { way / v + v / a }
        };
        (0..N).map(joint).fold(0.0, f64::max)
    }

    /// A lower bound on the time along a path, s: from each sample to the next at the largest speeds.
    pub(crate) fn least_along(&self, path: &[Joints<N>]) -> f64 {
        let speeds = Joints::from_fn(|joint, _| self.share * self.joints[joint].velocity);
        path.windows(2).map(|pair| (pair[1] - pair[0]).component_div(&speeds).amax()).sum()
    }

    /// Share of these limits that a trajectory uses, from differences of its samples, with rest before and
    /// after.
    pub fn used(&self, samples: &[Joints<N>]) -> Use {
        let mut used = Use { velocity: 0.0, acceleration: 0.0, jerk: 0.0, torque: 0.0, torque_rate: 0.0 };
        let last = samples.len() - 1;
        let mut torques = self.dynamics.at(&samples[0]).holding();
        let mut before = [samples[0]; 3];
        for index in 1..=last + 3 {
            let now = samples[index.min(last)];
            let [a, b, c] = before;
            let share = |change: Joints<N>, order: i32, limits: &Joints<N>| {
                change.component_div(limits).amax() / PERIOD.powi(order)
            };
            let speeds = (now - a) / PERIOD;
            used.velocity = used.velocity.max(speeds.component_div(&self.velocity(&a, &speeds)).amax());
            used.acceleration = used.acceleration.max(share(now - 2.0 * a + b, 2, &self.acceleration));
            used.jerk = used.jerk.max(share(now - 3.0 * a + 3.0 * b - c, 3, &self.jerk));
            // At the sample before this one, from those on both sides of it.
            let (speeds, gains) = ((now - b) / (2.0 * PERIOD), (now - 2.0 * a + b) / (PERIOD * PERIOD));
            let asked = self.torques(&a, &speeds, &gains);
            used.torque = used.torque.max(asked.1);
            let change = (asked.0 - torques).component_div(&self.torque_rate).amax() / PERIOD;
            used.torque_rate = used.torque_rate.max(change);
            torques = asked.0;
            before = [now, a, b];
        }
        used
    }

    /// The torques of a motion, N·m, and the largest share of their limits; where one is broken, of what
    /// gravity leaves.
    fn torques(&self, q: &Joints<N>, speeds: &Joints<N>, gains: &Joints<N>) -> (Joints<N>, f64) {
        let chain = self.dynamics.at(q);
        let torques = chain.torques(speeds, gains);
        let share = torques.component_div(&self.torque).amax();
        if share <= 1.0 {
            return (torques, share);
        }
        let holding = chain.holding();
        let shares = Joints::<N>::from_fn(|joint, _| {
            let moving = torques[joint] - holding[joint];
            moving.abs() / self.left(joint, holding[joint] * moving.signum())
        });
        (torques, shares.amax())
    }

    /// The torque of a joint that is left where gravity asks for `holding` in the same direction, N·m.
    fn left(&self, joint: usize, holding: f64) -> f64 {
        (self.torque[joint] - holding).max(LEFT * self.torque[joint])
    }
}

/// A limit of a joint's acceleration or torque: low ≤ factor · u + bend · x ≤ high, with low < 0 < high.
#[derive(Clone, Copy)]
struct Bound {
    factor: f64,
    bend: f64,
    low: f64,
    high: f64,
}

/// The limits that hold at a point of a path, one for each joint: of acceleration there, of acceleration at
/// the next point, and of torque.
type Bounds<const N: usize> = [[Bound; N]; 3];

/// The mean of each sample and those before it in a window; before the start and after the end it rests.
fn smooth<const N: usize>(raw: &[Joints<N>], window: usize) -> Vec<Joints<N>> {
    let last = raw.len() - 1;
    let mut sum = raw[0] * window as f64;
    let mut smooth = vec![raw[0]];
    for index in 1..raw.len() + window - 1 {
        sum += raw[index.min(last)] - raw[index.saturating_sub(window)];
        smooth.push(sum / window as f64);
    }
    // Free of what sums round.
    let end = smooth.len() - 1;
    smooth[end] = raw[last];
    smooth
}

/// The speed along a path, on a grid.
struct Law {
    /// Distance between grid points, knots.
    step: f64,
    /// The square of the speed at each grid point, knots²/s².
    squares: Vec<f64>,
    /// When the path is there, s.
    times: Vec<f64>,
    /// The longest time that a jump of torque takes at the largest rate, s.
    jump: f64,
}

impl Law {
    /// With a number of grid steps, with or without torque limits.
    fn fastest<const N: usize>(limits: &TimeLaw<N>, spline: &Spline<N>, count: usize, torques: bool) -> Law {
        let step = spline.end() / count as f64;
        let points: Vec<Point<N>> = (0..=count).map(|i| spline.at(i as f64 * step)).collect();
        let bounds: Vec<Bounds<N>> =
            points.windows(2).map(|pair| limits.bounds(&pair[0], &pair[1], step, torques)).collect();
        // Largest squares from which the end can still be reached at rest.
        let mut reach = vec![0.0; count + 1];
        for i in (0..count).rev() {
            reach[i] = largest_from(&bounds[i], limits.largest_square(&points[i]), step, reach[i + 1]);
        }
        let mut squares = vec![0.0; count + 1];
        let mut times = vec![0.0; count + 1];
        let (mut jump, mut before) = (0.0_f64, Joints::zeros());
        for i in 0..count {
            let x: f64 = squares[i];
            let (low, high) = accelerations(&bounds[i], x);
            let u = high.min((reach[i + 1] - x) / (2.0 * step)).max(low);
            let torques = Joints::<N>::from_fn(|joint, _| {
                let bound = &bounds[i][2][joint];
                bound.factor * u + bound.bend * x
            });
            jump = jump.max((torques - before).component_div(&limits.torque_rate).amax());
            before = torques;
            squares[i + 1] = (x + 2.0 * step * u).clamp(0.0, reach[i + 1]);
            times[i + 1] = times[i] + 2.0 * step / (x.sqrt() + squares[i + 1].sqrt()).max(f64::MIN_POSITIVE);
        }
        jump = jump.max(before.component_div(&limits.torque_rate).amax());
        Law { step, squares, times, jump }
    }

    /// Joint positions at every control period, with all times stretched by a factor.
    fn samples<const N: usize>(&self, spline: &Spline<N>, stretch: f64) -> Vec<Joints<N>> {
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

impl<const N: usize> TimeLaw<N> {
    /// The largest speeds of the joints at angles `q` (rad) in the directions of `way`, rad/s.
    fn velocity(&self, q: &Joints<N>, way: &Joints<N>) -> Joints<N> {
        Joints::from_fn(|joint, _| {
            let [backwards, forwards] = self.joints[joint].velocity_at(q[joint]);
            let most = if way[joint] < 0.0 { -backwards } else { forwards };
            self.share * most.max(SLOWEST)
        })
    }

    /// The largest square of the speed along the path that keeps the limits of velocity, and those of
    /// acceleration at constant speed.
    fn largest_square(&self, point: &Point<N>) -> f64 {
        let velocity = self.velocity(&point.position, &point.slope);
        (0..N)
            .map(|joint| (velocity[joint] / point.slope[joint].abs().max(FLAT)).powi(2))
            .fold(f64::MAX, f64::min)
    }

    /// The limits at a point: of acceleration there and, with what an acceleration makes of the speed, at the
    /// next point one `step` on; and those of torque, if asked for.
    fn bounds(&self, here: &Point<N>, next: &Point<N>, step: f64, torques: bool) -> Bounds<N> {
        let within = |factor: f64, bend: f64, limit: f64| Bound { factor, bend, low: -limit, high: limit };
        // q̈ = slope · u + bend · x, and x grows by 2 step u to the next point.
        let accelerations_here = std::array::from_fn(|joint| {
            within(here.slope[joint], here.bend[joint], self.acceleration[joint])
        });
        let accelerations_next = std::array::from_fn(|joint| {
            let factor = next.slope[joint] + 2.0 * step * next.bend[joint];
            within(factor, next.bend[joint], self.acceleration[joint])
        });
        let torques = if torques {
            let chain = self.dynamics.at(&here.position);
            let factor = chain.moving(&Joints::zeros(), &here.slope);
            let bend = chain.moving(&here.slope, &here.bend);
            let holding = chain.holding();
            std::array::from_fn(|joint| Bound {
                factor: factor[joint],
                bend: bend[joint],
                low: -self.left(joint, -holding[joint]),
                high: self.left(joint, holding[joint]),
            })
        } else {
            [Bound { factor: 0.0, bend: 0.0, low: f64::MIN, high: f64::MAX }; N]
        };
        [accelerations_here, accelerations_next, torques]
    }
}

/// The range of accelerations along the path that keep these limits at the speed `x` (squared). Empty (low
/// above high) when none does.
fn accelerations<const N: usize>(bounds: &Bounds<N>, x: f64) -> (f64, f64) {
    let (mut least, mut most) = (f64::MIN, f64::MAX);
    for Bound { factor, bend, low, high } in bounds.as_flattened() {
        if factor.abs() < FLAT {
            if !(*low..=*high).contains(&(bend * x)) {
                return (f64::MAX, f64::MIN);
            }
            continue;
        }
        let (a, b) = ((low - bend * x) / factor, (high - bend * x) / factor);
        least = least.max(a.min(b));
        most = most.min(a.max(b));
    }
    (least, most)
}

/// The largest square of the speed at a point, at most `largest`, from which some acceleration leads, within
/// these limits, to one of at most `reach` at the next point one `step` on.
///
/// Each limit bounds the acceleration by two lines over x. The lines from below and those from above enclose
/// a convex region around rest. Its largest x is found from beyond, each time going back to where the two
/// lines cross that are the furthest apart.
fn largest_from<const N: usize>(bounds: &Bounds<N>, largest: f64, step: f64, reach: f64) -> f64 {
    // Lines value + slope · x: the next speed is at least zero and at most what is in reach.
    let first = [(0.0, -0.5 / step), (reach * 0.5 / step, -0.5 / step)];
    let mut lines = [[[(0.0, 0.0); 2]; N]; 3];
    let lines = lines.as_flattened_mut();
    let mut count = 0;
    let mut x = largest;
    for Bound { factor, bend, low, high } in bounds.as_flattened() {
        if factor.abs() < FLAT {
            let limit = if *bend > 0.0 { *high } else { -low };
            x = x.min(limit / bend.abs().max(f64::MIN_POSITIVE));
            continue;
        }
        let (slope, ends) = (-bend / factor, [low / factor, high / factor]);
        lines[count] = [(ends[0].min(ends[1]), slope), (ends[0].max(ends[1]), slope)];
        count += 1;
    }
    for _ in 0..LARGEST_TURNS {
        let at = |line: (f64, f64)| line.0 + line.1 * x;
        let [mut low, mut high] = first;
        for [lower, upper] in &lines[..count] {
            low = if at(*lower) > at(low) { *lower } else { low };
            high = if at(*upper) < at(high) { *upper } else { high };
        }
        if at(low) <= at(high) {
            return x;
        }
        let slope = low.1 - high.1;
        if slope <= 0.0 {
            return 0.0;
        }
        // A little short of it, so that rounding leaves it on this side.
        x = (SHORT * (high.0 - low.0) / slope).clamp(0.0, x);
    }
    0.0
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use super::*;
    use nalgebra::{Matrix3, Vector3};
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
                let most = used.velocity.max(used.acceleration).max(used.torque_rate);
                assert!(most > 0.9, "slower than it need be: {used:?}");
                assert!((trajectory.samples()[0] - path[0]).amax() < 1e-12);
                assert!((trajectory.end() - path[path.len() - 1]).amax() < 1e-12);
            }
        }
    }

    /// One joint on a straight path: accelerate, move at the limit, brake. Its time is known.
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

    /// Before ramps, and without torques, the law is that of `toppra` 0.6.10 (PyPI): its times for the same
    /// spline, limits and grid, with limits of acceleration at both ends of each step
    /// (`DiscretizationType.Interpolation`).
    #[test]
    fn the_fastest_law_is_that_of_toppra() {
        let (arm, spline) = (panda(), Spline::new(&waves()));
        for (velocity, acceleration, theirs) in [(1.0, 1.0, 0.864_541_7), (0.9, 0.5, 1.160_026_6)] {
            let limits = TimeLaw::new(&arm, &Pace { velocity, acceleration, ..ALL });
            let law = Law::fastest(&limits, &spline, 39 * GRID, false);
            let ours = law.times[39 * GRID];
            assert!((ours - theirs).abs() < 1e-4 * theirs, "{ours} for {theirs}");
        }
    }

    /// A heavy load on a long lever: with limits of acceleration alone the shoulder would be asked for more
    /// than it can.
    #[test]
    fn a_heavy_load_is_moved_more_slowly() {
        let arm = panda();
        // Outstretched to the front, and up.
        let path: Vec<Joints> = (0..=40)
            .map(|i| Joints::from([0.0, 1.2 - f64::from(i) * 0.02, 0.0, -0.6, 0.0, 1.6, 0.8]))
            .collect();
        let load = Inertia { mass: 3.0, centre: Vector3::zeros(), moment: Matrix3::identity() * 0.01 };
        let pace = Pace { ramp: 0.05, ..ALL };
        let [empty, loaded] = [TimeLaw::new(&arm, &pace), TimeLaw::new(&arm, &pace).carrying(&load)];
        let (fast, slow) = (empty.time(&path), loaded.time(&path));
        let (without, with) = (loaded.used(fast.samples()), loaded.used(slow.samples()));
        assert!(without.torque > 1.05, "{without:?}");
        assert!(with.torque <= 1.0 + ROUNDING && with.torque > 0.9, "{with:?}");
        assert!(with.torque_rate <= 1.0 + ROUNDING, "{with:?}");
        assert!(slow.duration() > fast.duration());
    }

    /// A path of length zero takes no time.
    #[test]
    fn rest_takes_no_time() {
        let q = Joints::repeat(0.3);
        assert_eq!(TimeLaw::new(&panda(), &ALL).time(&[q; 5]).duration(), 0.0);
        assert_eq!(TimeLaw::new(&panda(), &ALL).time(&[q]).end(), q);
    }
}
