//! Forward and inverse kinematics of an arm.

use nalgebra::{Matrix6, Quaternion, SMatrix, Translation3, UnitQuaternion, Vector3, Vector6};
use ramp_robot::DOF;
use ramp_robot::arm::ArmModel;

use crate::space::{Joints, Pose};

/// Accuracy of a solution: distance to its target, in m and rad, and to the rest position of the null space,
/// in rad. Second differences of solutions a centimetre apart are some 1e-4 rad: noise has to be well below.
const TOLERANCE: f64 = 1e-7;
/// Iterations of the inverse before it gives up.
const ITERATIONS: usize = 100;
/// Share of the distance to the posture that one iteration moves in the null space: a full step overshoots
/// where that is strongly curved.
const PULL: f64 = 0.7;
/// Largest change of a joint in one iteration, rad.
const STEP: f64 = 0.2;
/// Damping of the least-squares step: small, since targets are checked to be reached.
const DAMPING: f64 = 1e-4;
/// Distance that solutions keep from the ends of the joints' ranges, rad.
pub const RANGE_MARGIN: f64 = 0.05;

/// The chain of an arm, ready to be evaluated.
#[derive(Clone, Debug)]
pub struct Kinematics<const N: usize = DOF> {
    /// Pose of each joint's frame at angle zero in the frame before.
    fixed: [Pose; N],
    /// The hand's frame in the frame of the last joint.
    x_nh: Pose,
    x_ht: Pose,
    low: Joints<N>,
    high: Joints<N>,
}

/// Poses of the arm's frames in the world.
#[derive(Clone, Debug)]
pub struct Frames<const N: usize = DOF> {
    /// Of each joint's link.
    pub links: [Pose; N],
    /// Of the hand.
    pub hand: Pose,
    /// Of the tip.
    pub tip: Pose,
}

fn pose(position: [f64; 3], q: [f64; 4]) -> Pose {
    let rotation = UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3]));
    Pose::from_parts(Translation3::from(position), rotation)
}

impl<const N: usize> Kinematics<N> {
    /// The kinematics of `arm`.
    pub fn new(arm: &ArmModel<N>) -> Kinematics<N> {
        Kinematics {
            fixed: std::array::from_fn(|joint| pose(arm.joints[joint].position, arm.joints[joint].quat_wxyz)),
            x_nh: pose(arm.hand.position, arm.hand.quat_wxyz),
            x_ht: Pose::translation(0.0, 0.0, arm.hand.tip),
            low: Joints::from_fn(|joint, _| arm.joints[joint].range[0]),
            high: Joints::from_fn(|joint, _| arm.joints[joint].range[1]),
        }
    }

    /// Poses of all frames at joint positions `q` (rad).
    pub fn frames(&self, q: &Joints<N>) -> Frames<N> {
        let mut x = Pose::identity();
        let links = std::array::from_fn(|joint| {
            x = x * self.fixed[joint] * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), q[joint]);
            x
        });
        let hand = x * self.x_nh;
        Frames { links, hand, tip: hand * self.x_ht }
    }

    /// The pose of the tip in the world at `q`.
    pub fn tip(&self, q: &Joints<N>) -> Pose {
        self.frames(q).tip
    }

    /// The Jacobian of the tip at these frames: linear above, angular below, axes of the world.
    pub fn jacobian(&self, frames: &Frames<N>) -> SMatrix<f64, 6, N> {
        let mut jacobian = SMatrix::<f64, 6, N>::zeros();
        let p_tip = frames.tip.translation.vector;
        for joint in 0..N {
            let axis = frames.links[joint].rotation * Vector3::z();
            let arm = p_tip - frames.links[joint].translation.vector;
            jacobian.fixed_view_mut::<3, 1>(0, joint).copy_from(&axis.cross(&arm));
            jacobian.fixed_view_mut::<3, 1>(3, joint).copy_from(&axis);
        }
        jacobian
    }

    /// Distance of the joint nearest to an end of its range, rad; negative outside.
    pub fn range_margin(&self, q: &Joints<N>) -> f64 {
        (0..N)
            .map(|joint| (q[joint] - self.low[joint]).min(self.high[joint] - q[joint]))
            .fold(f64::MAX, f64::min)
    }

    /// The middle of every joint's range, rad.
    pub fn middle(&self) -> Joints<N> {
        (self.low + self.high) / 2.0
    }

    /// Joint positions within their ranges that bring the tip to `x_wt` and are, of all that do, as near to
    /// `posture` as a sequence of small steps from `seed` gets; `None` when the iteration does not arrive.
    ///
    /// Damped least squares, until both the tip and the null space stand still: so the solution depends on
    /// pose and posture, as smoothly as they do, and not on how many steps it took. Small steps from a near
    /// seed stay on the seed's branch.
    pub fn inverse(&self, x_wt: &Pose, seed: &Joints<N>, posture: &Joints<N>) -> Option<Joints<N>> {
        let low = self.low.add_scalar(RANGE_MARGIN);
        let high = self.high.add_scalar(-RANGE_MARGIN);
        let mut q = seed.zip_zip_map(&low, &high, |value, low, high| value.clamp(low, high));
        for iteration in 0..ITERATIONS {
            let frames = self.frames(&q);
            let shift = x_wt.translation.vector - frames.tip.translation.vector;
            let turn = (x_wt.rotation * frames.tip.rotation.inverse()).scaled_axis();
            let error = Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z);
            let mut jacobian = self.jacobian(&frames);
            // The pull fades out late, so that an oscillating null-space motion still ends at the tip's
            // target.
            let fade = (2.0 - 2.0 * iteration as f64 / ITERATIONS as f64).min(1.0);
            let mut pull = (posture - q) * (PULL * fade);
            let mut step = Joints::zeros();
            // A joint at its end that would be pushed on is left out, and the others do its part.
            for _ in 0..N {
                let jjt: Matrix6<f64> =
                    jacobian * jacobian.transpose() + Matrix6::identity() * DAMPING * DAMPING;
                step = jacobian.transpose() * jjt.cholesky()?.solve(&(error - jacobian * pull)) + pull;
                let pushed = |joint: &usize| {
                    (q[*joint] <= low[*joint] && step[*joint] < 0.0)
                        || (q[*joint] >= high[*joint] && step[*joint] > 0.0)
                };
                let Some(joint) = (0..N).find(pushed) else { break };
                jacobian.fill_column(joint, 0.0);
                pull[joint] = 0.0;
                step[joint] = 0.0;
            }
            let largest = step.amax();
            if error.amax() < TOLERANCE && largest < TOLERANCE {
                return Some(q);
            }
            if largest > STEP {
                step *= STEP / largest;
            }
            q = (q + step).zip_zip_map(&low, &high, |value, low, high| value.clamp(low, high));
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn panda() -> ArmModel {
        ArmModel::read(Path::new("../../data/arms/panda.json")).unwrap()
    }

    /// The flange of the Panda in its ready pose stands at (0.3069, 0, 0.5903), as Franka's own tools say.
    #[test]
    fn ready_pose_matches_the_published_one() {
        let kinematics = Kinematics::new(&panda());
        let q = Joints::from([0.0, -1.0, 0.0, -3.0, 0.0, 2.0, 1.0]) * std::f64::consts::FRAC_PI_4;
        let frames = kinematics.frames(&q);
        let flange = frames.hand.translation.vector;
        assert!((flange - Vector3::new(0.30689, 0.0, 0.59027)).norm() < 1e-4, "{flange}");
        let down = frames.tip.rotation * Vector3::z();
        assert!((down + Vector3::z()).norm() < 1e-6);
    }

    #[test]
    fn inverse_arrives_where_forward_went() {
        let kinematics = Kinematics::new(&panda());
        let home = Joints::from(panda().home);
        for (x, y) in [(0.31, 0.03), (0.45, -0.3), (0.6, 0.2), (0.3, -0.45)] {
            let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
            let target = Pose::from_parts(Translation3::new(x, y, 0.1), down);
            let q = kinematics.inverse(&target, &home, &home).unwrap();
            let reached = kinematics.tip(&q);
            assert!((reached.translation.vector - target.translation.vector).norm() < 2e-6);
            assert!(reached.rotation.angle_to(&target.rotation) < 2e-6);
            assert!(kinematics.range_margin(&q) > 0.0);
        }
    }

    /// Solutions that do not follow the pose smoothly would make the arm slow down, or shake.
    #[test]
    fn solutions_along_a_line_are_smooth_to_the_second_difference() {
        let kinematics = Kinematics::new(&panda());
        let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        let pose = |share: f64| {
            Pose::from_parts(Translation3::new(0.4 + 0.2 * share, -0.3 + 0.6 * share, 0.15), down)
        };
        let home = Joints::from(panda().home);
        let solve = |share: f64, seed: &Joints, posture: &Joints| {
            kinematics.inverse(&pose(share), seed, posture).unwrap()
        };
        let (start, goal) = (solve(0.0, &home, &home), solve(1.0, &home, &home));
        let mut line = vec![start];
        for sample in 1..=60 {
            let share = f64::from(sample) / 60.0;
            line.push(solve(share, &line[line.len() - 1], &start.lerp(&goal, share)));
        }
        assert!((line[60] - goal).amax() < 1e-4, "another branch");
        // Bends are up to 0.7 mrad here, and change little from one sample to the next.
        for four in line.windows(4) {
            let jump = (four[3] - 3.0 * four[2] + 3.0 * four[1] - four[0]).amax();
            assert!(jump < 0.1e-3, "{jump}");
        }
    }
}
