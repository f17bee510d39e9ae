//! The motion that the inner loops follow, from one kind of command to the next.
//!
//! A commanded motion is checked against the one before it, as long as the kind of command stays the same.
//! After a change of the kind, a hold or a stop, nothing connects the two. So the inner
//! loops follow a motion of their own, which is never forgotten: the commanded one and a rest. The rest is
//! the difference between both where the commanded motion jumped, and vanishes within shares of the limits of
//! acceleration and jerk. Commanded joint velocities that jump are followed within the limits as well,
//! without passing the commanded ones. After another kind of command, the motion begins where the arm is,
//! with the joint velocities that were commanded last, or with those of the arm where torques, poses or an
//! impedance moved it.

use nalgebra::{SVector, Translation3, UnitQuaternion, Vector3, Vector6};
use ramp_robot::arm::{ArmJoint, ArmModel};
use ramp_robot::{DOF, PERIOD, Pose};

use crate::commanded::{JointMotion, PoseMotion};
use crate::fastest::{Limits, Moving, pose_limits};
use crate::state::{ArmState, JointVector};

/// Shares of the limits of acceleration and jerk within which a rest vanishes, and velocities that jump are
/// followed. Chosen: torques that change so slowly reach a real arm in time, so that the arm itself keeps the
/// limits, too.
const CALM: [f64; 2] = [0.5, 0.1];

/// Frequency of the critically damped motion in which a rest vanishes, rad/s. Chosen: an arm that moved comes
/// back at an eighth of its velocity, and does not pass its target then.
const RATE: f64 = 20.0;

/// Distance from the arm (rad, m) at which a motion may begin without a rest. Chosen: the stiffest joint
/// feels a twentieth of a newton metre.
const NEAR: f64 = 1e-5;
/// Size at which a rest has vanished: rad and m, rad/s and m/s.
const VANISHED: f64 = 1e-7;

/// The motion of the last period.
#[derive(Clone, Debug, Default)]
pub enum Follower {
    /// The arm was moved by torques or an impedance, or is to begin anew: only its own motion counts.
    #[default]
    Free,
    /// Joint positions.
    Joints(Followed<JointMotion, DOF>),
    /// Joint velocities.
    Velocities(FollowedVelocities),
    /// Poses of the tip.
    Pose(Followed<PoseMotion, 6>),
}

/// Joint velocities that are followed.
#[derive(Clone, Debug)]
pub struct FollowedVelocities {
    /// Followed in the last period, rad/s.
    velocities: JointVector,
    /// Their accelerations, rad/s².
    accelerations: JointVector,
    /// Commanded in the last period, rad/s.
    commanded: JointVector,
}

/// A commanded motion and the one that is followed.
#[derive(Clone, Debug)]
pub struct Followed<M, const N: usize> {
    /// Followed in the last period.
    motion: M,
    /// Commanded in the last period; `None` before the first.
    target: Option<M>,
    /// The followed motion relative to the commanded one, while they differ.
    rest: Option<Moving<N>>,
}

impl<M, const N: usize> Followed<M, N> {
    fn new(motion: M) -> Followed<M, N> {
        Followed { motion, target: None, rest: None }
    }
}

impl Follower {
    /// The motion to follow in this period, when joints are commanded to `target`.
    pub fn joints(&mut self, target: &JointMotion, state: &ArmState, arm: &ArmModel) -> JointMotion {
        let before = match std::mem::take(self) {
            Follower::Joints(followed) => followed,
            Follower::Velocities(FollowedVelocities { velocities, accelerations, .. }) => {
                Followed::new(JointMotion { positions: state.positions, velocities, accelerations })
            }
            Follower::Free | Follower::Pose(_) => Followed::new(JointMotion {
                velocities: state.velocities,
                ..JointMotion::at_rest(state.positions)
            }),
        };
        let followed = next_joints(before, target, arm);
        let motion = followed.motion;
        *self = Follower::Joints(followed);
        motion
    }

    /// The velocities (rad/s) and accelerations (rad/s²) to follow in this period, when `wanted` (rad/s) are
    /// commanded.
    pub fn velocities(&mut self, wanted: &JointVector, state: &ArmState, arm: &ArmModel) -> [JointVector; 2] {
        let before = match std::mem::take(self) {
            Follower::Velocities(before) => before,
            Follower::Joints(Followed { motion, .. }) => FollowedVelocities {
                velocities: motion.velocities,
                accelerations: motion.accelerations,
                commanded: motion.velocities,
            },
            Follower::Free | Follower::Pose(_) => FollowedVelocities {
                velocities: state.velocities,
                accelerations: JointVector::zeros(),
                commanded: state.velocities,
            },
        };
        let accelerations = JointVector::from_fn(|joint, _| {
            let reached = (before.commanded[joint] - before.velocities[joint]).abs() < VANISHED;
            let missing = wanted[joint] - before.velocities[joint];
            acceleration(missing, before.accelerations[joint], reached, &arm.joints[joint])
        });
        let velocities = before.velocities + accelerations * PERIOD;
        *self = Follower::Velocities(FollowedVelocities { velocities, accelerations, commanded: *wanted });
        [velocities, accelerations]
    }

    /// The motion to follow in this period, when the tip is commanded to `target`.
    pub fn pose(&mut self, target: &PoseMotion, state: &ArmState, arm: &ArmModel) -> PoseMotion {
        let before = match std::mem::take(self) {
            Follower::Pose(followed) => followed,
            _ => Followed::new(PoseMotion {
                velocity: state.jacobian * state.velocities,
                ..PoseMotion::at_rest(state.x_wt)
            }),
        };
        let followed = next_pose(before, target, arm);
        let motion = followed.motion;
        *self = Follower::Pose(followed);
        motion
    }
}

fn next_joints(
    Followed { motion: before, target: commanded, rest }: Followed<JointMotion, DOF>,
    target: &JointMotion,
    arm: &ArmModel,
) -> Followed<JointMotion, DOF> {
    let goes_on = commanded.is_some_and(|it| it.next(target.positions).check(&it, arm).is_ok());
    let limits = calm(of_joints(arm));
    let rest = if goes_on {
        rest
    } else {
        begun(
            Moving {
                position: before.positions - target.positions,
                velocity: before.velocities - target.velocities,
                acceleration: before.accelerations - target.accelerations,
            },
            &(of_joints(arm)[1] * PERIOD),
        )
    };
    let rest = rest.and_then(|rest| vanishing(&rest, &limits));
    let motion = match &rest {
        Some(rest) => JointMotion {
            positions: target.positions + rest.position,
            velocities: target.velocities + rest.velocity,
            accelerations: target.accelerations + rest.acceleration,
        },
        None => *target,
    };
    Followed { motion, target: Some(*target), rest }
}

fn next_pose(
    Followed { motion: before, target: commanded, rest }: Followed<PoseMotion, 6>,
    target: &PoseMotion,
    arm: &ArmModel,
) -> Followed<PoseMotion, 6> {
    let Some(limits) = &arm.cartesian else {
        return Followed { motion: *target, target: Some(*target), rest: None };
    };
    let goes_on = commanded.is_some_and(|it| it.next(target.x_wt).check(&it, limits).is_ok());
    let rest = if goes_on {
        rest
    } else {
        let shift = before.x_wt.translation.vector - target.x_wt.translation.vector;
        let turn = (before.x_wt.rotation * target.x_wt.rotation.inverse()).scaled_axis();
        begun(
            Moving {
                position: Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z),
                velocity: before.velocity - target.velocity,
                acceleration: before.acceleration - target.acceleration,
            },
            &(pose_limits(limits)[1] * PERIOD),
        )
    };
    let rest = rest.and_then(|rest| vanishing(&rest, &calm(pose_limits(limits))));
    let motion = match &rest {
        Some(rest) => PoseMotion {
            x_wt: moved(&target.x_wt, &rest.position),
            velocity: target.velocity + rest.velocity,
            acceleration: target.acceleration + rest.acceleration,
        },
        None => *target,
    };
    Followed { motion, target: Some(*target), rest }
}

/// A rest that begins, unless it is so small that the arm can make it vanish in one period: `velocity` (rad/s
/// or m/s) is the largest that it can.
fn begun<const N: usize>(rest: Moving<N>, velocity: &SVector<f64, N>) -> Option<Moving<N>> {
    let slow = (0..N).all(|axis| rest.velocity[axis].abs() <= velocity[axis]);
    (rest.position.amax() > NEAR || !slow).then_some(rest)
}

/// The rest one period later; `None` when it has vanished.
fn vanishing<const N: usize>(rest: &Moving<N>, [_, most, jerk]: &Limits<N>) -> Option<Moving<N>> {
    let acceleration = SVector::<f64, N>::from_fn(|axis, _| {
        let damped = -2.0 * RATE * rest.velocity[axis] - RATE * RATE * rest.position[axis];
        let (before, step) = (rest.acceleration[axis], jerk[axis] * PERIOD);
        damped.clamp(-most[axis], most[axis]).clamp(before - step, before + step)
    });
    let velocity = rest.velocity + acceleration * PERIOD;
    let next = Moving { position: rest.position + velocity * PERIOD, velocity, acceleration };
    (next.position.amax() > VANISHED || next.velocity.amax() > VANISHED).then_some(next)
}

/// Limits of velocity, acceleration and jerk of the joints.
fn of_joints(arm: &ArmModel) -> Limits<DOF> {
    let of = |limit: fn(&ArmJoint) -> f64| JointVector::from_fn(|joint, _| limit(&arm.joints[joint]));
    [of(|joint| joint.velocity), of(|joint| joint.acceleration), of(|joint| joint.jerk)]
}

/// The limits within which a rest vanishes.
fn calm<const N: usize>([velocity, acceleration, jerk]: Limits<N>) -> Limits<N> {
    [velocity, acceleration * CALM[0], jerk * CALM[1]]
}

/// The pose that is shifted (m) and turned (rad) from `x_wt`, in axes of the world.
fn moved(x_wt: &Pose, by: &Vector6<f64>) -> Pose {
    let shift: Vector3<f64> = by.fixed_rows::<3>(0).into_owned();
    let turn = UnitQuaternion::from_scaled_axis(by.fixed_rows::<3>(3).into_owned());
    Pose::from_parts(Translation3::from(x_wt.translation.vector + shift), turn * x_wt.rotation)
}

/// The acceleration (rad/s²) of one period that brings the velocity of a joint nearer to the commanded one,
/// by `missing` (rad/s) at most, after the acceleration `before`. Only velocities whose command was `reached`
/// in the last period follow the next command at once: others would arrive with an acceleration that cannot
/// end in time.
fn acceleration(missing: f64, before: f64, reached: bool, joint: &ArmJoint) -> f64 {
    let at_once = missing / PERIOD;
    let [most, jerk] = [joint.acceleration, joint.jerk];
    if reached && at_once.abs() <= most && (at_once - before).abs() <= jerk * PERIOD {
        return at_once;
    }
    let [most, jerk] = [most * CALM[0], jerk * CALM[1]];
    let step = jerk * PERIOD;
    // From this acceleration, falling by a step in each of `periods` further ones, the velocity just
    // reaches the commanded one.
    let sum = at_once.abs();
    let periods = (((1.0 + 8.0 * sum / step).sqrt() - 1.0) / 2.0).floor();
    let falling = sum / (periods + 1.0) + periods * step / 2.0;
    let wanted = falling.min(most).copysign(missing);
    wanted.clamp(before - step, before + step)
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use std::path::Path;

    use nalgebra::SMatrix;

    use super::*;
    use crate::state::Jacobian;

    fn panda() -> ArmModel {
        ArmModel::read(Path::new("../../data/arms/panda.json")).unwrap()
    }

    fn at(positions: JointVector, velocities: JointVector) -> ArmState {
        ArmState {
            positions,
            velocities,
            x_wt: Pose::identity(),
            jacobian: Jacobian::zeros(),
            inertia: SMatrix::identity(),
        }
    }

    /// Velocities that jump are followed within the limits of acceleration and jerk, and are reached.
    #[test]
    fn velocities_that_jump_are_followed_within_the_limits() {
        let arm = panda();
        let state = at(arm.home.into(), JointVector::zeros());
        let mut follower = Follower::Free;
        let mut before = [JointVector::zeros(); 2];
        for period in 0..2000 {
            let wanted = JointVector::repeat(if period / 500 % 2 == 0 { 0.7 } else { -0.7 });
            let now = follower.velocities(&wanted, &state, &arm);
            for (joint, limits) in arm.joints.iter().enumerate() {
                let jerk = (now[1][joint] - before[1][joint]) / PERIOD;
                assert!(now[1][joint].abs() <= limits.acceleration && jerk.abs() <= limits.jerk * 1.0001);
                assert!(now[0][joint].abs() <= 0.7 + 1e-9, "{}", now[0][joint]);
            }
            if period % 500 == 499 {
                assert!((now[0] - wanted).amax() < 1e-9, "{}", now[0]);
            }
            before = now;
        }
    }

    /// An arm that moves when positions are commanded brakes, and comes back slowly: one that came back as
    /// fast as it can would pass its target by millimetres.
    #[test]
    fn an_arm_that_moved_comes_back_slowly() {
        let arm = panda();
        let home = JointVector::from(arm.home);
        let speed = 0.05;
        let mut follower = Follower::Free;
        let moving = at(home, JointVector::repeat(speed));
        let motions: Vec<JointMotion> =
            (0..1000).map(|_| follower.joints(&JointMotion::at_rest(home), &moving, &arm)).collect();
        let farthest = motions.iter().map(|motion| (motion.positions - home).amax()).fold(0.0, f64::max);
        let back = motions.iter().map(|motion| -motion.velocities.min()).fold(0.0, f64::max);
        assert!(farthest < 2e-3, "{farthest}");
        assert!(back > 0.0 && back < speed / 6.0, "{back}");
    }

    /// A motion of positions goes on in velocities without a jump, and back: the velocity is carried over.
    #[test]
    fn the_velocity_is_carried_from_one_kind_of_command_to_the_next() {
        let arm = panda();
        let home = JointVector::from(arm.home);
        let moving = JointVector::repeat(0.4);
        let mut follower = Follower::Free;
        // The arm moves, and positions are commanded at which it has to stand.
        let mut last = home;
        let mut speed = moving;
        for _ in 0..1500 {
            let motion = follower.joints(&JointMotion::at_rest(home), &at(home, moving), &arm);
            let now = (motion.positions - last) / PERIOD;
            let change = (now - speed) / PERIOD;
            for (joint, limits) in arm.joints.iter().enumerate() {
                assert!(change[joint].abs() <= limits.acceleration, "{}", change[joint]);
            }
            (last, speed) = (motion.positions, now);
        }
        assert!((last - home).amax() < 1e-9, "{}", last - home);
        // A motion within the limits is followed as it is commanded.
        let next = JointMotion::at_rest(home).next(home + JointVector::repeat(1e-6));
        assert_eq!(follower.joints(&next, &at(home, moving), &arm), next);
        // At once, as velocities of zero.
        let [velocities, _] = follower.velocities(&JointVector::zeros(), &at(home, moving), &arm);
        assert!((velocities - next.velocities).amax() <= 0.02, "{velocities}");
    }
}
