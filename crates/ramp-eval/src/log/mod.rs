//! Logs: one MCAP file an episode, from which it can be looked at, judged again, and run again bit by bit.
//!
//! A log holds what the episode was made from ([`Header`]), every call of the agent to its last bit ([`calls`]) with
//! hashes of the physics state on the way, signals for viewers, and the result. [`mod@write`] makes it while the episode
//! runs, [`read`] takes it apart, and [`mod@crate::replay`] runs it again. The truth is in it: an agent never gets the file.

pub mod calls;
pub mod read;
pub mod write;

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::result::Software;

pub use crate::result::RULES;
pub use read::Log;
pub use write::Recorder;

/// The version of the form of logs.
pub const SCHEMA: &str = "ramp-log-1";
/// How the channel of the calls is encoded.
pub const CALLS: &str = "ramp-calls-1";
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
    /// [`crate::result::RULES`] at that time.
    pub rules: String,
    /// The goal.
    pub goal: GoalText,
    /// The kit.
    pub kit: KitText,
    /// The arm.
    pub arm: ArmText,
    /// What the agent might see.
    pub track: String,
    /// All randomness of the world came from here.
    pub seed: u64,
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

/// The start's disturbance in a log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DisturbanceText {
    /// m.
    pub position: f64,
    /// rad.
    pub angle: f64,
}

/// Why a log could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The system says no.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It cannot be written.
    #[error("{path} cannot be written: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// What the library said.
        source: mcap::McapError,
    },
    /// It is no MCAP file, or one that was cut or damaged.
    #[error("{path} is no whole MCAP file: {what}")]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// It is an MCAP file, but none of an episode.
    #[error("{path} is no log of an episode: {what}")]
    Other {
        /// The file.
        path: PathBuf,
        /// What was found, and what was expected.
        what: String,
    },
}

/// SHA-256 of some bytes, in hex.
///
/// ```
/// let hash = ramp_eval::log::sha256(b"abc");
/// assert_eq!(hash, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
/// ```
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
