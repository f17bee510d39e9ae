//! Joint paths that keep clear of everything.
//!
//! First the level path: up to travelling height, straight across with the hand turning the short way, down. It
//! keeps a held beam level and its collisions are checked at every sample. Where something blocks it, a
//! bidirectional random tree (Kuffner and LaValle's RRT-Connect) looks for a way around in joint space.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_robot::DOF;
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;

use crate::collision::Checker;
use crate::kinematics::Kinematics;
use crate::space::{Joints, Pose};

/// Distance between samples along a straight path: m, and rad of hand rotation counted as m.
const SAMPLE: f64 = 0.01;
/// Metres that a radian of the hand's turn counts as.
const TURN_WEIGHT: f64 = 0.15;
/// Pull towards the resting posture while following a path.
const LEAN: f64 = 0.05;
/// Largest joint step between samples that still counts as continuous, rad.
const LARGEST_STEP: f64 = 0.35;
/// Distance from the joints' ends at which a path's end is good enough, rad.
const GOOD_MARGIN: f64 = 0.15;
/// Turns of the shoulder beside its usual one that are tried where that does not do, rad. Chosen.
const SIDES: [f64; 7] = [0.0, 0.3, -0.3, 0.6, -0.6, 0.9, -0.9];
/// Growth of a tree in one step, rad.
const TREE_STEP: f64 = 0.1;
/// Nodes of both trees together before the search gives up.
const TREE_NODES: usize = 6000;
/// Tries to shorten a found way.
const SHORTCUTS: usize = 150;

/// Why there is no path.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// No joint positions within their ranges bring the tip there.
    #[error("the arm cannot reach ({:.3}, {:.3}, {:.3}) m with that orientation", .0[0], .0[1], .0[2])]
    Unreachable([f64; 3]),
    /// The start or the end of the motion touches something.
    #[error("the arm would touch something at the {0} of the motion")]
    Blocked(&'static str),
    /// Neither the level path nor the search found a way.
    #[error("no way around the obstacles was found")]
    NoWay,
}

/// Plans motions of one arm.
#[derive(Clone, Debug)]
pub struct PathPlanner {
    /// The arm's kinematics.
    pub kinematics: Kinematics,
    arm: ArmModel,
    /// The posture the arm leans to.
    rest: Joints,
}

impl PathPlanner {
    /// A planner for `arm`.
    pub fn new(arm: &ArmModel) -> PathPlanner {
        // Elbow up, hand down, every joint far from its ends; the first joint is turned to the work in `posture`.
        let rest = Joints::from([0.0, 0.1, 0.0, -2.2, 0.0, 2.3, std::f64::consts::FRAC_PI_4]);
        PathPlanner { kinematics: Kinematics::new(arm), arm: arm.clone(), rest }
    }

    /// The posture the arm leans to when its tip is at `x_wt`: the shoulder turned towards it.
    pub fn posture(&self, x_wt: &Pose) -> Joints {
        let mut posture = self.rest;
        let p = x_wt.translation.vector;
        posture[0] = p.y.atan2(p.x);
        // The hand's yaw, which the last joint gives for the most part when the hand points down.
        let x_axis = x_wt.rotation * Vector3::x();
        let yaw = x_axis.y.atan2(x_axis.x);
        let turn = posture[0] - yaw + std::f64::consts::FRAC_PI_4;
        let tau = std::f64::consts::TAU;
        posture[6] = turn - tau * (turn / tau).round();
        posture
    }

    /// Joint positions for a pose of the tip, near `seed` if possible.
    ///
    /// # Errors
    /// [`MotionError::Unreachable`].
    pub fn solve(&self, x_wt: &Pose, seed: &Joints) -> Result<Joints, MotionError> {
        let posture = self.posture(x_wt);
        [seed, &posture, &self.rest]
            .into_iter()
            .find_map(|seed| self.kinematics.inverse(x_wt, seed, &posture, LEAN))
            .ok_or_else(|| MotionError::Unreachable(x_wt.translation.vector.into()))
    }

    /// Joint positions for the tip at `from` from which it can go straight to `x_wt`: the shoulder turned towards it, or to a
    /// side of it.
    pub fn posture_for(&self, from: &Pose, x_wt: &Pose) -> Option<Joints> {
        let posture = self.posture(x_wt);
        SIDES.iter().find_map(|turn| {
            let mut seed = posture;
            seed[0] += turn;
            let q = self.kinematics.inverse(from, &seed, &seed, LEAN)?;
            self.straight(&q, x_wt).map(|_| q)
        })
    }

    /// A straight motion of the tip from `q` to `x_wt`, sampled, the hand turning the short way or, where the arm
    /// cannot, the other; `None` when it would have to jump or leave its ranges on the way.
    pub fn straight(&self, q: &Joints, x_wt: &Pose) -> Option<Vec<Joints>> {
        let from = self.kinematics.tip(q);
        let turn = (x_wt.rotation * from.rotation.inverse()).scaled_axis();
        let angle = turn.norm();
        let other = if angle > 1e-6 { turn * ((angle - std::f64::consts::TAU) / angle) } else { turn };
        self.straight_turning(q, &from, x_wt, &turn).or_else(|| {
            if angle < std::f64::consts::FRAC_PI_2 {
                return None;
            }
            self.straight_turning(q, &from, x_wt, &other)
        })
    }

    /// As [`PathPlanner::straight`], turning by the rotation vector `turn` (rad, axes of the world) on the way.
    fn straight_turning(
        &self,
        q: &Joints,
        from: &Pose,
        x_wt: &Pose,
        turn: &Vector3<f64>,
    ) -> Option<Vec<Joints>> {
        let distance = (x_wt.translation.vector - from.translation.vector).norm();
        let samples = ((distance.max(turn.norm() * TURN_WEIGHT) / SAMPLE).ceil() as usize).max(2);
        let mut knots = vec![*q];
        let mut last = *q;
        for sample in 1..=samples {
            let share = sample as f64 / samples as f64;
            let x = Pose::from_parts(
                Translation3::from(from.translation.vector.lerp(&x_wt.translation.vector, share)),
                UnitQuaternion::from_scaled_axis(turn * share) * from.rotation,
            );
            let next = self.kinematics.inverse(&x, &last, &self.posture(&x), LEAN)?;
            if (next - last).amax() > LARGEST_STEP {
                return None;
            }
            knots.push(next);
            last = next;
        }
        Some(knots)
    }

    /// A path from `q` to `x_wt` by way of travelling height `travel` (m, of the tip), free of collision: legs of
    /// joint knots, the arm at rest between them.
    ///
    /// # Errors
    /// When the goal is out of reach, its start or end touches something, or no way is found.
    pub fn plan(
        &self,
        q: &Joints,
        x_wt: &Pose,
        travel: f64,
        checker: &Checker,
        stream: &mut Stream,
    ) -> Result<Vec<Vec<Joints>>, MotionError> {
        if !checker.is_free(&self.kinematics.frames(q)) {
            return Err(MotionError::Blocked("start"));
        }
        if let Some(legs) = self.level(q, x_wt, travel, checker) {
            return Ok(legs);
        }
        let goal = self.solve(x_wt, q)?;
        if !checker.is_free(&self.kinematics.frames(&goal)) {
            return Err(MotionError::Blocked("end"));
        }
        let way = self.connect(q, &goal, checker, stream).ok_or(MotionError::NoWay)?;
        // Straight in joint space between the corners, at rest in each, so that the path checked is the path run.
        Ok(way.windows(2).map(|pair| interpolate(&pair[0], &pair[1])).collect())
    }

    /// The level path alone: up to `travel` (m, of the tip), across, down; `None` when it is blocked or the arm cannot
    /// follow it. Across is straight where that ends well inside the joints' ranges, else by way of a point further
    /// out from the base, which the arm must not fold up to pass.
    pub fn level(&self, q: &Joints, x_wt: &Pose, travel: f64, checker: &Checker) -> Option<Vec<Vec<Joints>>> {
        let mut best: Option<(f64, Vec<Vec<Joints>>)> = None;
        for radius in [None, Some(0.45), Some(0.55)] {
            let Some(legs) = self.level_by(q, x_wt, travel, radius, checker) else { continue };
            let margin =
                legs.last().and_then(|leg| leg.last()).map_or(0.0, |q| self.kinematics.range_margin(q));
            if margin > GOOD_MARGIN {
                return Some(legs);
            }
            if best.as_ref().is_none_or(|(other, _)| margin > *other) {
                best = Some((margin, legs));
            }
        }
        best.map(|(_, legs)| legs)
    }

    /// A level path by way of a point half way around the base, `radius` (m) from it.
    fn level_by(
        &self,
        q: &Joints,
        x_wt: &Pose,
        travel: f64,
        radius: Option<f64>,
        checker: &Checker,
    ) -> Option<Vec<Vec<Joints>>> {
        let from = self.kinematics.tip(q);
        let height = travel.max(x_wt.translation.z).max(from.translation.z);
        let raised = |x: &Pose| {
            let p = x.translation.vector;
            Pose::from_parts(Translation3::new(p.x, p.y, height), upright(&x.rotation))
        };
        let (up, down) = (raised(&from), raised(x_wt));
        let mut way = vec![up];
        if let Some(radius) = radius {
            let angle = |x: &Pose| x.translation.y.atan2(x.translation.x);
            let middle = (angle(&up) + angle(&down)) / 2.0;
            let rotation = up.rotation.try_slerp(&down.rotation, 0.5, 1e-6)?;
            way.push(Pose::from_parts(
                Translation3::new(radius * middle.cos(), radius * middle.sin(), height),
                rotation,
            ));
        }
        way.extend([down, *x_wt]);
        let mut legs = Vec::new();
        let mut at = *q;
        for target in way {
            let here = self.kinematics.tip(&at);
            let near = (here.translation.vector - target.translation.vector).norm() < 1e-4
                && here.rotation.angle_to(&target.rotation) < 1e-3;
            if near && target != *x_wt {
                continue;
            }
            let leg = self.straight(&at, &target)?;
            if !leg.iter().all(|q| checker.is_free(&self.kinematics.frames(q))) {
                return None;
            }
            at = *leg.last()?;
            legs.push(leg);
        }
        Some(legs)
    }

    /// How far the joints stay from the ends of their ranges on a straight motion of the tip from `q` to `x_wt`, rad;
    /// negative when the arm cannot follow it.
    pub fn straight_margin(&self, q: &Joints, x_wt: &Pose) -> f64 {
        self.straight(q, x_wt)
            .map_or(-1.0, |leg| leg.iter().map(|q| self.kinematics.range_margin(q)).fold(f64::MAX, f64::min))
    }

    fn edge_is_free(&self, a: &Joints, b: &Joints, checker: &Checker) -> bool {
        interpolate(a, b).iter().all(|q| checker.is_free(&self.kinematics.frames(q)))
    }

    /// RRT-Connect between two configurations: the corners of a shortened way, straight in joint space between them;
    /// `None` when none was found.
    pub fn connect(
        &self,
        start: &Joints,
        goal: &Joints,
        checker: &Checker,
        stream: &mut Stream,
    ) -> Option<Vec<Joints>> {
        let mut trees: [Vec<(Joints, usize)>; 2] = [vec![(*start, 0)], vec![(*goal, 0)]];
        let mut turn = 0;
        while trees[0].len() + trees[1].len() < TREE_NODES {
            let sample = Joints::from_fn(|joint, _| {
                let [low, high] = self.arm.joints[joint].range;
                low + (high - low) * stream.uniform()
            });
            if let Some(new) = self.grow(&mut trees[turn], &sample, checker) {
                let target = trees[turn][new].0;
                let other = 1 - turn;
                while let Some(near) = self.grow(&mut trees[other], &target, checker) {
                    if (trees[other][near].0 - target).amax() < 1e-9 {
                        let branch = |tree: &[(Joints, usize)], mut node: usize| {
                            let mut way = vec![tree[node].0];
                            while node != 0 {
                                node = tree[node].1;
                                way.push(tree[node].0);
                            }
                            way
                        };
                        let (mine, theirs) = (branch(&trees[turn], new), branch(&trees[other], near));
                        let (head, tail) = if turn == 0 { (mine, theirs) } else { (theirs, mine) };
                        let mut way: Vec<Joints> = head.into_iter().rev().collect();
                        way.extend(tail.into_iter().skip(1));
                        return Some(self.shorten(way, checker, stream));
                    }
                }
            }
            turn = 1 - turn;
        }
        None
    }

    /// Grows a tree one step towards `target`; the new node, or `None` when something blocks it.
    fn grow(&self, tree: &mut Vec<(Joints, usize)>, target: &Joints, checker: &Checker) -> Option<usize> {
        let (nearest, _) = tree
            .iter()
            .enumerate()
            .map(|(index, (q, _))| (index, (q - target).norm_squared()))
            .min_by(|a, b| a.1.total_cmp(&b.1))?;
        let from = tree[nearest].0;
        let way = target - from;
        let next = if way.norm() <= TREE_STEP { *target } else { from + way * (TREE_STEP / way.norm()) };
        if (next - from).norm() < 1e-12 || !self.edge_is_free(&from, &next, checker) {
            return None;
        }
        tree.push((next, nearest));
        Some(tree.len() - 1)
    }

    fn shorten(&self, mut way: Vec<Joints>, checker: &Checker, stream: &mut Stream) -> Vec<Joints> {
        for _ in 0..SHORTCUTS {
            if way.len() < 3 {
                break;
            }
            let a = (stream.uniform() * way.len() as f64) as usize;
            let b = (stream.uniform() * way.len() as f64) as usize;
            let (a, b) = (a.min(b), a.max(b));
            if b > a + 1 && self.edge_is_free(&way[a], &way[b], checker) {
                way.drain(a + 1..b);
            }
        }
        way
    }
}

/// The same yaw, with the hand exactly down.
fn upright(rotation: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    let x = rotation * Vector3::x();
    let yaw = x.y.atan2(x.x);
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw)
        * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
}

/// Samples of a straight line in joint space, both ends among them.
fn interpolate(a: &Joints, b: &Joints) -> Vec<Joints> {
    let steps = (((b - a).amax() / 0.05).ceil() as usize).max(1);
    (0..=steps).map(|step| a.lerp(b, step as f64 / steps as f64)).collect()
}

const _: () = assert!(DOF == 7);
