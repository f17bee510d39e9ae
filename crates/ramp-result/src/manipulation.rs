//! The track of manipulation alone: the [`Trial`] of a single skill as a result file, and trials of one skill
//! summed up.

pub mod sums;

use ramp_robot::Event;
use serde::{Deserialize, Serialize};

use crate::episode::{AgentInfo, Host, Physics, Software, StartInfo, WorldInfo};
use crate::{older, words};

/// The version of the schema of these files.
pub const SCHEMA: &str = "ramp-manipulation-4";

/// The versions before, which are read, too: without a start, and one with events that are a kind and a text.
const OLDER_SCHEMAS: [&str; 2] = ["ramp-manipulation-2", "ramp-manipulation-3"];

/// The result of one trial of a skill.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trial {
    /// [`SCHEMA`].
    pub schema: String,
    /// The skill's name.
    pub skill: String,
    /// The track: the agent's sensors.
    pub track: String,
    /// The world of the physics.
    pub world: WorldInfo,
    /// Seed of all randomness of the trial.
    pub seed: u64,
    /// The goal.
    pub goal: String,
    /// Its class.
    pub class: Option<String>,
    /// The coarse step of the goal's plan, from 1.
    pub step: usize,
    /// The step, for a person.
    pub action: String,
    /// The start from which the places of the parts were drawn.
    pub start: StartInfo,
    /// The draw.
    pub drawn: Draw,
    /// The agent.
    pub agent: AgentInfo,
    /// The program that made this file.
    pub software: Software,
    /// The machine.
    pub host: Host,
    /// Whether the step is done according to the true poses.
    pub success: bool,
    /// The condition that does not hold, without success.
    pub missing: Option<String>,
    /// The fault with which the agent gave up, or what stopped the robot; `None` where it holds the step to
    /// be done.
    pub cause: Option<String>,
    /// Number of retries.
    pub retries: usize,
    /// Robot time, s.
    pub time: f64,
    /// The events, in order.
    pub events: Vec<Event>,
    /// Figures of the physics.
    pub physics: Physics,
}

/// The draw of a trial's places.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Draw {
    /// Number of draws until the physics model held one.
    pub draws: usize,
    /// Largest horizontal displacement of a placed beam's end from its goal, m.
    pub displaced: f64,
}

impl Trial {
    /// From JSON of [`SCHEMA`] or of one of the two versions before, which it converts.
    ///
    /// # Errors
    /// When it is not JSON, or not a trial. The field `schema` is not checked.
    pub fn from_json(bytes: &[u8]) -> Result<Trial, serde_json::Error> {
        older::read(bytes, OLDER_SCHEMAS, SCHEMA)
    }

    /// Whether trials of this schema can be read.
    pub fn reads(schema: &str) -> bool {
        schema == SCHEMA || OLDER_SCHEMAS.contains(&schema)
    }

    /// As JSON, ending in a line break.
    pub fn to_json(&self) -> String {
        // Plain structs of numbers and strings always serialise.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// The name of its file, without an ending.
    pub fn stem(skill: &str, track: &str, seed: u64) -> String {
        format!("{skill}-{track}-{seed}")
    }

    /// Checks that the trial is consistent.
    ///
    /// # Errors
    /// The contradiction, in words.
    pub fn check(&self) -> Result<(), String> {
        if self.success == self.missing.is_some() {
            return Err("a trial is a success, or lacks something".to_string());
        }
        words::name("the skill", &self.skill)?;
        words::name("the goal", &self.goal)?;
        words::class_and_track(self.class.as_deref(), &self.track)?;
        words::sentence("the action", &self.action)?;
        words::world(&self.world)?;
        words::start(&self.start)?;
        words::agent(&self.agent)?;
        words::software(&self.software)?;
        words::host(&self.host)?;
        for (what, text) in [("what is missing", &self.missing), ("the cause", &self.cause)] {
            text.as_ref().map_or(Ok(()), |text| words::sentence(what, text))?;
        }
        words::events(&self.events, 1e7)?;
        words::hash("the state of the physics", &self.physics.state, 16)?;
        if !(0.0..=1e7).contains(&self.time) {
            return Err(format!("`time` is {} s", self.time));
        }
        if self.drawn.draws == 0 || !(0.0..=1.0).contains(&self.drawn.displaced) {
            return Err("there is no such start".to_string());
        }
        match self.physics.largest_force {
            force if (0.0..=1e9).contains(&force) => Ok(()),
            force => Err(format!("`largest_force` is {force} N")),
        }
    }
}
