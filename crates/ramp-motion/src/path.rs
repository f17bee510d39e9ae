//! Collision-free joint paths.
//!
//! Most motions are level: up to travelling height, across, down, with the corners rounded where there is
//! room. There are three ways across: straight, on an arc around the base, and straight in joint space, which
//! tilts the hand on the way and is for an empty one. Of those that are free the one that takes the least
//! time is taken, or the first that takes little more than straight in joint space; if none is, all are tried
//! again higher up. Where that is blocked, too, a bidirectional random tree (Kuffner and LaValle's
//! RRT-Connect) looks for a way around in joint space.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_robot::DOF;
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;

use crate::analytic::Analytic;
use crate::collision::Checker;
use crate::kinematics::{Kinematics, RANGE_MARGIN};
use crate::random_tree::{self, JOINT_SAMPLE, interpolate};
use crate::space::{Joints, Pose};
use crate::spline::Spline;
use crate::time_law::TimeLaw;
use crate::trajectory::Trajectory;

/// Distance between samples along a path of the tip: m, and rad of hand rotation counted as m.
const SAMPLE: f64 = 0.0075;
/// Metres that a radian of hand rotation counts as.
const TURN_WEIGHT: f64 = 0.15;
/// A path is taken without comparison if its time is below this multiple of that of the straight path in
/// joint space. Chosen.
const GOOD_TIME: f64 = 1.05;
/// Number of samples between two solutions that are found by iteration. Chosen: 2 makes motions no faster.
const KNOT: usize = 4;
/// Largest joint step between samples that still counts as continuous, rad.
const LARGEST_STEP: f64 = 0.35;
/// Largest distance in joint space between the end of a tip path and its goal, rad. A path that ends further
/// away is on another branch.
const ARRIVED: f64 = 1e-3;
/// Distance from the joints' ends at which a path's end is good enough, rad.
const GOOD_MARGIN: f64 = 0.15;
/// Offsets of the shoulder angle that are tried one after another, rad. Chosen.
const SIDES: [f64; 7] = [0.0, 0.3, -0.3, 0.6, -0.6, 0.9, -0.9];
/// Additional height of a motion for which no path was found at travelling height, m: above most assemblies.
const OVER: f64 = 0.08;
/// Most samples before and after a corner that a curve replaces: 15 cm.
const ROUNDING: usize = 20;
/// Shares of the room for a curve that are tried.
const ROUNDING_SHARES: [f64; 5] = [1.0, 0.7, 0.5, 0.3, 0.15];
/// A corner that is so near to an end of the motion is left out: m, and rad.
const NEAR: (f64, f64) = (3e-3, 0.02);
/// Error of path planning.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// No joint positions within their ranges bring the tip there.
    #[error("the arm cannot reach ({:.3}, {:.3}, {:.3}) m with that orientation", .0[0], .0[1], .0[2])]
    Unreachable([f64; 3]),
    /// The start or the end of the motion touches something.
    #[error("the arm would touch something at the {0} of the motion")]
    Blocked(&'static str),
    /// Neither a level path nor the search found a way.
    #[error("no path around the obstacles was found")]
    NoWay,
}

/// Constraints of a motion through free space.
#[derive(Clone, Copy)]
pub struct Terms<'a, const N: usize = DOF> {
    /// Travelling height, m, of the tip.
    pub height: f64,
    /// The hand stays level: a beam is in it.
    pub level: bool,
    /// The obstacles that the arm must avoid.
    pub checker: &'a Checker,
    /// Time parametrisation, with the limits of the motion.
    pub law: &'a TimeLaw<N>,
}

/// A piece of a path of the tip.
struct Piece {
    from: Pose,
    to: Pose,
    /// Rotation of the hand along the path: a rotation vector, rad, axes of the world.
    turn: Vector3<f64>,
    /// Around the base, and not straight.
    around: bool,
}

impl Piece {
    fn length(&self) -> f64 {
        let (a, b) = (self.from.translation.vector, self.to.translation.vector);
        let way = if self.around {
            let swept = a.xy().norm().max(b.xy().norm()) * (angle(&b) - angle(&a)).abs();
            swept.hypot(b.xy().norm() - a.xy().norm()).hypot(b.z - a.z)
        } else {
            (b - a).norm()
        };
        way.max(self.turn.norm() * TURN_WEIGHT)
    }

    /// The pose at a share of the way: position, or angle, distance and height, and turn change evenly.
    fn at(&self, share: f64) -> Pose {
        let (a, b) = (self.from.translation.vector, self.to.translation.vector);
        let mut p = a.lerp(&b, share);
        if self.around {
            let radius = a.xy().norm() + (b.xy().norm() - a.xy().norm()) * share;
            let angle = angle(&a) + (angle(&b) - angle(&a)) * share;
            (p.x, p.y) = (radius * angle.cos(), radius * angle.sin());
        }
        Pose::from_parts(
            Translation3::from(p),
            UnitQuaternion::from_scaled_axis(self.turn * share) * self.from.rotation,
        )
    }
}

/// The angle of a point around the base, rad: never through the back, which no arm reaches.
fn angle(p: &Vector3<f64>) -> f64 {
    p.y.atan2(p.x)
}

/// The turns that take one rotation to another: the short one and, where it is not much longer, the other way
/// round.
fn turns(from: &Pose, to: &Pose) -> Vec<Vector3<f64>> {
    let short = (to.rotation * from.rotation.inverse()).scaled_axis();
    let angle = short.norm();
    let mut turns = vec![short];
    if angle > std::f64::consts::FRAC_PI_2 {
        turns.push(short * ((angle - std::f64::consts::TAU) / angle));
    }
    turns
}

fn is_near(from: &Pose, to: &Pose) -> bool {
    (from.translation.vector - to.translation.vector).norm() < NEAR.0
        && from.rotation.angle_to(&to.rotation) < NEAR.1
}

/// Samples in joint space, and the numbers of those at which the path has a corner.
#[derive(Clone, Debug, Default)]
struct Polyline<const N: usize> {
    samples: Vec<Joints<N>>,
    corners: Vec<usize>,
}

impl<const N: usize> Polyline<N> {
    /// Appends samples that begin at the end of this one.
    fn extend(&mut self, next: Polyline<N>) {
        if self.samples.is_empty() {
            *self = next;
            return;
        }
        if next.samples.len() < 2 {
            return;
        }
        let corner = self.samples.len() - 1;
        if corner > 0 {
            self.corners.push(corner);
        }
        self.corners.extend(next.corners.iter().map(|other| corner + other));
        self.samples.extend(next.samples.into_iter().skip(1));
    }
}

/// A collision-free path, ready for time parametrisation.
struct Shaped<const N: usize> {
    /// At least one; the motion rests between them.
    parts: Vec<Vec<Joints<N>>>,
    /// About the time that it takes, s.
    time: f64,
}

impl<const N: usize> Shaped<N> {
    fn timed(&self, law: &TimeLaw<N>) -> Trajectory<N> {
        let rest = self.parts[1..].iter().map(|part| law.time(part));
        rest.fold(law.time(&self.parts[0]), Trajectory::then)
    }
}

/// Plans motions of one arm.
#[derive(Clone, Debug)]
pub struct PathPlanner<const N: usize = DOF> {
    /// The arm's kinematics.
    pub kinematics: Kinematics<N>,
    /// Every way to reach a pose, where the arm's build allows it.
    analytic: Option<Analytic<N>>,
    arm: ArmModel<N>,
    /// The posture the arm leans to with the tip straight ahead.
    ahead: Joints<N>,
}

impl<const N: usize> PathPlanner<N> {
    /// A planner for `arm`.
    pub fn new(arm: &ArmModel<N>) -> PathPlanner<N> {
        PathPlanner {
            kinematics: Kinematics::new(arm),
            analytic: Analytic::new(arm).ok(),
            arm: arm.clone(),
            ahead: Joints::from(arm.posture.unwrap_or(arm.home)),
        }
    }

    /// The posture the arm leans to when its tip is at `x_wt`: the shoulder turned towards it.
    pub fn posture(&self, x_wt: &Pose) -> Joints<N> {
        let mut posture = self.ahead;
        let towards = angle(&x_wt.translation.vector);
        posture[0] += towards;
        // The hand's yaw, which the last joint gives for the most part when the hand points down.
        let x_axis = x_wt.rotation * Vector3::x();
        let yaw = x_axis.y.atan2(x_axis.x);
        let turn = towards - yaw + posture[N - 1];
        let tau = std::f64::consts::TAU;
        posture[N - 1] = turn - tau * (turn / tau).round();
        posture
    }

    /// Joint positions for a pose of the tip, rather well inside their ranges: those with the shoulder
    /// towards the pose or, where these leave too little room, near `seed`.
    ///
    /// # Errors
    /// [`MotionError::Unreachable`].
    pub fn solve(&self, x_wt: &Pose, seed: &Joints<N>) -> Result<Joints<N>, MotionError> {
        self.solutions(x_wt, seed)
            .first()
            .copied()
            .ok_or_else(|| MotionError::Unreachable(x_wt.translation.vector.into()))
    }

    /// Joint positions for the tip at `from` from which it can go straight to `x_wt`: the shoulder turned
    /// towards it, or to a side of it.
    pub fn posture_for(&self, from: &Pose, x_wt: &Pose) -> Option<Joints<N>> {
        let posture = self.posture(x_wt);
        SIDES.iter().find_map(|turn| {
            let mut seed = posture;
            seed[0] += turn;
            let q = self.kinematics.inverse(from, &seed, &seed)?;
            self.straight(&q, x_wt).map(|_| q)
        })
    }

    /// All joint positions that are found for a pose of the tip, the best first: of those with room to spare,
    /// the ones near the posture for the pose. From an elbow that is aside, no level path leads back.
    fn solutions(&self, x_wt: &Pose, seed: &Joints<N>) -> Vec<Joints<N>> {
        let posture = self.posture(x_wt);
        let mut found: Vec<Joints<N>> = Vec::new();
        for seed in [&posture, seed, &self.ahead] {
            if let Some(q) = self.kinematics.inverse(x_wt, seed, &posture)
                && found.iter().all(|other| (other - q).amax() > ARRIVED)
            {
                found.push(q);
            }
        }
        // Stable: those with room to spare stay in their order.
        let room = |q: &Joints<N>| self.kinematics.range_margin(q).min(GOOD_MARGIN);
        found.sort_by(|a, b| room(b).total_cmp(&room(a)));
        found
    }

    /// A straight motion of the tip from `q` to `x_wt`, sampled, the hand turning the short way or, where the
    /// arm cannot, the other; `None` when it would have to jump or leave its ranges on the way.
    pub fn straight(&self, q: &Joints<N>, x_wt: &Pose) -> Option<Vec<Joints<N>>> {
        let from = self.kinematics.tip(q);
        self.solutions(x_wt, q).iter().find_map(|goal| {
            turns(&from, x_wt).into_iter().find_map(|turn| {
                let piece = Piece { from, to: *x_wt, turn, around: false };
                Some(self.lead(q, goal, &[piece])?.samples)
            })
        })
    }

    /// The tip along pieces from `q` to `goal`, the posture changing evenly from that of one to that of the
    /// other; `None` when the arm would have to jump or leave its ranges on the way.
    fn lead(&self, q: &Joints<N>, goal: &Joints<N>, pieces: &[Piece]) -> Option<Polyline<N>> {
        let total: f64 = pieces.iter().map(Piece::length).sum();
        let spacing = SAMPLE.min(total / ((goal - q).amax() / JOINT_SAMPLE).max(2.0));
        let mut line = Polyline { samples: vec![*q], corners: Vec::new() };
        let (mut last, mut passed) = (*q, 0.0);
        for piece in pieces {
            if passed > 0.0 {
                line.corners.push(line.samples.len() - 1);
            }
            let length = piece.length();
            let count = (length / spacing).ceil().max(2.0) as usize;
            let posture = |share: f64| q.lerp(goal, (passed + share * length) / total);
            let samples = self.follow(piece, &last, &posture, count)?;
            for next in samples {
                if (next - last).amax() > LARGEST_STEP {
                    return None;
                }
                line.samples.push(next);
                last = next;
            }
            passed += length;
        }
        ((last - goal).amax() < ARRIVED).then_some(line)
    }

    /// Joint positions along a piece after its start `q`, in `count` equal steps, near to the postures at
    /// those shares of the path.
    fn follow(
        &self,
        piece: &Piece,
        q: &Joints<N>,
        posture: &impl Fn(f64) -> Joints<N>,
        count: usize,
    ) -> Option<Vec<Joints<N>>> {
        // With an upper arm that points straight up, the angle of the last joint does not tell how the first
        // and the third share a turn: the closed form jumps there, and the iteration does not.
        let steady = |line: &Vec<Joints<N>>| {
            let before = std::iter::once(q).chain(line);
            before.zip(line).all(|(before, next)| (next - before).amax() <= LARGEST_STEP)
        };
        let closed = self.analytic.as_ref().and_then(|it| follow_closed(it, piece, q, posture, count));
        closed.filter(steady).or_else(|| {
            let mut last = *q;
            let sample = |sample: usize| {
                let share = sample as f64 / count as f64;
                last = self.kinematics.inverse(&piece.at(share), &last, &posture(share))?;
                Some(last)
            };
            (1..=count).map(sample).collect()
        })
    }

    /// The fastest motion from `q` to `x_wt` that is found and free of collision.
    ///
    /// # Errors
    /// When the goal is out of reach, its start or end touches something, or no way is found.
    pub fn plan(
        &self,
        q: &Joints<N>,
        x_wt: &Pose,
        terms: &Terms<N>,
        stream: &mut Stream,
    ) -> Result<Trajectory<N>, MotionError> {
        let free = |q: &Joints<N>| terms.checker.is_free(&self.kinematics.frames(q));
        if !free(q) {
            return Err(MotionError::Blocked("start"));
        }
        let mut goals = self.solutions(x_wt, q);
        if goals.is_empty() {
            return Err(MotionError::Unreachable(x_wt.translation.vector.into()));
        }
        goals.retain(free);
        let first = goals.first().ok_or(MotionError::Blocked("end"))?;
        for height in [terms.height, terms.height + OVER] {
            for goal in &goals {
                if let Some(best) = self.level(q, goal, x_wt, height, terms) {
                    return Ok(best.timed(terms.law));
                }
            }
        }
        self.plan_to(q, first, terms, stream)
    }

    /// A collision-free motion from `q` to other joint positions, found by random search.
    ///
    /// # Errors
    /// When no way is found.
    pub fn plan_to(
        &self,
        q: &Joints<N>,
        goal: &Joints<N>,
        terms: &Terms<N>,
        stream: &mut Stream,
    ) -> Result<Trajectory<N>, MotionError> {
        let way = self.connect(q, goal, terms.checker, stream).ok_or(MotionError::NoWay)?;
        let mut line = Polyline::default();
        for pair in way.windows(2) {
            line.extend(Polyline { samples: interpolate(&pair[0], &pair[1]), corners: Vec::new() });
        }
        let shaped = self.shaped(&line, terms).ok_or(MotionError::NoWay)?;
        Ok(shaped.timed(terms.law))
    }

    /// The fastest collision-free level path to `goal`, where the tip is at `x_wt`, via a height (m, of the
    /// tip). Ends with the first that takes little more time than straight in joint space.
    fn level(
        &self,
        q: &Joints<N>,
        goal: &Joints<N>,
        x_wt: &Pose,
        height: f64,
        terms: &Terms<N>,
    ) -> Option<Shaped<N>> {
        let from = self.kinematics.tip(q);
        let height = height.max(x_wt.translation.z).max(from.translation.z);
        let raised = |x: &Pose| {
            let p = x.translation.vector;
            Pose::from_parts(Translation3::new(p.x, p.y, height), upright(&x.rotation))
        };
        let (up, down) = (raised(&from), raised(x_wt));
        // A hand that is nearly at travelling height makes no detour.
        let up = if is_near(&from, &up) { from } else { up };
        let down = if is_near(&down, x_wt) { *x_wt } else { down };
        let straight = |from: &Pose, to: &Pose| {
            let turn = turns(from, to)[0];
            (from != to).then_some(Piece { from: *from, to: *to, turn, around: false })
        };
        if is_near(&up, &down) {
            let pieces: Vec<Piece> =
                [straight(&from, &up), straight(&up, x_wt)].into_iter().flatten().collect();
            return self.shaped(&self.lead(q, goal, &pieces)?, terms);
        }
        let enough = GOOD_TIME * terms.law.least_time(q, goal);
        let mut best: Option<Shaped<N>> = None;
        let consider = |way: Option<Polyline<N>>, best: &mut Option<Shaped<N>>| {
            let most = best.as_ref().map_or(f64::INFINITY, |best| best.time);
            let way = way.filter(|way| terms.law.least_along(&way.samples) < most);
            let shaped = way.and_then(|way| self.shaped(&way, terms));
            if let Some(shaped) = shaped.filter(|shaped| shaped.time < most) {
                *best = Some(shaped);
            }
            best.as_ref().is_some_and(|best| best.time < enough)
        };
        if !terms.level {
            let way = self.in_joint_space(q, goal, [straight(&from, &up), straight(&down, x_wt)]);
            if consider(way, &mut best) {
                return best;
            }
        }
        for around in [false, true] {
            for turn in turns(&up, &down) {
                let across = Some(Piece { from: up, to: down, turn, around });
                let pieces = [straight(&from, &up), across, straight(&down, x_wt)];
                let pieces: Vec<Piece> = pieces.into_iter().flatten().collect();
                if consider(self.lead(q, goal, &pieces), &mut best) {
                    return best;
                }
            }
        }
        best
    }

    /// A level path that is straight in joint space between its vertical ends.
    fn in_joint_space(
        &self,
        q: &Joints<N>,
        goal: &Joints<N>,
        ends: [Option<Piece>; 2],
    ) -> Option<Polyline<N>> {
        let [up, down] = ends;
        let mut line = Polyline { samples: vec![*q], corners: Vec::new() };
        if let Some(piece) = up {
            let raised = self.kinematics.inverse(&piece.to, q, q)?;
            line = self.lead(q, &raised, &[piece])?;
        }
        let last = match &down {
            Some(piece) => self.kinematics.inverse(&piece.from, goal, goal)?,
            None => *goal,
        };
        let first = *line.samples.last()?;
        if (last - first).amax() > ARRIVED {
            let way = self.kinematics.tip(&last).translation.vector
                - self.kinematics.tip(&first).translation.vector;
            let count =
                (way.norm() / SAMPLE).max((last - first).amax() / JOINT_SAMPLE).ceil().max(2.0) as usize;
            let samples = (0..=count).map(|sample| first.lerp(&last, sample as f64 / count as f64)).collect();
            line.extend(Polyline { samples, corners: Vec::new() });
        }
        if let Some(piece) = down {
            line.extend(self.lead(&last, goal, &[piece])?);
        }
        Some(line)
    }

    /// A path with its corners rounded where there is room, and divided at the others; `None` when it is not
    /// collision-free.
    fn shaped(&self, way: &Polyline<N>, terms: &Terms<N>) -> Option<Shaped<N>> {
        let free = |q: &Joints<N>| terms.checker.is_free(&self.kinematics.frames(q));
        if !way.samples.iter().all(free) {
            return None;
        }
        let clear = |q: &Joints<N>| terms.checker.is_clear(&self.kinematics.frames(q));
        let last = way.samples.len() - 1;
        let mut parts: Vec<Vec<Joints<N>>> = Vec::new();
        let (mut part, mut from) = (Vec::new(), 0);
        for (index, &corner) in way.corners.iter().enumerate() {
            let before = if index == 0 { 0 } else { way.corners[index - 1] };
            let after = way.corners.get(index + 1).copied().unwrap_or(last);
            // The curves of two corners have no sample in common, and the ends stay as they are.
            let room = |from: usize, to: usize| {
                let length = (to - from).saturating_sub(1);
                let most = if from == 0 || to == last { length * 3 / 4 } else { length / 2 };
                most.min(ROUNDING)
            };
            let room = [room(before, corner), room(corner, after)];
            let curve = ROUNDING_SHARES.into_iter().find_map(|share| {
                let halves = room.map(|room| (room as f64 * share) as usize);
                let curve = round(&way.samples, corner, halves)?;
                curve.iter().all(clear).then_some((halves, curve))
            });
            if let Some((halves, curve)) = curve {
                part.extend_from_slice(&way.samples[from..corner - halves[0]]);
                part.extend(curve);
                from = corner + halves[1] + 1;
            } else {
                part.extend_from_slice(&way.samples[from..=corner]);
                parts.push(std::mem::take(&mut part));
                from = corner;
            }
        }
        part.extend_from_slice(&way.samples[from..]);
        parts.push(part);
        let time = parts.iter().map(|part| terms.law.estimate(part)).sum();
        Some(Shaped { parts, time })
    }

    /// Least distance of the joints from the ends of their ranges on a straight motion of the tip from `q` to
    /// `x_wt`, rad; negative when the arm cannot follow it.
    pub fn straight_margin(&self, q: &Joints<N>, x_wt: &Pose) -> f64 {
        self.straight(q, x_wt).map_or(-1.0, |line| {
            line.iter().map(|q| self.kinematics.range_margin(q)).fold(f64::MAX, f64::min)
        })
    }

    /// A path around obstacles between two configurations by random search (RRT-Connect): its corners,
    /// straight in joint space between them; `None` when none was found.
    pub fn connect(
        &self,
        start: &Joints<N>,
        goal: &Joints<N>,
        checker: &Checker,
        stream: &mut Stream,
    ) -> Option<Vec<Joints<N>>> {
        let ranges = self.arm.joints.each_ref().map(|joint| joint.range);
        let free = |q: &Joints<N>| checker.is_free(&self.kinematics.frames(q));
        random_tree::connect(&ranges, &free, start, goal, stream)
    }
}

/// As [`PathPlanner::follow`] in closed form: a smooth curve through a few solutions gives the angle of the
/// last joint in between. `None` when the path leads through poses that cannot be reached with that angle.
fn follow_closed<const N: usize>(
    analytic: &Analytic<N>,
    piece: &Piece,
    q: &Joints<N>,
    posture: &impl Fn(f64) -> Joints<N>,
    count: usize,
) -> Option<Vec<Joints<N>>> {
    let knots = count.div_ceil(KNOT).max(2);
    let mut line = vec![*q];
    for knot in 1..=knots {
        let [before, share] = [knot - 1, knot].map(|knot| knot as f64 / knots as f64);
        let seed = line[knot - 1] + posture(share) - posture(before);
        line.push(analytic.nearest(&piece.at(share), &seed, &posture(share), RANGE_MARGIN)?);
    }
    let curve = Spline::new(&line);
    let sample = |sample: usize| {
        let share = sample as f64 / count as f64;
        let near = curve.at(share * knots as f64).position;
        analytic.beside(&piece.at(share), &near, RANGE_MARGIN)
    };
    (1..=count).map(sample).collect()
}

/// The same yaw, with the hand exactly down.
fn upright(rotation: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    let x = rotation * Vector3::x();
    let yaw = x.y.atan2(x.x);
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw)
        * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
}

/// A curve in place of the samples around a corner, from `halves[0]` before it to `halves[1]` after it: it
/// begins and ends as they do, and leaves out the corner (a quadratic Bézier curve). `None` when one of
/// `halves` is 0.
fn round<const N: usize>(samples: &[Joints<N>], corner: usize, halves: [usize; 2]) -> Option<Vec<Joints<N>>> {
    if halves.contains(&0) {
        return None;
    }
    let (a, b, c) = (samples[corner - halves[0]], samples[corner], samples[corner + halves[1]]);
    // The curve's parameter gains on each sample as much as its ends' distances ask for, evenly more or less
    // in between.
    let gains = halves.map(|half| 0.5 / half as f64);
    let count = (2.0 / (gains[0] + gains[1])).round().max(2.0);
    let parameter = |step: f64| gains[0] * step + (gains[1] - gains[0]) * step * step / (2.0 * count);
    let curve = (0..=count as usize).map(|step| {
        let t = parameter(step as f64) / parameter(count);
        a.lerp(&b, t).lerp(&b.lerp(&c, t), t)
    });
    Some(curve.collect())
}
