//! A policy at work: observation, chunk of actions, motion, and again, until it is done.

use std::time::Instant;

use ramp_external_agent::Patience;
use ramp_gym::known::Held;
use ramp_gym::{ActionKind, Cartesian, Driver, Joint};
use ramp_robot::arm::ArmModel;
use ramp_robot::{Command, DOF, GripperCommand, Observation, PERIOD, Robot, RobotError};

use crate::chunk::{self, Action, Chunk};
use crate::connection::{Connection, Heard};
use crate::error::PolicyError;
use crate::metadata::{ActionSpace, Metadata};
use crate::observation::{Told, WIDEST, observe};
use crate::server::PolicyServer;
use crate::wire;

/// Speed of a joint whose velocity is 1, rad/s: DROID's largest change of a joint, 0.2 rad, at 15 Hz.
const JOINT_SPEED: f64 = 0.2 * 15.0;
/// Speed of the tip at velocity 1, m/s: DROID's largest change of position, 0.075 m, at 15 Hz.
const TIP_SPEED: f64 = 0.075 * 15.0;
/// Speed of its turn at velocity 1, rad/s: DROID's largest change of rotation, 0.15 rad, at 15 Hz.
const TURN_SPEED: f64 = 0.15 * 15.0;
/// Force of each finger that opens, N: as the baseline has it (`grip.opening_force`).
const OPENING_FORCE: f64 = 20.0;

/// The end of a policy that came to one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Finish {
    /// It said that it is done.
    Said,
    /// Its task is done.
    Settled,
    /// Its time is over.
    OutOfTime,
}

/// The reason why it was stopped before.
#[derive(Debug)]
pub(crate) enum Stopped {
    /// The robot stopped it.
    Robot(RobotError),
    /// Its server could not go on.
    Policy(PolicyError),
}

impl From<RobotError> for Stopped {
    fn from(error: RobotError) -> Stopped {
        Stopped::Robot(error)
    }
}

impl From<PolicyError> for Stopped {
    fn from(error: PolicyError) -> Stopped {
        Stopped::Policy(error)
    }
}

/// The part in the hand of a policy, and the conditions of its end.
pub(crate) struct Bounds<'s> {
    /// Tells the gripper to close.
    pub closed: GripperCommand,
    /// The part in the hand.
    pub held: Option<Held>,
    /// Robot time after which it is stopped, s.
    pub limit: f64,
    /// Whether its task is done.
    pub settled: &'s dyn Fn(&Observation) -> bool,
    /// For how long that has to hold, s.
    pub for_seconds: f64,
}

/// A policy at work.
pub(crate) struct Rollout<'a> {
    metadata: &'a Metadata,
    connection: Connection,
    patience: Patience,
    told: Told,
}

impl<'a> Rollout<'a> {
    /// Connects, and tells the server that an episode begins.
    pub(crate) fn begin(
        server: &'a PolicyServer,
        patience: Patience,
        told: Told,
    ) -> Result<Rollout<'a>, PolicyError> {
        let connection = server.connect(deadline(patience))?;
        let mut rollout = Rollout { metadata: server.metadata(), connection, patience, told };
        if rollout.metadata.endpoints {
            let mut reset = vec![("endpoint", "reset".into())];
            if rollout.metadata.session {
                reset.push(("session_id", rollout.told.session.as_str().into()));
            }
            // Whatever it answers: it has heard.
            rollout.ask(&wire::map(reset))?;
        }
        Ok(rollout)
    }

    fn ask(&mut self, value: &rmpv::Value) -> Result<Heard, PolicyError> {
        let end = deadline(self.patience);
        self.connection.send(wire::to_bytes(value), end)?;
        self.connection.hear(end)
    }

    /// The actions for what is seen now.
    fn infer(&mut self, robot: &mut dyn Robot) -> Result<Chunk, Stopped> {
        let seen = observe(robot, self.metadata, &self.told)?;
        match self.ask(&seen)? {
            Heard::Words(words) => Err(PolicyError::Failed(words).into()),
            Heard::Bytes(bytes) => Ok(chunk::read(&bytes, self.metadata).map_err(PolicyError::Wrong)?),
        }
    }

    /// Lets the policy drive the robot.
    pub(crate) fn run(
        &mut self,
        robot: &mut dyn Robot,
        arm: &ArmModel,
        bounds: &Bounds,
    ) -> Result<Finish, Stopped> {
        let periods = (1.0 / (self.metadata.rate * PERIOD)).round() as u32;
        let seen = robot.observe();
        let mut motion = Motion::new(self.metadata.action_space, arm, &seen, bounds);
        let mut watch = Watch { begin: seen.time, since: None, bounds };
        loop {
            let Chunk { actions, done } = self.infer(robot)?;
            for action in &actions {
                for period in 1..=periods {
                    let share = f64::from(period) / f64::from(periods);
                    let command = motion.command(action, share, &robot.observe());
                    if let Some(finish) = watch.check(&robot.step(&command)?) {
                        return Ok(finish);
                    }
                }
                motion.end(action);
            }
            if done {
                return Ok(Finish::Said);
            }
        }
    }
}

impl Drop for Rollout<'_> {
    fn drop(&mut self) {
        self.connection.close();
    }
}

/// When the next answer has to be there.
fn deadline(patience: Patience) -> Instant {
    let answer = Instant::now() + patience.answer;
    patience.end.map_or(answer, |end| end.min(answer))
}

/// Notices the end.
struct Watch<'s> {
    /// Robot time at which the policy began, s.
    begin: f64,
    /// Robot time since which its task is done, s.
    since: Option<f64>,
    bounds: &'s Bounds<'s>,
}

impl Watch<'_> {
    fn check(&mut self, seen: &Observation) -> Option<Finish> {
        if (self.bounds.settled)(seen) {
            let since = *self.since.get_or_insert(seen.time);
            if seen.time - since >= self.bounds.for_seconds {
                return Some(Finish::Settled);
            }
        } else {
            self.since = None;
        }
        (seen.time - self.begin >= self.bounds.limit).then_some(Finish::OutOfTime)
    }
}

/// Turns actions into commands.
struct Motion {
    space: ActionSpace,
    driver: Driver,
    /// Joint positions that the last action ended with, rad.
    last: [f64; DOF],
    closed: GripperCommand,
}

impl Motion {
    fn new(space: ActionSpace, arm: &ArmModel, seen: &Observation, bounds: &Bounds) -> Motion {
        let kind = match space {
            ActionSpace::JointPosition => ActionKind::Raw { strict: false },
            ActionSpace::JointVelocity => ActionKind::Joint(Joint { speed: JOINT_SPEED, ..Joint::default() }),
            ActionSpace::CartesianVelocity => ActionKind::Cartesian(Cartesian {
                speed: TIP_SPEED,
                turn_speed: TURN_SPEED,
                ..Cartesian::default()
            }),
        };
        let driver = Driver::new(&kind, arm, seen, bounds.closed, bounds.held.clone());
        Motion { space, driver, last: seen.positions, closed: bounds.closed }
    }

    /// The command at this share of an action's time, from 0 to 1.
    fn command(&mut self, action: &Action, share: f64, seen: &Observation) -> Command {
        let open = GripperCommand { width: WIDEST, force: OPENING_FORCE };
        self.driver.grip(if action.closed { self.closed } else { open });
        match self.space {
            ActionSpace::JointPosition => {
                let between = |(from, to): (&f64, &f64)| from + share * (to - from);
                let target: Vec<f64> = self.last.iter().zip(&action.arm).map(between).collect();
                self.driver.command(&target, seen)
            }
            ActionSpace::JointVelocity | ActionSpace::CartesianVelocity => {
                self.driver.command(&action.arm, seen)
            }
        }
    }

    /// An action is over.
    fn end(&mut self, action: &Action) {
        if self.space == ActionSpace::JointPosition {
            self.last.copy_from_slice(&action.arm);
        }
    }
}
