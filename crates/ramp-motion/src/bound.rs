//! The least time in which an arm can rest at some poses of its tip, one after the other: a bound for every
//! motion.
//!
//! The bound ignores obstacles and forces. Between two rests each joint goes at most as fast as a double
//! integrator within its limits of velocity and acceleration. At each pose the arm may choose any posture:
//! the closed form gives all of them for a grid of angles of the last joint. Neighbours on that grid make a
//! cell, the box of the joint positions between them. Dynamic programming over the cells finds the least sum
//! of times, each taken between the nearest corners of two boxes, so that the grid does not make the bound
//! too large.

use ramp_robot::DOF;
use ramp_robot::arm::ArmModel;

use crate::analytic::{Analytic, BRANCHES, GeometryError};
use crate::space::{Joints, Pose};

/// Distance between the angles of the last joint, rad. Chosen: 2°; a quarter of that changes bounds by 1 %.
const GRID: f64 = std::f64::consts::PI / 90.0;
/// Growth of a box in which a branch ends, rad. Chosen: more than a branch changes over its last 2°.
const BRANCH_END: f64 = 0.3;

/// The boxes of joint positions with which the tip is at a pose.
struct Cell {
    low: Joints,
    high: Joints,
}

/// All postures at a pose.
fn cells(arm: &ArmModel, analytic: &Analytic, x_wt: &Pose) -> Vec<Cell> {
    let [low, high] = arm.joints[DOF - 1].range;
    let steps = ((high - low) / GRID).ceil();
    let mut cells = Vec::new();
    let mut before: [Option<Joints>; BRANCHES] = [None; BRANCHES];
    for step in 0..=steps as usize {
        let q7 = low + (high - low) * step as f64 / steps;
        let mut here = [None; BRANCHES];
        for solution in analytic.within(x_wt, q7, 0.0).iter() {
            here[usize::from(solution.branch)] = Some(solution.q);
        }
        for branch in 0..BRANCHES {
            cells.extend(match (before[branch], here[branch]) {
                (Some(a), Some(b)) => Some(Cell { low: a.inf(&b), high: a.sup(&b) }),
                (Some(q), None) | (None, Some(q)) => {
                    Some(Cell { low: q.add_scalar(-BRANCH_END), high: q.add_scalar(BRANCH_END) })
                }
                (None, None) => None,
            });
        }
        before = here;
    }
    cells
}

/// The least time from rest to rest between two boxes, s.
fn between(arm: &ArmModel, from: &Cell, to: &Cell) -> f64 {
    let mut longest = 0.0_f64;
    for (joint, limits) in arm.joints.iter().enumerate() {
        let gap = (to.low[joint] - from.high[joint]).max(from.low[joint] - to.high[joint]);
        if gap > 0.0 {
            let (velocity, acceleration) = (limits.velocity, limits.acceleration);
            let reached = velocity * velocity / acceleration;
            longest = longest.max(if gap < reached {
                2.0 * (gap / acceleration).sqrt()
            } else {
                gap / velocity + velocity / acceleration
            });
        }
    }
    longest
}

/// No motion from rest at `start` (rad) by way of rests at all of `poses` (tip in the world), in their order,
/// takes less time, s; infinite where a pose is out of reach.
///
/// ```
/// # use std::path::Path;
/// # use ramp_motion::{Joints, Kinematics, least_time_over};
/// # use ramp_robot::arm::ArmModel;
/// let arm: ArmModel = ArmModel::read(Path::new("../../data/arms/panda.json"))?;
/// let home = Joints::from(arm.home);
/// let mut there = Kinematics::new(&arm).tip(&home);
/// there.translation.y += 0.3;
/// let there_and_back = least_time_over(&arm, &home, &[there, Kinematics::new(&arm).tip(&home)])?;
/// assert!((0.4..1.2).contains(&there_and_back));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the arm has no closed form.
pub fn least_time_over(arm: &ArmModel, start: &Joints, poses: &[Pose]) -> Result<f64, GeometryError> {
    let analytic = Analytic::new(arm)?;
    let mut reached = vec![(Cell { low: *start, high: *start }, 0.0)];
    for x_wt in poses {
        let next = cells(arm, &analytic, x_wt);
        let time_to = |cell: &Cell| {
            let times = reached.iter().map(|(from, time)| time + between(arm, from, cell));
            times.fold(f64::INFINITY, f64::min)
        };
        reached = next
            .into_iter()
            .map(|cell| {
                let time = time_to(&cell);
                (cell, time)
            })
            .collect();
    }
    Ok(reached.iter().map(|(_, time)| *time).fold(f64::INFINITY, f64::min))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use ramp_robot::random::Stream;

    use super::*;
    use crate::{Kinematics, Pace, TimeLaw};

    /// The bound must hold for every motion: straight motions in joint space between random postures take
    /// longer.
    #[test]
    fn no_motion_takes_less() {
        let arm: ArmModel = ArmModel::read(Path::new("../../data/arms/panda.json")).unwrap();
        let kinematics = Kinematics::new(&arm);
        let law = TimeLaw::new(&arm, &Pace { velocity: 1.0, acceleration: 1.0, jerk: 1.0, ramp: 0.0 });
        let mut stream = Stream::new(1, "bound");
        for _ in 0..5 {
            let start = Joints::from(arm.home);
            let (mut at, mut poses, mut taken) = (start, Vec::new(), 0.0);
            for _ in 0..3 {
                let next = Joints::from_fn(|joint, _| {
                    let [low, high] = arm.joints[joint].range;
                    (start[joint] + 0.8 * (stream.uniform() - 0.5)).clamp(low + 0.05, high - 0.05)
                });
                let line: Vec<Joints> = (0..=40).map(|s| at.lerp(&next, f64::from(s) / 40.0)).collect();
                taken += law.time(&line).duration();
                poses.push(kinematics.tip(&next));
                at = next;
            }
            let bound = least_time_over(&arm, &start, &poses).unwrap();
            assert!(bound > 0.05 && bound < taken, "{bound} s, and a motion took {taken} s");
        }
    }
}
