//! Actions: numbers of a policy to commands of the robot, clipped to what is safe.
//!
//! A policy acts 5 to 100 times a second, the robot takes a command every millisecond. In between, the target
//! moves evenly. It never leaves the measured tip (or joint) by more than a leash, so that a policy that
//! pushes against something presses with a bounded force, and no action of a finite number ends the episode
//! by itself.

use nalgebra::{Translation3, UnitQuaternion, Vector3, Vector6};
use ramp_control::Smoother;
use ramp_kit::Pose;
use ramp_robot::arm::ArmModel;
use ramp_robot::{ArmCommand, Command, DOF, GRAVITY, GripperCommand, Impedance, Observation, PERIOD};

use crate::known::Held;

/// The widest the gripper opens, m.
const WIDEST: f64 = 0.08;

/// Meaning of the numbers of an action.
#[derive(Clone, Debug, PartialEq)]
pub enum ActionKind {
    /// Velocity of the target of a Cartesian impedance: along x, y and z of the world, and with `turns` about
    /// them.
    Cartesian(Cartesian),
    /// Velocity of the target of each joint.
    Joint(Joint),
    /// Positions of the seven joints, rad.
    Raw {
        /// Commands pass as they are, and one that the arm cannot follow ends the episode, as in a judged
        /// run. Otherwise the arm goes towards them as fast as its limits allow.
        strict: bool,
    },
}

/// Numbers of the Cartesian action.
#[derive(Clone, Debug, PartialEq)]
pub struct Cartesian {
    /// Whether the hand turns: three more numbers.
    pub turns: bool,
    /// Largest speed of the target along each axis, m/s.
    pub speed: f64,
    /// Largest speed of its turn about each axis, rad/s.
    pub turn_speed: f64,
    /// How far the target may be from the tip along x, y and z, m. Times the stiffness: the largest force of
    /// the spring.
    pub leash: [f64; 3],
    /// The same for its turn, rad.
    pub turn_leash: f64,
    /// Stiffness along and about the axes of the world, N/m and N·m/rad. As the baseline has it in contact.
    pub stiffness: [f64; 6],
    /// The target stays within these bounds: lowest and highest x, y and z, m in the world.
    pub reach: [[f64; 2]; 3],
}

impl Default for Cartesian {
    fn default() -> Self {
        Cartesian {
            turns: true,
            speed: 0.03,
            turn_speed: 0.3,
            leash: [6.0e-3, 6.0e-3, 16.0e-3],
            turn_leash: 0.1,
            stiffness: [1500.0, 1500.0, 1500.0, 60.0, 60.0, 60.0],
            reach: [[0.1, 0.85], [-0.65, 0.65], [0.0, 0.8]],
        }
    }
}

/// Numbers of the joint action.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Largest speed of each joint's target, rad/s.
    pub speed: f64,
    /// How far a target may be from its joint, rad.
    pub leash: f64,
}

impl Default for Joint {
    fn default() -> Self {
        Joint { speed: 0.5, leash: 0.05 }
    }
}

/// How fast the gripper's width changes at most, m/s.
const GRIPPER_SPEED: f64 = 0.1;

impl ActionKind {
    /// Numbers of an action without the gripper's.
    pub fn numbers(&self) -> usize {
        match self {
            ActionKind::Cartesian(it) if it.turns => 6,
            ActionKind::Cartesian(_) => 3,
            ActionKind::Joint(_) | ActionKind::Raw { .. } => DOF,
        }
    }

    /// Lowest and highest of each number, the gripper's included if there is one: its width changes by up to
    /// 0.1 m/s; a raw action gives the width itself, m.
    pub fn bounds(&self, arm: &ArmModel, gripper: bool) -> Vec<[f64; 2]> {
        let raw = matches!(self, ActionKind::Raw { .. });
        let mut bounds = if raw {
            arm.joints.iter().map(|joint| joint.range).collect()
        } else {
            vec![[-1.0, 1.0]; self.numbers()]
        };
        if gripper {
            bounds.push(if raw { [0.0, WIDEST] } else { [-1.0, 1.0] });
        }
        bounds
    }
}

/// Turns the actions of one episode into commands.
pub struct Driver {
    kind: ActionKind,
    /// Smooths joint positions.
    smoother: Option<Smoother>,
    /// The target of the tip, in the world.
    x_target: Pose,
    /// The targets of the joints, rad.
    joints: [f64; DOF],
    posture: [f64; DOF],
    gripper: GripperCommand,
    held: Option<Held>,
}

impl Driver {
    /// At the start of an episode.
    pub fn new(
        kind: &ActionKind,
        arm: &ArmModel,
        seen: &Observation,
        gripper: GripperCommand,
        held: Option<Held>,
    ) -> Driver {
        let smooth = matches!(kind, ActionKind::Joint(_) | ActionKind::Raw { strict: false });
        Driver {
            kind: kind.clone(),
            smoother: smooth.then(|| Smoother::new(arm)),
            x_target: seen.x_wt,
            joints: seen.positions,
            posture: seen.positions,
            gripper,
            held,
        }
    }

    /// After a stop of the arm, the next command begins a new motion from where it stands.
    pub fn begin_anew(&mut self, seen: &Observation) {
        if let Some(smoother) = &mut self.smoother {
            smoother.begin_anew();
        }
        (self.x_target, self.joints, self.posture) = (seen.x_wt, seen.positions, seen.positions);
    }

    /// Tells the gripper, from the next command on.
    pub fn grip(&mut self, gripper: GripperCommand) {
        self.gripper = gripper;
    }

    /// Offset of the target from the tip: along and about the axes of the world, m and rad. Zero without a
    /// command.
    pub fn lead(&self, seen: &Observation) -> Vector6<f64> {
        if !matches!(self.kind, ActionKind::Cartesian(_)) {
            return Vector6::zeros();
        }
        let shift = self.x_target.translation.vector - seen.x_wt.translation.vector;
        let turn = (self.x_target.rotation * seen.x_wt.rotation.inverse()).scaled_axis();
        Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
    }

    /// The command of one period, when the action is `action` (numbers as in [`ActionKind::bounds`]).
    pub fn command(&mut self, action: &[f64], seen: &Observation) -> Command {
        let numbers = self.kind.numbers();
        let part = |index: usize| action.get(index).copied().unwrap_or(0.0);
        let grip = action.get(numbers).copied();
        let arm = match &self.kind {
            ActionKind::Cartesian(it) => {
                let share = |index: usize| part(index).clamp(-1.0, 1.0);
                let tip = seen.x_wt.translation.vector;
                let mut p = self.x_target.translation.vector;
                for axis in 0..3 {
                    let [low, high] = it.reach[axis];
                    let moved = (p[axis] + share(axis) * it.speed * PERIOD).clamp(low, high);
                    p[axis] = moved.clamp(tip[axis] - it.leash[axis], tip[axis] + it.leash[axis]);
                }
                let mut rotation = self.x_target.rotation;
                if it.turns {
                    let turn = Vector3::new(share(3), share(4), share(5)) * (it.turn_speed * PERIOD);
                    rotation = UnitQuaternion::from_scaled_axis(turn) * rotation;
                    let off = (rotation * seen.x_wt.rotation.inverse()).scaled_axis();
                    if off.norm() > it.turn_leash {
                        let kept = off * (it.turn_leash / off.norm());
                        rotation = UnitQuaternion::from_scaled_axis(kept) * seen.x_wt.rotation;
                    }
                }
                self.x_target = Pose::from_parts(Translation3::from(p), rotation);
                ArmCommand::CartesianImpedance(Impedance {
                    x_wt: self.x_target,
                    stiffness: Vector6::from(it.stiffness),
                    damping_ratio: 1.0,
                    feed_forward: self.weight(seen),
                    posture: self.posture,
                })
            }
            ActionKind::Joint(it) => {
                for joint in 0..DOF {
                    let moved = self.joints[joint] + part(joint).clamp(-1.0, 1.0) * it.speed * PERIOD;
                    let here = seen.positions[joint];
                    self.joints[joint] = moved.clamp(here - it.leash, here + it.leash);
                }
                ArmCommand::JointPositions(self.joints)
            }
            ActionKind::Raw { .. } => ArmCommand::JointPositions(std::array::from_fn(part)),
        };
        match (grip, &self.kind) {
            (Some(width), ActionKind::Raw { .. }) => self.gripper.width = width.clamp(0.0, WIDEST),
            (Some(speed), _) => {
                let width = self.gripper.width + speed.clamp(-1.0, 1.0) * GRIPPER_SPEED * PERIOD;
                self.gripper.width = width.clamp(0.0, WIDEST);
            }
            (None, _) => {}
        }
        let command = Command { arm, gripper: self.gripper };
        match &mut self.smoother {
            Some(smoother) => smoother.smooth(&command, seen).0,
            None => command,
        }
    }

    /// The wrench at the tip that carries what was in the hand at the start, until the fingers are told to
    /// open.
    fn weight(&self, seen: &Observation) -> Vector6<f64> {
        let Some(held) = self.held.as_ref().filter(|_| self.gripper.width <= seen.width + 2.0e-3) else {
            return Vector6::zeros();
        };
        let lift = Vector3::new(0.0, 0.0, held.mass * GRAVITY);
        let lever = seen.x_wt.rotation * (held.x_tp * held.p_centre).coords;
        let moment = lever.cross(&lift);
        Vector6::new(0.0, 0.0, lift.z, moment.x, moment.y, moment.z)
    }
}
