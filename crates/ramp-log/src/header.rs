//! The inputs of an episode, at the head of its log.

use ramp_result::episode::Software;
use serde::{Deserialize, Serialize};

/// Version of the log format.
pub const SCHEMA: &str = "ramp-log-3";
/// Encoding of the channel of the calls.
pub const CALLS: &str = "ramp-calls-2";
/// File extension of logs.
pub const ENDING: &str = "mcap";

/// The input files of an episode, as text.
#[derive(Clone, Copy, Debug)]
pub struct Sources<'a> {
    /// The goal file.
    pub goal: &'a str,
    /// The kit file.
    pub kit: &'a str,
    /// The arm file.
    pub arm: &'a str,
}

/// The inputs of an episode; the first message of its log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// [`SCHEMA`].
    pub schema: String,
    /// [`ramp_result::episode::RULES`] at that time.
    pub rules: String,
    /// The goal.
    pub goal: GoalText,
    /// The kit.
    pub kit: KitText,
    /// The arm.
    pub arm: ArmText,
    /// The world.
    pub world: WorldText,
    /// The start.
    pub start: StartText,
    /// The state in which the frame began. `None` if nothing was built, and then absent from the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<StateText>,
    /// [`ramp_result::episode::TAKE_APART`]. `None` if the frame was to be built, and then absent from the
    /// file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub task: Option<String>,
    /// Name of the track.
    pub track: String,
    /// Seed of all randomness of the world, if there is no secret.
    pub seed: u64,
    /// The seed with the secret mixed in. `None` without a secret, and then absent from the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub secret: Option<SecretSeed>,
    /// Number of this run in a row of repeats, from 1.
    pub repeat: u32,
    /// The injected fault, as on the command line. `None` without a fault, and then absent from the
    /// file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fault: Option<String>,
    /// Version and commit of the program that ran the episode.
    pub software: Software,
}

/// A seed into which a secret was mixed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SecretSeed {
    /// The commitment of the secret ([`ramp_result::secret::Secret::commitment`]).
    pub commitment: String,
    /// The mixed seed: source of all randomness of the world.
    pub seed: u64,
}

/// A goal in a log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GoalText {
    /// Its name.
    pub name: String,
    /// Its file.
    pub xml: String,
}

/// A kit in a log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KitText {
    /// Of the file, in hex.
    pub sha256: String,
    /// Its file.
    pub xml: String,
}

/// An arm in a log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArmText {
    /// Of the file, in hex.
    pub sha256: String,
    /// Its file.
    pub json: String,
}

/// A world in a log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorldText {
    /// Its name.
    pub name: String,
    /// Of the file, in hex.
    pub sha256: String,
    /// Its file.
    pub toml: String,
}

/// A start in a log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StartText {
    /// Its name.
    pub name: String,
    /// Of the file, in hex.
    pub sha256: String,
    /// Its file.
    pub toml: String,
}

/// The state of a frame in a log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StateText {
    /// Of the file, in hex.
    pub sha256: String,
    /// Its file.
    pub json: String,
}
