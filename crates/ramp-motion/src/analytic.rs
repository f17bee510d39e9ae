//! Closed-form inverse kinematics of arms built like Franka's Panda and FR3: every way to reach a pose.
//!
//! Such an arm has a spherical shoulder (axes 1, 2 and 3 meet in a point S), and its axes 5 and 6 meet in a
//! point W. A pose fixes six of the seven joints; the angle of the last, q7, is free. This choice of the free
//! joint and the number of branches are those of He and Liu, "Analytical Inverse Kinematics for Franka Emika
//! Panda – a Geometrical Solver for 7-DOF Manipulators with Unconventional Design" (2021). With q7 given,
//! link 6 stands still, and so does W:
//!
//! 1. the distance from S to W gives q4, in two ways (elbow);
//! 2. the distance of S along axis 5 gives q6, in two ways (wrist), and the direction of S around axis 5
//!    gives q5;
//! 3. link 3 stands still now, and its orientation gives q1, q2 and q3, in two ways (shoulder).
//!
//! All lengths come from the arm file. An arm of another build is refused by [`Analytic::new`]; the iteration
//! of [`Kinematics::inverse`](crate::Kinematics::inverse) serves any arm.

pub mod search;

use std::f64::consts::TAU;
use std::ops::Deref;

use nalgebra::{Matrix3, Quaternion, Translation3, UnitQuaternion, Vector3};
use ramp_robot::DOF;
use ramp_robot::arm::ArmModel;

use crate::space::{Joints, Pose};

/// Joints of the arms that have a closed form here.
const SEVEN: usize = 7;
/// Most solutions for one pose and one q7: two each for elbow, wrist and shoulder.
pub const BRANCHES: usize = 8;

/// Tolerance of the geometry assumed here, m and rad: solutions are wrong by about as much.
const GEOMETRY: f64 = 1e-10;
/// Lengths (m), products of lengths (m²) and sines that count as zero: a thousand times what rounding gives.
const ROUNDING: f64 = 1e-12;
/// Distance behind the meeting of two branches, m or m², at which a pose still counts as reached: the
/// rounding of an angle near such a meeting, times a length. Solutions there are off by about as much.
const REACH: f64 = 1e-10;
/// One way to reach a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution<const N: usize = DOF> {
    /// Joint positions, rad; each is the one nearest to the middle of its joint's range.
    pub q: Joints<N>,
    /// Which of the [`BRANCHES`]: bit 0 elbow, bit 1 wrist, bit 2 shoulder. Within the joint ranges it stays
    /// the same along a continuous motion, unless two branches meet on the way. For the Panda the bits are
    /// set where q4 is beyond the outstretched arm, cos q5 is positive and q2 is negative.
    pub branch: u8,
}

/// All ways to reach a pose with one q7, read as a slice.
#[derive(Clone, Copy, Debug)]
pub struct Solutions<const N: usize = DOF> {
    found: [Solution<N>; BRANCHES],
    count: usize,
}

impl<const N: usize> Solutions<N> {
    fn new() -> Solutions<N> {
        Solutions { found: [Solution { q: Joints::zeros(), branch: 0 }; BRANCHES], count: 0 }
    }

    fn push(&mut self, solution: Solution<N>) {
        self.found[self.count] = solution;
        self.count += 1;
    }
}

impl<const N: usize> Deref for Solutions<N> {
    type Target = [Solution<N>];

    fn deref(&self) -> &[Solution<N>] {
        &self.found[..self.count]
    }
}

/// Error of [`Analytic::new`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the arm {arm} has no closed-form inverse kinematics: {reason}")]
pub struct GeometryError {
    /// Its name.
    pub arm: String,
    /// The difference of its geometry, with joint numbers from 1.
    pub reason: String,
}

/// The closed-form inverse of one arm.
///
/// ```
/// # use std::path::Path;
/// # use ramp_motion::{Analytic, Joints, Kinematics};
/// # use ramp_robot::arm::ArmModel;
/// let arm: ArmModel = ArmModel::read(Path::new("../../data/arms/panda.json"))?;
/// let analytic = Analytic::new(&arm)?;
/// let home = Joints::from(arm.home);
/// let mut x_wt = Kinematics::new(&arm).tip(&home);
/// x_wt.translation.y += 0.2;
/// // Of all ways to reach the pose with q7 as at home:
/// let all = analytic.all(&x_wt, home[6]);
/// let within = analytic.within(&x_wt, home[6], 0.05);
/// assert!(within.len() < all.len());
/// // Over all q7, the way that takes least time from home:
/// let choice = analytic.quickest(&x_wt, &home, 0.05).ok_or("out of reach")?;
/// assert!(within.iter().all(|other| choice.cost <= analytic.least_time(&home, &other.q)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// It exists for arms with seven joints only; `N` lets a planner for any arm ask for one.
#[derive(Clone, Debug)]
pub struct Analytic<const N: usize = DOF> {
    /// Frame 1 at angle zero in the world; its origin is S.
    r_w1: Matrix3<f64>,
    p_ws: Vector3<f64>,
    /// Rotations of the joint frames at angle zero in the frame before.
    r_12: Matrix3<f64>,
    r_23: Matrix3<f64>,
    r_34: Matrix3<f64>,
    r_45: Matrix3<f64>,
    r_56: Matrix3<f64>,
    /// Frame 6 in frame 7 at angle zero; its origin is W.
    r_76: Matrix3<f64>,
    p_7w: Vector3<f64>,
    x_t7: Pose,
    /// S in frame 4 at q4 = 0, and W in frame 4, m.
    p_4s: Vector3<f64>,
    p_4w: Vector3<f64>,
    /// q2 at which axes 1 and 3 are in line, rad.
    straight: f64,
    /// Angle in frame 1 around axis 1, at q1 = 0, to which axis 3 leans when q2 grows, rad.
    lean: f64,
    low: Joints<N>,
    high: Joints<N>,
    velocity: Joints<N>,
}

/// `v`, turned by `angle` about z.
fn turned(angle: f64, v: &Vector3<f64>) -> Vector3<f64> {
    let (sin, cos) = angle.sin_cos();
    Vector3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
}

/// Angle of the projection on xy, rad.
fn angle(v: &Vector3<f64>) -> f64 {
    v.y.atan2(v.x)
}

fn radius(v: &Vector3<f64>) -> f64 {
    v.x.hypot(v.y)
}

/// Angles at which `amplitude · cos(angle − centre) = target`, and how many: 0, 1 or 2. `free` is the answer
/// where all angles serve.
fn roots(amplitude: f64, target: f64, centre: f64, free: f64) -> ([f64; 2], usize) {
    if target.abs() > amplitude + REACH {
        return ([free; 2], 0);
    }
    if amplitude <= ROUNDING {
        return ([free; 2], 1);
    }
    let cosine = (target / amplitude).clamp(-1.0, 1.0);
    let half = cosine.acos();
    ([centre + half, centre - half], if cosine.abs() < 1.0 { 2 } else { 1 })
}

impl<const N: usize> Analytic<N> {
    /// The closed-form inverse of `arm`.
    ///
    /// # Errors
    /// When the arm has not seven joints, its axes 1, 2 and 3 do not meet in the origins of joints 1 and 2,
    /// are not at right angles one to the next, or axes 5 and 6 do not meet in the origins of joints 5 and 6.
    pub fn new(arm: &ArmModel<N>) -> Result<Analytic<N>, GeometryError> {
        let refused = |reason: String| GeometryError { arm: arm.name.clone(), reason };
        if N != SEVEN {
            return Err(refused(format!("it has {N} joints, not {SEVEN}")));
        }
        let pose = |position: [f64; 3], [w, x, y, z]: [f64; 4]| {
            let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
            Pose::from_parts(Translation3::from(position), rotation)
        };
        let fixed: [Pose; N] = arm.joints.each_ref().map(|joint| pose(joint.position, joint.quat_wxyz));
        let rotation = |joint: usize| fixed[joint - 1].rotation.to_rotation_matrix().into_inner();
        let (r_12, r_23) = (rotation(2), rotation(3));
        let p_3s = fixed[2].inverse().translation.vector;
        let checks = [
            (fixed[1].translation.vector.norm(), "joint 2 does not stand in the origin of joint 1"),
            (radius(&p_3s), "axis 3 does not pass through the origin of joint 2"),
            (r_12.m33.abs(), "axes 1 and 2 are not at right angles"),
            (r_23.m33.abs(), "axes 2 and 3 are not at right angles"),
            (fixed[5].translation.vector.norm(), "joint 6 does not stand in the origin of joint 5"),
        ];
        if let Some((off, reason)) = checks.into_iter().find(|(off, _)| off.is_nan() || *off > GEOMETRY) {
            return Err(refused(format!("{reason} (off by {off:.2e})")));
        }
        let x_3s = Translation3::from(p_3s);
        let axis = Vector3::z();
        // Directions of axes 1 and 3 in frame 2 at q2 = 0.
        let (z_1, z_3) = (r_12.transpose() * axis, r_23 * axis);
        let x_7h = pose(arm.hand.position, arm.hand.quat_wxyz);
        Ok(Analytic {
            r_w1: rotation(1),
            p_ws: fixed[0].translation.vector,
            r_12,
            r_23,
            r_34: rotation(4),
            r_45: rotation(5),
            r_56: rotation(6),
            r_76: rotation(7).transpose(),
            p_7w: fixed[6].inverse().translation.vector,
            x_t7: (x_7h * Pose::translation(0.0, 0.0, arm.hand.tip)).inverse(),
            p_4s: (fixed[3].inverse() * x_3s).translation.vector,
            p_4w: fixed[4].translation.vector,
            straight: angle(&z_1) - angle(&z_3),
            lean: angle(&(r_12 * axis).cross(&axis)),
            low: Joints::from_fn(|joint, _| arm.joints[joint].range[0]),
            high: Joints::from_fn(|joint, _| arm.joints[joint].range[1]),
            velocity: Joints::from_fn(|joint, _| arm.joints[joint].velocity),
        })
    }

    /// All joint positions that bring the tip to `x_wt` with the last joint at `q7` (rad), within their
    /// ranges or not.
    ///
    /// If one angle of a pair or a single one does not matter, one solution of the family is given: axes 1
    /// and 3 in line share their rotation in equal parts, and a joint that moves nothing is in the middle of
    /// its range. Where two branches meet, angles are known to 1e-8 rad only, and to 1e-4 where elbows and
    /// wrists do so at once; there a solution may even be missed. The poses of the solutions given are exact
    /// to 1e-9 all the same.
    pub fn all(&self, x_wt: &Pose, q7: f64) -> Solutions<N> {
        let wide = Joints::repeat(f64::INFINITY);
        self.bounded(x_wt, q7, &-wide, &wide)
    }

    /// As [`Analytic::all`], only those with every joint at least `margin` (rad) inside its range.
    pub fn within(&self, x_wt: &Pose, q7: f64, margin: f64) -> Solutions<N> {
        self.bounded(x_wt, q7, &self.low.add_scalar(margin), &self.high.add_scalar(-margin))
    }

    fn bounded(&self, x_wt: &Pose, q7: f64, low: &Joints<N>, high: &Joints<N>) -> Solutions<N> {
        let mut solutions = Solutions::new();
        let middle = (self.low + self.high) / 2.0;
        // The turn of `joint` that is nearest to the middle of its range, when it is allowed.
        let allowed = |joint: usize, value: f64| {
            let value = value - TAU * ((value - middle[joint]) / TAU).round();
            (value >= low[joint] && value <= high[joint]).then_some(value)
        };
        if !(low[6]..=high[6]).contains(&q7) {
            return solutions;
        }
        // Link 6 in the world; its origin is W.
        let x_w7 = x_wt * self.x_t7;
        let r_w7 = x_w7.rotation * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -q7);
        let r_w6 = r_w7.to_rotation_matrix().into_inner() * self.r_76;
        let p_ww = x_w7.translation.vector + r_w7 * self.p_7w;
        // From W to S, in frame 6.
        let d_6 = r_w6.tr_mul(&(self.p_ws - p_ww));
        let r_16 = self.r_w1.tr_mul(&r_w6);
        // Axis 5 in frame 6 at q6 = 0.
        let axis_5 = self.r_56.row(2).transpose();

        let (s, w) = (&self.p_4s, &self.p_4w);
        let along = (s.norm_squared() + w.norm_squared() - d_6.norm_squared()) / 2.0 - s.z * w.z;
        let (elbows, count) = roots(radius(s) * radius(w), along, angle(s) - angle(w), middle[3]);
        for (elbow, q4) in elbows.into_iter().take(count).enumerate() {
            let Some(q4) = allowed(3, q4) else { continue };
            // From W to S, and axes x and z of frame 3, in frame 5 at q5 = 0.
            let d_5 = self.r_45.tr_mul(&(turned(-q4, s) - w));
            let [x_5, z_5] =
                [0, 2].map(|axis| self.r_45.tr_mul(&turned(-q4, &self.r_34.row(axis).transpose())));
            let (wrists, count) = roots(
                radius(&axis_5) * radius(&d_6),
                d_5.z - axis_5.z * d_6.z,
                angle(&axis_5) - angle(&d_6),
                middle[5],
            );
            for (wrist, q6) in wrists.into_iter().take(count).enumerate() {
                let Some(q6) = allowed(5, q6) else { continue };
                let q5 = if radius(&d_5) > ROUNDING {
                    angle(&d_5) - angle(&(self.r_56 * turned(q6, &d_6)))
                } else {
                    middle[4]
                };
                let Some(q5) = allowed(4, q5) else { continue };
                // The same axes in frame 1 at q1 = 0.
                let [x_3, z_3] =
                    [x_5, z_5].map(|axis| r_16 * turned(-q6, &self.r_56.tr_mul(&turned(-q5, &axis))));
                let (shoulders, count) = self.shoulder(&x_3, &z_3);
                for (shoulder, [q1, q2]) in shoulders.into_iter().take(count).enumerate() {
                    let (Some(q1), Some(q2)) = (allowed(0, q1), allowed(1, q2)) else { continue };
                    let Some(q3) = allowed(2, self.third(&x_3, q1, q2)) else { continue };
                    let q = [q1, q2, q3, q4, q5, q6, q7];
                    solutions.push(Solution {
                        q: Joints::from_fn(|joint, _| q[joint]),
                        branch: (elbow | wrist << 1 | shoulder << 2) as u8,
                    });
                }
            }
        }
        solutions
    }

    /// The first two joints for axes x and z of link 3 in frame 1 at q1 = 0, and how many ways: 1 or 2.
    fn shoulder(&self, x_3: &Vector3<f64>, z_3: &Vector3<f64>) -> ([[f64; 2]; 2], usize) {
        // Axis 3 leans by `tilt` from axis 1, to one side or the other of the line on which q2 moves it.
        let sine = radius(z_3);
        let tilt = sine.atan2(z_3.z);
        if sine <= ROUNDING {
            // Only the sum of q1 and q3 matters (their difference, when axis 3 points backwards).
            let q2 = self.straight + tilt;
            let q1 = self.third(x_3, 0.0, q2) / 2.0 * z_3.z.signum();
            return ([[q1, q2]; 2], 1);
        }
        let solution = |side: f64| {
            let q1 = (side * z_3.y).atan2(side * z_3.x) - self.lean;
            [q1, self.straight + side * tilt]
        };
        ([solution(1.0), solution(-1.0)], 2)
    }

    /// The third joint, once the first two are given.
    fn third(&self, x_3: &Vector3<f64>, q1: f64, q2: f64) -> f64 {
        let x_2 = turned(-q2, &self.r_12.tr_mul(&turned(-q1, x_3)));
        angle(&self.r_23.tr_mul(&x_2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Kinematics;
    use ramp_robot::random::Stream;
    use std::path::Path;

    pub(super) fn arm(name: &str) -> ArmModel {
        ArmModel::read(&Path::new("../../data/arms").join(name)).unwrap()
    }

    /// Joint positions, uniform in the ranges of `arm`.
    pub(super) fn uniform(arm: &ArmModel, stream: &mut Stream) -> Joints {
        Joints::from_fn(|joint, _| {
            let [low, high] = arm.joints[joint].range;
            low + (high - low) * stream.uniform()
        })
    }

    /// Largest error of `solutions` against `x_wt`, m and rad.
    pub(super) fn error(kinematics: &Kinematics, solutions: &[Solution], x_wt: &Pose) -> f64 {
        let off = |solution: &Solution| {
            let reached = kinematics.tip(&solution.q);
            let shift = (reached.translation.vector - x_wt.translation.vector).norm();
            // Not `angle_to`, whose arc cosine ends at 1e-8.
            let turn = 2.0 * (x_wt.rotation.inverse() * reached.rotation).imag().norm();
            shift.max(turn)
        };
        solutions.iter().map(off).fold(0.0, f64::max)
    }

    /// Distance of the nearest solution from `q`, rad.
    fn distance(solutions: &[Solution], q: &Joints) -> f64 {
        solutions.iter().map(|solution| (solution.q - q).amax()).fold(f64::INFINITY, f64::min)
    }

    /// Checks 100 000 random poses of an arm.
    fn check(arm: &ArmModel) {
        let (kinematics, analytic) = (Kinematics::new(arm), Analytic::new(arm).unwrap());
        let mut stream = Stream::new(1, "analytic");
        let (mut worst, mut furthest): (f64, f64) = (0.0, 0.0);
        let mut counts = [0; BRANCHES + 1];
        for _ in 0..100_000 {
            let q = uniform(arm, &mut stream);
            let x_wt = kinematics.tip(&q);
            let all = analytic.all(&x_wt, q[6]);
            worst = worst.max(error(&kinematics, &all, &x_wt));
            furthest = furthest.max(distance(&all, &q));
            let within = analytic.within(&x_wt, q[6], 0.0);
            assert!(distance(&within, &q) <= distance(&all, &q), "{q}");
            assert!(within.iter().all(|solution| kinematics.range_margin(&solution.q) >= 0.0));
            assert!(within.iter().all(|solution| all.contains(solution)));
            counts[all.len()] += 1;
        }
        println!(
            "{}: error {worst:.1e}, from the original {furthest:.1e} rad, solutions {counts:?}",
            arm.name
        );
        assert!(worst <= 1e-9, "{worst}");
        assert!(furthest <= 1e-6, "{furthest}");
        assert!(counts[BRANCHES] > 0);
    }

    #[test]
    fn every_branch_of_random_poses_reaches_the_pose() {
        check(&arm("panda.json"));
        check(&arm("fr3.json"));
    }

    /// Within the Panda's ranges the bits are signs: of q4 from outstretched, of cos q5 and of q2. So a
    /// branch is left only where two meet.
    #[test]
    fn the_branch_gives_signs_of_the_joints() {
        let arm = arm("panda.json");
        let (kinematics, analytic) = (Kinematics::new(&arm), Analytic::new(&arm).unwrap());
        let mut stream = Stream::new(4, "branch");
        for _ in 0..10_000 {
            let q = uniform(&arm, &mut stream);
            for solution in analytic.within(&kinematics.tip(&q), q[6], 0.0).iter() {
                let q = &solution.q;
                let bits = [q[3] > outstretched(), q[4].cos() > 0.0, q[1] < 0.0];
                let branch = bits.iter().rev().fold(0, |branch, bit| branch << 1 | u8::from(*bit));
                assert_eq!(solution.branch, branch, "{q}");
            }
        }
    }

    /// q4 of the Panda where S, joint 4 and W are in line.
    fn outstretched() -> f64 {
        -(0.0825_f64 / 0.316).atan() - (0.0825_f64 / 0.384).atan()
    }

    /// Poses at which branches meet, and next to it: axes 1 and 3 in line, the elbow stretched, axis 6 in the
    /// arm's plane.
    #[test]
    fn poses_next_to_singular_ones_are_reached() {
        let arm = arm("panda.json");
        let (kinematics, analytic) = (Kinematics::new(&arm), Analytic::new(&arm).unwrap());
        let stretched = outstretched();
        let mut stream = Stream::new(2, "singular");
        let mut worst: f64 = 0.0;
        for round in 0..20_000 {
            let mut q: Joints = uniform(&arm, &mut stream);
            let near = if round % 4 == 0 {
                0.0
            } else {
                stream.symmetric(1.0) * 10_f64.powf(-12.0 * stream.uniform())
            };
            let which = round / 4 % 7 + 1;
            if which & 1 != 0 {
                q[1] = near;
            }
            if which & 2 != 0 {
                q[3] = stretched + near.clamp(-0.3, 0.3);
            }
            if which & 4 != 0 {
                q[4] = std::f64::consts::FRAC_PI_2 + near;
            }
            let x_wt = kinematics.tip(&q);
            let all = analytic.all(&x_wt, q[6]);
            worst = worst.max(error(&kinematics, &all, &x_wt));
            // Next to a meeting of branches, angles are known to the root of the rounding only. Next to axes
            // in line, the turn is shared in another way.
            let mut found = distance(&all, &q);
            if q[1].abs() < 1e-2 {
                let sum = |q: &Joints| (q[0] + q[2] + TAU).rem_euclid(TAU);
                found = all
                    .iter()
                    .map(|solution| {
                        let mut off = solution.q - q;
                        off[2] = sum(&solution.q) - sum(&q);
                        off[2] -= TAU * (off[2] / TAU).round();
                        off[0] = 0.0;
                        off.amax()
                    })
                    .fold(f64::INFINITY, f64::min);
            }
            // Next to both, elbow and wrist, a solution may be less exact or missed, as the documentation
            // says.
            let (elbow, wrist) = (q[3] - stretched, q[4].abs() - std::f64::consts::FRAC_PI_2);
            if elbow.abs().max(wrist.abs()) > 1e-2 {
                assert!(found < 1e-5, "{found:e}: {q} near {near:e}, {which}");
            }
        }
        println!("error {worst:.1e}");
        assert!(worst <= 1e-9, "{worst}");
    }

    #[test]
    fn nothing_is_found_out_of_reach_or_out_of_range() {
        let arm = arm("panda.json");
        let analytic = Analytic::new(&arm).unwrap();
        let far = Pose::translation(2.0, 0.0, 0.5);
        assert!(analytic.all(&far, 0.0).is_empty());
        assert!(analytic.quickest(&far, &Joints::from(arm.home), 0.0).is_none());
        let home = Joints::from(arm.home);
        let x_wt = Kinematics::new(&arm).tip(&home);
        assert!(!analytic.within(&x_wt, home[6], 0.0).is_empty());
        assert!(analytic.within(&x_wt, 3.0, 0.0).is_empty());
        assert!(analytic.best(&x_wt, 0.0, |_| f64::INFINITY).is_none());
        assert!(analytic.quickest(&x_wt, &home, 2.0).is_none());
        let no_number = Pose::translation(f64::NAN, 0.0, 0.5);
        assert!(analytic.all(&no_number, 0.0).is_empty());
    }

    #[test]
    fn arms_of_another_build_are_refused() {
        let refused = |change: fn(&mut ArmModel)| {
            let mut arm = arm("panda.json");
            change(&mut arm);
            Analytic::new(&arm).unwrap_err().to_string()
        };
        assert_eq!(
            refused(|arm| arm.joints[5].position[1] = 0.1),
            "the arm panda has no closed-form inverse kinematics: joint 6 does not stand in the origin of joint 5 \
             (off by 1.00e-1)"
        );
        assert!(refused(|arm| arm.joints[1].position[0] = 0.02).contains("joint 2 does not stand"));
        assert!(refused(|arm| arm.joints[2].position[0] = 0.02).contains("axis 3 does not pass"));
        assert!(refused(|arm| arm.joints[1].quat_wxyz[1] = -0.7).contains("axes 1 and 2 are not"));
        assert!(refused(|arm| arm.joints[2].position[1] = f64::NAN).contains("axis 3 does not pass"));
    }

    /// Another base, another hand and other lengths are read from the file.
    #[test]
    fn lengths_come_from_the_file() {
        let mut arm = arm("panda.json");
        arm.joints[0].position = [0.1, -0.2, 0.4];
        arm.joints[0].quat_wxyz = [0.9, 0.1, -0.2, 0.3];
        arm.joints[2].position[1] = -0.35;
        arm.joints[3].position = [0.07, 0.01, 0.02];
        arm.joints[4].position = [-0.09, 0.4, 0.03];
        arm.joints[4].quat_wxyz = [0.7, -0.6, 0.1, 0.05];
        arm.joints[5].quat_wxyz = [0.7, 0.6, 0.1, 0.05];
        arm.joints[6].position = [0.1, 0.02, -0.01];
        arm.hand.position = [0.01, 0.02, 0.1];
        check(&arm);
    }
}
