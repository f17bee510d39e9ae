//! What an episode was made from, at the head of its log.

use ramp_result::episode::Software;
use serde::{Deserialize, Serialize};

/// The version of the form of logs.
pub const SCHEMA: &str = "ramp-log-2";
/// How the channel of the calls is encoded.
pub const CALLS: &str = "ramp-calls-2";
/// The ending of a log's name.
pub const ENDING: &str = "mcap";

/// The files an episode is made from, as texts.
#[derive(Clone, Copy, Debug)]
pub struct Sources<'a> {
    /// The goal file.
    pub goal: &'a str,
    /// The kit file.
    pub kit: &'a str,
    /// The arm file.
    pub arm: &'a str,
}

/// What an episode was made from; the first message of its log.
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
    /// What the agent might see.
    pub track: String,
    /// All randomness of the world came from here, if there is no secret.
    pub seed: u64,
    /// Where the randomness came from otherwise; `None` without a secret, and then not in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub secret: Option<SecretSeed>,
    /// Which of several runs in a row this is, from 1.
    pub repeat: u32,
    /// How far the start differs from the sheet's outlines.
    pub disturbance: DisturbanceText,
    /// What went wrong on purpose, as on the command line; `None` without a fault, and then not in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fault: Option<String>,
    /// With what the episode was run.
    pub software: Software,
}

/// A seed into which a secret was mixed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SecretSeed {
    /// What the secret is known by ([`ramp_result::secret::Secret::commitment`]).
    pub commitment: String,
    /// The seed that came of it: all randomness of the world.
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

/// The start's disturbance in a log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DisturbanceText {
    /// m.
    pub position: f64,
    /// rad.
    pub angle: f64,
}
