//! The rule by which a result file counts as an episode that is wanted, so that it is not run again.
//!
//! A folder of results belongs to one agent, one version of the program, one secret, one arm, one start,
//! and the worlds of one command. A result of anything else is [`Foreign`]: it must not be added up with the
//! others, and is not overwritten. `ramp bench`, `ramp faults`, `ramp sweep` and `ramp.bench` in Python use
//! this rule.

use serde_json::Value;

use crate::episode::{EpisodeResult, SCHEMA, Software};

/// A result that does not belong into a folder.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Foreign {
    /// Another version of the program or of the schema.
    #[error("made by {theirs}, and this is {ours}")]
    Version {
        /// The result's.
        theirs: String,
        /// This program's.
        ours: String,
    },
    /// Another arm.
    #[error("of the arm {theirs}")]
    Arm {
        /// The name of the result's arm.
        theirs: String,
    },
    /// Another world.
    #[error("of the world {theirs}")]
    World {
        /// The name of the result's world.
        theirs: String,
    },
    /// Another start.
    #[error("of the start {theirs}")]
    Start {
        /// The name of the result's start.
        theirs: String,
    },
    /// Another state at the start, or none.
    #[error("of an episode that began in another state, or in none")]
    State,
    /// Another secret, or none.
    #[error("of another secret, or of none")]
    Secret,
    /// Another agent, or other parameters of the skills.
    #[error("of the agent {theirs}")]
    Agent {
        /// Name and version of the result's agent.
        theirs: String,
    },
}

/// The agent of a folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity<'a> {
    /// Name and version, if they are known before the agent was started.
    pub name: Option<(&'a str, &'a str)>,
    /// SHA-256 of its file, or of the file of the skills' parameters, in hex.
    pub sha256: Option<&'a str>,
    /// Whether the robot goes on while it computes.
    pub asynchronous: bool,
}

/// Conditions that all results of a folder share.
#[derive(Clone, Debug)]
pub struct Shared<'a> {
    /// The name of the arm.
    pub arm: &'a str,
    /// SHA-256 of the files of the worlds, in hex.
    pub worlds: Vec<&'a str>,
    /// SHA-256 of the start's file, in hex.
    pub start: &'a str,
    /// SHA-256 of the files of the states in which the frames begin, in hex; `None`: nothing is built.
    pub states: Vec<Option<&'a str>>,
    /// The commitment of the secret.
    pub secret: Option<String>,
    /// This program.
    pub software: &'a Software,
    /// The agent.
    pub agent: Identity<'a>,
}

/// One wanted episode.
#[derive(Clone, Debug)]
pub struct Wanted<'a> {
    /// The goal's name.
    pub goal: &'a str,
    /// The task, as in results.
    pub task: Option<&'a str>,
    /// SHA-256 of the file of the state in which the frame begins, in hex.
    pub state: Option<&'a str>,
    /// Number of pegs of the goal, or of parts that are to be put back.
    pub count: usize,
    /// The track.
    pub track: &'a str,
    /// SHA-256 of the world's file, in hex.
    pub world: &'a str,
    /// The seed.
    pub seed: u64,
    /// The kind of the injected fault.
    pub fault: Option<&'a str>,
}

impl Shared<'_> {
    /// Checks that a file of the folder belongs to it. Files that are no episode's result do.
    ///
    /// # Errors
    /// The first condition that the result does not meet.
    pub fn check(&self, text: &str) -> Result<(), Foreign> {
        let Ok(value) = serde_json::from_str::<Value>(text) else { return Ok(()) };
        let Some(schema) = value["schema"].as_str().filter(|it| it.starts_with("ramp-episode-")) else {
            return Ok(());
        };
        let part = |of: &Value, name: &str| of[name].as_str().unwrap_or("unknown").to_string();
        let (theirs, ours) = (&value["software"], self.software);
        if schema != SCHEMA
            || theirs["version"] != ours.version.as_str()
            || theirs["commit"] != ours.commit.as_str()
        {
            return Err(Foreign::Version {
                theirs: format!("ramp {} ({}, {schema})", part(theirs, "version"), part(theirs, "commit")),
                ours: format!("ramp {} ({}, {SCHEMA})", ours.version, ours.commit),
            });
        }
        if value["arm"] != self.arm {
            return Err(Foreign::Arm { theirs: value["arm"].as_str().unwrap_or("none").to_string() });
        }
        let world = &value["world"];
        if !world["sha256"].as_str().is_some_and(|hash| self.worlds.contains(&hash)) {
            return Err(Foreign::World { theirs: world["name"].as_str().unwrap_or("none").to_string() });
        }
        let start = &value["start"];
        if start["sha256"].as_str() != Some(self.start) {
            return Err(Foreign::Start { theirs: start["name"].as_str().unwrap_or("none").to_string() });
        }
        if !self.states.contains(&value["state"]["sha256"].as_str()) {
            return Err(Foreign::State);
        }
        if value["secret"].as_str() != self.secret.as_deref() {
            return Err(Foreign::Secret);
        }
        let agent = &value["agent"];
        let other_name = self
            .agent
            .name
            .is_some_and(|(name, version)| agent["name"] != name || agent["version"] != version);
        let asynchronous = agent["async"] == true;
        if other_name
            || agent["sha256"].as_str() != self.agent.sha256
            || asynchronous != self.agent.asynchronous
        {
            let pace = if asynchronous { ", async" } else { "" };
            let theirs = format!("{} {}{pace}", part(agent, "name"), part(agent, "version"));
            return Err(Foreign::Agent { theirs });
        }
        Ok(())
    }

    /// The result in a file's text, if it is the wanted episode; `None` if the text is no result of it.
    ///
    /// # Errors
    /// As [`Shared::check`].
    pub fn find(&self, wanted: &Wanted, text: &str) -> Result<Option<EpisodeResult>, Foreign> {
        self.check(text)?;
        let Ok(result) = serde_json::from_str::<EpisodeResult>(text) else { return Ok(None) };
        let fits = result.schema == SCHEMA
            && result.goal == wanted.goal
            && result.task.as_deref() == wanted.task
            && result.state.as_ref().map(|state| state.sha256.as_str()) == wanted.state
            && result.wanted() == wanted.count
            && result.track == wanted.track
            && result.world.as_ref().is_some_and(|world| world.sha256 == wanted.world)
            && result.seed == wanted.seed
            && result.fault.as_ref().map(|it| it.kind.as_str()) == wanted.fault;
        Ok(fits.then_some(result))
    }
}
