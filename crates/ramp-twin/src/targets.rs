//! Targets of the commanded motion, and the inner loop that follows them.

use ramp_control::{
    ArmState, Follower, JointMotion, JointVector, PoseMotion, impedance, pose_impedance, track_joints,
    track_velocities,
};
use ramp_robot::arm::ArmModel;
use ramp_robot::{ArmCommand, Command, DOF, GripperCommand, RobotError};

use crate::command::fed_forward;

/// Width of the gripper at the start, m.
pub(crate) const START_WIDTH: f64 = 0.04;
/// Command of the gripper before the first command.
const START_GRIPPER: GripperCommand = GripperCommand { width: START_WIDTH, force: 10.0 };

/// The targets of the last period.
#[derive(Clone)]
pub(crate) struct Targets {
    /// Command of the last period.
    pub command: Option<Command>,
    /// Target of the joints, if joint positions were commanded.
    pub joints: Option<JointMotion>,
    /// Target of the tip, if a pose or an impedance was commanded, and whether it was a pose.
    pub pose: Option<(PoseMotion, bool)>,
    /// The motion that the inner loops follow, whatever the kind of command.
    pub follower: Follower,
    /// Posture that a pose command without a posture keeps, rad.
    pub posture: [f64; DOF],
    /// Is the last command held, without the agent commanding it?
    pub holding: bool,
}

impl Targets {
    /// At `home` (rad), before any command.
    pub fn new(home: &[f64; DOF]) -> Targets {
        Targets {
            command: None,
            joints: None,
            pose: None,
            follower: Follower::Free,
            posture: *home,
            holding: false,
        }
    }

    /// The gripper command of the last period.
    pub fn gripper(&self) -> GripperCommand {
        self.command.as_ref().map_or(START_GRIPPER, |command| command.gripper)
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
        Ok(match command {
            ArmCommand::JointPositions(positions) => {
                let positions = JointVector::from(*positions);
                let target = match joints_before {
                    // A held target rests: the motion before is not fed forward.
                    Some(_) if self.holding => JointMotion::at_rest(positions),
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
                let target = match pose_before {
                    Some((_, true)) if self.holding => PoseMotion::at_rest(*x_wt),
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
                let motion = self.follower.pose(&target, state, arm);
                let [velocity, acceleration] = fed_forward(&motion);
                impedance(state, &pose_impedance(&motion.x_wt, self.posture), &velocity, &acceleration)
            }
            ArmCommand::CartesianImpedance(command) => {
                let target = match pose_before {
                    Some((before, _)) if !self.holding => before.next(command.x_wt),
                    _ => PoseMotion::at_rest(command.x_wt),
                };
                self.pose = Some((target, false));
                self.follower = Follower::Free;
                let [velocity, acceleration] = fed_forward(&target);
                impedance(state, command, &velocity, &acceleration)
            }
        })
    }
}
