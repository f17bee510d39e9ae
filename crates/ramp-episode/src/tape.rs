//! The blind tape: an agent that plays the commands of a log and looks at nothing. It is the floor of a
//! board: a start from which a tape builds does not need eyes.

use std::path::Path;

use ramp_control::Smoother;
use ramp_log::Log;
use ramp_log::calls::{CallsError, Entry};
use ramp_robot::arm::ArmModel;
use ramp_robot::{
    Account, Agent, ArmCommand, BLIND_TAPE, Command, DOF, GripperCommand, PERIOD, Robot, RobotError,
};
use ramp_twin::{Setup, TwinError};

use crate::episode::{Label, run_episode};
use crate::replay::{LoggedSetup, ReplayError};

/// Name of the agent in results.
pub const NAME: &str = BLIND_TAPE;
/// Its version in results.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Mean speed of the fastest joint where the tape moves the arm to its next command, rad/s. Chosen: a third
/// of the slowest joint's limit.
const SPEED: f64 = 0.6;
/// Shortest time of such a motion, s.
const SHORTEST: f64 = 0.2;
/// The seeds on which the calls of an entry are played. Chosen; no class is run on them.
pub const OTHER_SEEDS: [u64; 2] = [70_001, 70_002];

/// Reasons for which a tape cannot be played.
#[derive(Debug, thiserror::Error)]
pub enum TapeError {
    /// The calls of the log are invalid.
    #[error("the log's calls cannot be read")]
    Calls(#[from] CallsError),
    /// No episode can be made from the log.
    #[error(transparent)]
    Log(#[from] ReplayError),
    /// No twin can be made.
    #[error(transparent)]
    Twin(#[from] TwinError),
}

/// An agent that plays the commands of a log without sight.
#[derive(Clone, Debug)]
pub struct Tape {
    /// Each command, with its number of control periods.
    commands: Vec<(Command, u64)>,
    arm: ArmModel,
}

impl Tape {
    /// The commands of a log. Its readings and images are left out.
    ///
    /// # Errors
    /// If the calls or the arm of the log are invalid.
    pub fn of(log: &Log) -> Result<Tape, TapeError> {
        let mut commands = Vec::new();
        for entry in log.calls() {
            if let Entry::Step(command, periods) = entry? {
                commands.push((*command, periods));
            }
        }
        let arm = ArmModel::from_json(Path::new("arm.json"), &log.header.arm.json);
        Ok(Tape { commands, arm: arm.map_err(ReplayError::Arm)? })
    }

    /// The tape runs on while the arm stands after a stop: commands of that time are left out.
    fn play(&self, robot: &mut dyn Robot) -> Result<(), RobotError> {
        let mut smoother = Smoother::new(&self.arm);
        let mut in_joints = false;
        let mut missed = 0;
        for (command, periods) in &self.commands {
            let left_out = missed.min(*periods);
            missed -= left_out;
            if left_out == *periods {
                continue;
            }
            match play_command(robot, &mut smoother, command, periods - left_out, in_joints) {
                Err(RobotError::Recovered { after, .. }) => {
                    missed += (after / PERIOD).round() as u64;
                    smoother.begin_anew();
                    in_joints = false;
                }
                other => {
                    other?;
                    in_joints = matches!(command.arm, ArmCommand::JointPositions(_));
                }
            }
        }
        Ok(())
    }
}

/// Plays a command for some periods; `in_joints` after joint positions, to which the next ones can follow.
fn play_command(
    robot: &mut dyn Robot,
    smoother: &mut Smoother,
    command: &Command,
    periods: u64,
    in_joints: bool,
) -> Result<(), RobotError> {
    if let (ArmCommand::JointPositions(positions), false) = (&command.arm, in_joints) {
        bridge(robot, smoother, positions, command.gripper)?;
    }
    for _ in 0..periods {
        let smooth = smoother.smooth(command, &robot.observe()).0;
        robot.step(&smooth)?;
    }
    Ok(())
}

/// Moves the arm from where it is to the next command of the tape. Contact has left it a little elsewhere
/// than in the log, and the robot refuses a jump.
fn bridge(
    robot: &mut dyn Robot,
    smoother: &mut Smoother,
    to: &[f64; DOF],
    gripper: GripperCommand,
) -> Result<(), RobotError> {
    let mut seen = robot.observe();
    let from = seen.positions;
    let farthest = from.iter().zip(to).map(|(from, to)| (to - from).abs()).fold(0.0, f64::max);
    let periods = ((farthest / SPEED).max(SHORTEST) / PERIOD).ceil();
    for period in 1..=periods as u64 {
        let s = period as f64 / periods;
        // No speed and no acceleration at both ends.
        let share = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
        let positions = std::array::from_fn(|joint| from[joint] + share * (to[joint] - from[joint]));
        let command = Command { arm: ArmCommand::JointPositions(positions), gripper };
        seen = robot.step(&smoother.smooth(&command, &seen).0)?;
    }
    Ok(())
}

impl Agent for Tape {
    fn name(&self) -> (&str, &str) {
        (NAME, VERSION)
    }

    fn account(&self) -> Account {
        Account::default()
    }

    fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError> {
        self.play(robot)
    }
}

/// Pegs that the calls of a log pin when they are played without sight on the seeds [`OTHER_SEEDS`], and all
/// that they could.
///
/// # Errors
/// When the calls cannot be read, or no episode can be made from the log.
pub fn kept_elsewhere(log: &Log) -> Result<[usize; 2], TapeError> {
    let logged = LoggedSetup::of(log)?;
    let mut tape = Tape::of(log)?;
    let [mut kept, mut pegs] = [0, 0];
    for seed in OTHER_SEEDS {
        let setup = Setup { seed, ..logged.setup() };
        let label = Label::new(log.header.software.clone(), 1);
        let result = run_episode(&setup, &mut tape, &label, &mut |_, _| {})?;
        kept += result.counted();
        pegs += result.pegs.len();
    }
    Ok([kept, pegs])
}
