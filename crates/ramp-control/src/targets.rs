//! Targets of the commanded motion, and the inner loop that follows them.

use nalgebra::Vector6;
use ramp_robot::arm::ArmModel;
use ramp_robot::{ArmCommand, DOF, Impedance, Pose, RobotError};

use crate::commanded::{JointMotion, PoseMotion};
use crate::follow::Follower;
use crate::handover::Mode;
use crate::impedance::{impedance, pose_impedance};
use crate::joints::{track_joints, track_velocities};
use crate::state::{ArmState, JointVector};

/// The share of its velocity that a target keeps in each period without a new command. Chosen: a single late
/// command is hardly felt, and the arm brakes within some ten periods.
const FADE: f64 = 0.9;

/// The distance from which a stopped arm is not brought back, rad. Chosen: there the springs of the joints
/// have the torques that these can have.
const HOLDS: f64 = 0.02;

/// The targets of the last period.
#[derive(Clone, Debug)]
pub(crate) struct Targets {
    /// Command of the last period; `None` before the first one.
    command: Option<ArmCommand>,
    /// Target of the joints, if joint positions were commanded.
    joints: Option<JointMotion>,
    /// Target of the tip, if a pose or an impedance was commanded, and whether it was a pose.
    pose: Option<(PoseMotion, bool)>,
    /// The share of the target's velocity that has not faded: 1 after a command that came in time.
    kept: f64,
    /// The motion that the inner loops follow, whatever the kind of command.
    follower: Follower,
    /// Posture that a pose command without a posture keeps, rad.
    posture: [f64; DOF],
}

impl Targets {
    /// Before any command, with the arm at `home` (rad).
    pub fn new(home: &[f64; DOF]) -> Targets {
        Targets {
            command: None,
            joints: None,
            pose: None,
            kept: 1.0,
            follower: Follower::Free,
            posture: *home,
        }
    }

    /// Holding these joint positions (rad). The next command begins a motion where the arm stands by then.
    pub fn standing(positions: &JointVector) -> Targets {
        let command = Some(ArmCommand::JointPositions((*positions).into()));
        Targets { command, ..Targets::new(&(*positions).into()) }
    }

    /// The same, to be followed from wherever the arm is.
    #[must_use]
    pub fn begun_anew(self) -> Targets {
        Targets { follower: Follower::Free, ..self }
    }

    /// The joint torques for one period of a command, N·m.
    ///
    /// # Errors
    /// [`RobotError::NotSmooth`] for a command that the arm cannot follow from the one before.
    pub fn torques(
        &mut self,
        arm: &ArmModel,
        state: &ArmState,
        command: &ArmCommand,
    ) -> Result<JointVector, RobotError> {
        let joints_before = self.joints.take();
        let pose_before = self.pose.take();
        match command {
            ArmCommand::JointPositions(positions) => {
                let positions = JointVector::from(*positions);
                let target = match joints_before {
                    Some(before) => {
                        let target = before.next(positions);
                        target.check(&before, arm)?;
                        target
                    }
                    None => {
                        let target = JointMotion::at_rest(positions);
                        target.check_start(&state.positions)?;
                        target
                    }
                };
                self.joints = Some(target);
                self.posture = target.positions.into();
            }
            ArmCommand::CartesianPose(x_wt) => {
                let target = match pose_before {
                    Some((before, true)) => {
                        let target = before.next(*x_wt);
                        if let Some(limits) = &arm.cartesian {
                            target.check(&before, limits)?;
                        }
                        target
                    }
                    _ => {
                        let target = PoseMotion::at_rest(*x_wt);
                        target.check_start(&state.x_wt)?;
                        target
                    }
                };
                self.pose = Some((target, true));
            }
            ArmCommand::CartesianImpedance(Impedance { x_wt, .. }) => {
                let target = match pose_before {
                    Some((before, _)) => before.next(*x_wt),
                    None => PoseMotion::at_rest(*x_wt),
                };
                self.pose = Some((target, false));
            }
            ArmCommand::JointVelocities(_) | ArmCommand::JointTorques(_) => {}
        }
        self.kept = 1.0;
        let torques = self.followed(arm, state, command);
        self.command = Some(command.clone());
        Ok(torques)
    }

    /// The joint torques for one period without a command, N·m, and the kind of command that is held.
    pub fn late(&mut self, arm: &ArmModel, state: &ArmState) -> (Mode, JointVector) {
        self.kept *= FADE;
        let command = self.command.clone().unwrap_or(ArmCommand::JointPositions(arm.home));
        (Mode::of(&command), self.followed(arm, state, &command))
    }

    /// The joint torques that bring the arm to rest at once, at its target positions or, if it was pushed on
    /// from there, near where it comes to rest, N·m.
    pub fn held(&mut self, state: &ArmState) -> JointVector {
        let before = match &self.command {
            Some(ArmCommand::JointPositions(positions)) => JointVector::from(*positions),
            _ => state.positions,
        };
        let positions = JointVector::from_fn(|joint, _| {
            let now = state.positions[joint];
            before[joint].clamp(now - HOLDS, now + HOLDS)
        });
        self.joints = None;
        self.command = Some(ArmCommand::JointPositions(positions.into()));
        track_joints(state, &positions, &JointVector::zeros(), &JointVector::zeros())
    }

    /// The joint torques that follow the target of `command`, N·m.
    fn followed(&mut self, arm: &ArmModel, state: &ArmState, command: &ArmCommand) -> JointVector {
        match command {
            ArmCommand::JointPositions(positions) => {
                let target = self.joints.unwrap_or(JointMotion::at_rest(JointVector::from(*positions)));
                let target = JointMotion {
                    positions: target.positions,
                    velocities: target.velocities * self.kept,
                    accelerations: self.in_time(target.accelerations),
                };
                let motion = self.follower.joints(&target, state, arm);
                track_joints(state, &motion.positions, &motion.velocities, &motion.accelerations)
            }
            ArmCommand::JointVelocities(velocities) => {
                let wanted = JointVector::from(*velocities);
                let [velocities, accelerations] = self.follower.velocities(&wanted, state, arm);
                track_velocities(state, &velocities, &accelerations)
            }
            ArmCommand::JointTorques(torques) => {
                self.follower = Follower::Free;
                JointVector::from(*torques)
            }
            ArmCommand::CartesianPose(x_wt) => {
                let target = self.pose_target(x_wt);
                let motion = self.follower.pose(&target, state, arm);
                let [velocity, acceleration] = fed_forward(&motion);
                impedance(state, &pose_impedance(&motion.x_wt, self.posture), &velocity, &acceleration)
            }
            ArmCommand::CartesianImpedance(command) => {
                self.follower = Follower::Free;
                let [velocity, acceleration] = fed_forward(&self.pose_target(&command.x_wt));
                impedance(state, command, &velocity, &acceleration)
            }
        }
    }

    /// The target of the tip, faded as far as commands are late.
    fn pose_target(&self, x_wt: &Pose) -> PoseMotion {
        let target = self.pose.map_or(PoseMotion::at_rest(*x_wt), |(target, _)| target);
        PoseMotion {
            x_wt: target.x_wt,
            velocity: target.velocity * self.kept,
            acceleration: self.in_time(target.acceleration),
        }
    }

    /// An acceleration that holds only while commands come in time.
    fn in_time<const N: usize>(&self, acceleration: nalgebra::SVector<f64, N>) -> nalgebra::SVector<f64, N> {
        if self.kept < 1.0 { nalgebra::SVector::zeros() } else { acceleration }
    }
}

/// Velocity (m/s, rad/s) and acceleration (m/s², rad/s²) of the target of an impedance, as far as they are
/// those of a motion and not of a jump: an impedance may jump.
fn fed_forward(target: &PoseMotion) -> [Vector6<f64>; 2] {
    const VELOCITY: f64 = 0.5;
    const ACCELERATION: f64 = 5.0;
    [
        target.velocity.map(|value| value.clamp(-VELOCITY, VELOCITY)),
        target.acceleration.map(|value| value.clamp(-ACCELERATION, ACCELERATION)),
    ]
}
