//! The start of an episode in its result.

use ramp_world::Start;
use serde::{Deserialize, Serialize};

use crate::sha256;

/// The state of the frame in which an episode began.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StateInfo {
    /// SHA-256 of its file, in hex.
    pub sha256: String,
    /// Its file.
    pub json: String,
}

impl StateInfo {
    /// Of a state file's text.
    pub fn of(text: &str) -> StateInfo {
        StateInfo { sha256: sha256(text.as_bytes()), json: text.to_string() }
    }
}

/// The start of an episode: where its parts lay.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StartInfo {
    /// Its name.
    pub name: String,
    /// SHA-256 of its file, in hex.
    pub sha256: String,
}

impl StartInfo {
    /// Of a start.
    pub fn of(start: &Start) -> StartInfo {
        StartInfo { name: start.name.clone(), sha256: sha256(start.text.as_bytes()) }
    }

    /// A label that no other start has: its name, and for one that is not the program's the begin of its
    /// hash.
    pub fn title(&self) -> String {
        if Start::shipped(&self.name).is_some_and(|start| StartInfo::of(start) == *self) {
            return self.name.clone();
        }
        let hash: String = self.sha256.chars().take(8).collect();
        format!("{} ({hash})", self.name)
    }
}
