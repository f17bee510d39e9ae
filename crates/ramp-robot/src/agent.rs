//! The other side of the seam: an agent, and what it tells about its work.

use crate::error::RobotError;
use crate::robot::Robot;

/// What an agent tells about its own work.
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
    /// What happened, in order of time.
    pub events: Vec<Event>,
}

/// One thing that happened.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Robot time, s.
    pub time: f64,
    /// In one word, one of [`Event::KINDS`].
    pub kind: &'static str,
    /// What it was about, for a person.
    pub what: String,
}

impl Event {
    /// The kinds there are.
    pub const KINDS: [&'static str; 10] =
        ["start", "done", "fault", "retry", "search", "replan", "seen", "diagnosis", "motion", "clipped"];
}

/// An agent: gets a robot and works until it is done or the robot stops it.
pub trait Agent {
    /// Its name and version in results.
    fn name(&self) -> (&str, &str);

    /// The account of the work, for the result; read after [`Agent::run`].
    fn account(&self) -> Account;

    /// SHA-256, in hex, of the file from which the agent or its parameters were read; `None` where
    /// both are part of the program.
    fn file_hash(&self) -> Option<&str> {
        None
    }

    /// Why the agent itself could not continue, if the robot was not the cause; read after
    /// [`Agent::run`].
    fn failure(&self) -> Option<String> {
        None
    }

    /// Works on the goal it was made for. Returning ends the episode.
    ///
    /// # Errors
    /// The robot's error, if that ended the work.
    fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError>;
}
