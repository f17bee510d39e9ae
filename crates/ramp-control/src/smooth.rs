//! Makes commanded positions and poses smooth: for agents that command where the arm should be, and not how
//! it gets there.
//!
//! Each command goes through a [`Smoother`] on its way to the robot. A target that follows from the one
//! before within the arm's limits passes as it is. Towards one that does not, the arm goes as fast as
//! velocity, acceleration and jerk allow, and comes to rest there; Ruckig (the crate `rsruckig`) finds that
//! motion anew each period.

use nalgebra::{Translation3, UnitQuaternion, Vector3, Vector6};
use ramp_robot::arm::ArmModel;
use ramp_robot::{ArmCommand, Command, DOF, Observation, Pose};

use crate::commanded::{JointMotion, PoseMotion};
use crate::fastest::{Moving, joint_limits, pose_limits, towards};
use crate::state::JointVector;

/// Makes the commands of one agent smooth, one after the other.
pub struct Smoother {
    arm: ArmModel,
    joints: Option<Followed<JointMotion, JointVector, DOF>>,
    /// On six axes: the tip's point, then its turn from where it is.
    pose: Option<Followed<PoseMotion, Pose, 6>>,
}

/// Result of the last command.
struct Followed<M, T, const N: usize> {
    /// The target that the robot got.
    motion: M,
    /// The target that was commanded.
    asked: T,
    /// Motion of the robot's target while it differs from the commanded one.
    moving: Option<Moving<N>>,
}

impl Smoother {
    /// For an arm that was not commanded before.
    pub fn new(arm: &ArmModel) -> Smoother {
        Smoother { arm: arm.clone(), joints: None, pose: None }
    }

    /// The next command begins a new motion from where the arm is: after a stop of the arm.
    pub fn begin_anew(&mut self) {
        (self.joints, self.pose) = (None, None);
    }

    /// The command to give to the robot for this period in place of `command`, and whether it is another one.
    /// `seen` is the last observation. Only joint positions and poses are changed.
    pub fn smooth(&mut self, command: &Command, seen: &Observation) -> (Command, bool) {
        let (joints, pose) = (self.joints.take(), self.pose.take());
        let arm = match &command.arm {
            ArmCommand::JointPositions(positions) => {
                let asked = JointVector::from(*positions);
                let next = match joints {
                    Some(before) => self.next_joints(before, asked),
                    None => {
                        let here = JointVector::from(seen.positions);
                        let there = JointMotion::at_rest(asked);
                        let near = there.check_start(&here).is_ok();
                        let motion = if near { there } else { JointMotion::at_rest(here) };
                        Followed { motion, asked, moving: None }
                    }
                };
                ArmCommand::JointPositions(self.joints.insert(next).motion.positions.into())
            }
            ArmCommand::CartesianPose(x_wt) => {
                let next = match pose {
                    Some(before) => self.next_pose(before, *x_wt),
                    None => {
                        let there = PoseMotion::at_rest(*x_wt);
                        let near = there.check_start(&seen.x_wt).is_ok();
                        let motion = if near { there } else { PoseMotion::at_rest(seen.x_wt) };
                        Followed { motion, asked: *x_wt, moving: None }
                    }
                };
                ArmCommand::CartesianPose(self.pose.insert(next).motion.x_wt)
            }
            other => other.clone(),
        };
        let changed = arm != command.arm;
        (Command { arm, gripper: command.gripper }, changed)
    }

    fn next_joints(
        &self,
        followed: Followed<JointMotion, JointVector, DOF>,
        target: JointVector,
    ) -> Followed<JointMotion, JointVector, DOF> {
        let Followed { motion: before, asked, moving } = followed;
        let next = before.next(target);
        // A target that has been reached must not be lost at once: its motion is continued.
        let on = next.next(target + (target - asked));
        if next.check(&before, &self.arm).is_ok() && (moving.is_none() || on.check(&next, &self.arm).is_ok())
        {
            return Followed { motion: next, asked: target, moving: None };
        }
        let joint = |index: usize| &self.arm.joints[index];
        let low = JointVector::from_fn(|index, _| joint(index).range[0]);
        let high = JointVector::from_fn(|index, _| joint(index).range[1]);
        let limits = joint_limits(&self.arm, &before.positions, &target);
        let estimated = || Moving::estimated(before.positions, before.velocities, before.accelerations);
        let from = moving.unwrap_or_else(estimated);
        match towards::<DOF>(&from, &target.sup(&low).inf(&high), &limits) {
            Some(there) => {
                Followed { motion: before.next(there.position), asked: target, moving: Some(there) }
            }
            None => Followed { motion: before.next(before.positions), asked: target, moving: None },
        }
    }

    fn next_pose(
        &self,
        followed: Followed<PoseMotion, Pose, 6>,
        target: Pose,
    ) -> Followed<PoseMotion, Pose, 6> {
        let Followed { motion: before, asked, moving } = followed;
        let next = before.next(target);
        let passed = |motion| Followed { motion, asked: target, moving: None };
        let Some(limits) = &self.arm.cartesian else { return passed(next) };
        let shift = target.translation.vector - asked.translation.vector;
        let on = Pose::from_parts(
            Translation3::from(target.translation.vector + shift),
            target.rotation * asked.rotation.inverse() * target.rotation,
        );
        let goes_on = || next.next(on).check(&next, limits).is_ok();
        if next.check(&before, limits).is_ok() && (moving.is_none() || goes_on()) {
            return passed(next);
        }
        // Turns are measured from where the tip is now.
        let joined =
            |p: &Vector3<f64>, turn: &Vector3<f64>| Vector6::new(p.x, p.y, p.z, turn.x, turn.y, turn.z);
        let position = joined(&before.x_wt.translation.vector, &Vector3::zeros());
        let from = match moving {
            Some(moving) => Moving { position, ..moving },
            None => Moving::estimated(position, before.velocity, before.acceleration),
        };
        let turn = (target.rotation * before.x_wt.rotation.inverse()).scaled_axis();
        let limits = pose_limits(limits);
        let aim = joined(&target.translation.vector, &turn);
        let Some(there) = towards::<6>(&from, &aim, &limits) else {
            return passed(before.next(before.x_wt));
        };
        let turn = UnitQuaternion::from_scaled_axis(there.position.fixed_rows::<3>(3).into_owned());
        let p = Translation3::from(there.position.fixed_rows::<3>(0).into_owned());
        let motion = before.next(Pose::from_parts(p, turn * before.x_wt.rotation));
        Followed { motion, asked: target, moving: Some(there) }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use proptest::prelude::*;
    use ramp_robot::{GripperCommand, PERIOD};

    use super::*;

    fn panda() -> ArmModel {
        ArmModel::read(Path::new("../../data/arms/panda.json")).unwrap()
    }

    fn at(positions: JointVector, x_wt: Pose) -> Observation {
        Observation {
            time: 0.0,
            positions: positions.into(),
            velocities: [0.0; DOF],
            torques: [0.0; DOF],
            x_wt,
            wrench: Vector6::zeros(),
            width: 0.04,
            gripper_busy: false,
            touch: None,
        }
    }

    fn command(arm: ArmCommand) -> Command {
        Command { arm, gripper: GripperCommand { width: 0.04, force: 10.0 } }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        /// Whatever jumps an agent commands, the robot is never asked for more than its limits, and it
        /// arrives.
        #[test]
        fn jumps_of_joints_become_motions(
            jumps in prop::collection::vec((prop::array::uniform7(-0.6..0.6f64), 1usize..80), 1..12)
        ) {
            let arm = panda();
            let home = JointVector::from(arm.home);
            let mut smoother = Smoother::new(&arm);
            let seen = at(home, Pose::identity());
            let mut last = None;
            let mut target = home;
            let settled = [([0.0; DOF], 2500)];
            for (jump, periods) in jumps.into_iter().chain(settled) {
                target = home + JointVector::from(jump);
                for _ in 0..periods {
                    let (smooth, _) = smoother.smooth(&command(ArmCommand::JointPositions(target.into())), &seen);
                    let ArmCommand::JointPositions(positions) = smooth.arm else { unreachable!() };
                    let positions = JointVector::from(positions);
                    let next = last.map_or(JointMotion::at_rest(positions), |it: JointMotion| it.next(positions));
                    let checked = last.map_or(next.check_start(&home), |it| next.check(&it, &arm));
                    prop_assert!(checked.is_ok(), "{:?}", checked);
                    last = Some(next);
                }
            }
            let last = last.unwrap();
            prop_assert!((last.positions - target).amax() < 1e-6, "{}", last.positions - target);
        }

        /// The same for poses.
        #[test]
        fn jumps_of_poses_become_motions(
            jumps in prop::collection::vec((prop::array::uniform6(-0.4..0.4f64), 1usize..80), 1..12)
        ) {
            let arm = panda();
            let limits = arm.cartesian.clone().unwrap();
            let mut smoother = Smoother::new(&arm);
            let seen = at(JointVector::from(arm.home), Pose::identity());
            let mut last = None;
            let mut target = Pose::identity();
            for (jump, periods) in jumps.into_iter().chain([([0.0; 6], 2500)]) {
                let turn = UnitQuaternion::from_scaled_axis(Vector3::new(jump[3], jump[4], jump[5]) * 3.0);
                target = Pose::from_parts(Translation3::new(jump[0], jump[1], jump[2]), turn);
                for _ in 0..periods {
                    let (smooth, _) = smoother.smooth(&command(ArmCommand::CartesianPose(target)), &seen);
                    let ArmCommand::CartesianPose(x_wt) = smooth.arm else { unreachable!() };
                    let next = last.map_or(PoseMotion::at_rest(x_wt), |it: PoseMotion| it.next(x_wt));
                    let checked = last.map_or(next.check_start(&seen.x_wt), |it| next.check(&it, &limits));
                    prop_assert!(checked.is_ok(), "{:?}", checked);
                    last = Some(next);
                }
            }
            let last = last.unwrap();
            let off = last.x_wt.inverse() * target;
            let [distance, angle] = [off.translation.vector.norm(), off.rotation.angle()];
            prop_assert!(distance < 1e-6 && angle < 1e-5, "{distance:e} {angle:e}");
        }
    }

    /// A motion within the limits is not touched, to the last bit.
    #[test]
    fn smooth_commands_pass() {
        let arm = panda();
        let home = JointVector::from(arm.home);
        let mut smoother = Smoother::new(&arm);
        let seen = at(home, Pose::identity());
        for period in 0..3000 {
            let time = f64::from(period) * PERIOD;
            let mut positions = home;
            positions[0] += 0.2 * (1.0 - (1.5 * time).cos()) * (time / 3.0);
            let asked = command(ArmCommand::JointPositions(positions.into()));
            assert_eq!(smoother.smooth(&asked, &seen), (asked, false));
        }
    }
}
