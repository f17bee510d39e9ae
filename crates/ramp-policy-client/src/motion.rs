//! Carries out actions, one after the other, and notices the end.

use ramp_gym::known::Held;
use ramp_gym::{ActionKind, Cartesian, Driver, Joint};
use ramp_robot::arm::ArmModel;
use ramp_robot::{Command, DOF, GripperCommand, Observation, PERIOD, Robot, RobotError};

use crate::chunk::Action;
use crate::metadata::{ActionSpace, Metadata};
use crate::observation::WIDEST;

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

/// A robot that carries out actions.
pub(crate) struct Player<'r, 's> {
    pub(crate) robot: &'r mut dyn Robot,
    motion: Motion,
    watch: Watch<'s>,
    /// Control periods of an action.
    periods: u32,
}

impl<'r, 's> Player<'r, 's> {
    pub(crate) fn new(
        robot: &'r mut dyn Robot,
        arm: &ArmModel,
        metadata: &Metadata,
        bounds: &'s Bounds<'s>,
    ) -> Player<'r, 's> {
        let seen = robot.observe();
        let motion = Motion::new(metadata.action_space, arm, &seen, bounds);
        let watch = Watch { begin: seen.time, since: None, bounds };
        Player { robot, motion, watch, periods: (1.0 / (metadata.rate * PERIOD)).round() as u32 }
    }

    /// Robot time, s.
    pub(crate) fn time(&self) -> f64 {
        self.robot.observe().time
    }

    /// Carries out an action, unless the end comes before.
    pub(crate) fn play(&mut self, action: &Action) -> Result<Option<Finish>, RobotError> {
        for period in 1..=self.periods {
            let share = f64::from(period) / f64::from(self.periods);
            let command = self.motion.command(action, share, &self.robot.observe());
            let seen = match self.robot.step(&command) {
                // The arm has stopped and is ready again: the next action begins where it stands.
                Err(error) if error.is_recovered() => {
                    self.begin_anew();
                    return Ok(None);
                }
                seen => seen?,
            };
            if let Some(finish) = self.watch.check(&seen) {
                return Ok(Some(finish));
            }
        }
        self.motion.end(action);
        Ok(None)
    }

    /// After a stop of the arm, the next action begins where it stands.
    pub(crate) fn begin_anew(&mut self) {
        let seen = self.robot.observe();
        self.motion.driver.begin_anew(&seen);
        self.motion.last = seen.positions;
    }

    /// The action that holds still after another one.
    pub(crate) fn rest(&self, after: &Action) -> Action {
        let mut rest = after.clone();
        if self.motion.space != ActionSpace::JointPosition {
            rest.arm.fill(0.0);
        }
        rest
    }
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
