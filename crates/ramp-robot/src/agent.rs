//! The other side of the seam: an agent, and its report of its work.

use crate::error::RobotError;
use crate::event::Event;
use crate::robot::Robot;

/// Name of the baseline in results. A baseline with replaced parts has them after it, each after a `+`.
pub const BASELINE: &str = "baseline";
/// Name in results of the agent that plays the commands of a log without sight.
pub const BLIND_TAPE: &str = "blind-tape";

/// Whether a name belongs to the benchmark's own agents. No other agent may bear it.
///
/// ```
/// assert!(ramp_robot::is_reserved("baseline") && ramp_robot::is_reserved("baseline+mine"));
/// assert!(!ramp_robot::is_reserved("baseline-of-mine"));
/// ```
pub fn is_reserved(name: &str) -> bool {
    [BASELINE, BLIND_TAPE].contains(&name.split('+').next().unwrap_or_default())
}

/// An agent's report of its own work.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Account {
    /// Time spent on task planning, s of its own clock.
    pub planning: f64,
    /// Number of coarse actions in the first plan.
    pub coarse: usize,
    /// Number of fine actions in the first plan.
    pub fine: usize,
    /// How often it planned again.
    pub replans: usize,
    /// Time that it waited while the robot went on, s: it is part of the robot's time, and not counted twice.
    pub overlapped: f64,
    /// Its events, in order of time.
    pub events: Vec<Event>,
}

/// An agent: gets a robot and works until it is done or the robot stops it.
pub trait Agent {
    /// Its name and version in results.
    fn name(&self) -> (&str, &str);

    /// Its report, for the result; read after [`Agent::run`].
    fn account(&self) -> Account;

    /// SHA-256, in hex, of the file that the agent, or its parameters, were read from; `None` where both are
    /// part of the program.
    fn file_hash(&self) -> Option<&str> {
        None
    }

    /// Whether the robot goes on while the agent computes, as far as the robot's time follows the clock: what
    /// happens is then no function of the seed.
    fn is_asynchronous(&self) -> bool {
        false
    }

    /// Why the agent itself could not go on, where it was not the robot that stopped it; read after
    /// [`Agent::run`].
    fn failure(&self) -> Option<String> {
        None
    }

    /// Whether the failure is that the episode's time on the wall was over; read after [`Agent::run`].
    fn is_late(&self) -> bool {
        false
    }

    /// Works on the goal it was made for. Returning ends the episode.
    ///
    /// # Errors
    /// The robot's error, if that ended the work.
    fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError>;

    /// Ends what is left of the agent, such as a process of its own. The time that this takes is not the
    /// agent's.
    fn finish(&mut self) {}

    /// Processor time of all its processes, s, where it has processes of its own; read after
    /// [`Agent::finish`].
    fn processor_time(&self) -> Option<f64> {
        None
    }
}
