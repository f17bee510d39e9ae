//! What a board compares of a log: names and hashes instead of texts. Facts are small, so another process can
//! hand them on.

use ramp_result::episode::Software;
use ramp_result::sha256;
use serde::{Deserialize, Serialize};

use crate::header::SecretSeed;
use crate::read::Log;

/// A file of a log.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Named {
    /// Its name.
    pub name: String,
    /// SHA-256 of its text, in hex.
    pub sha256: String,
}

/// Names and hashes of a log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Facts {
    /// SHA-256 of the log, in hex.
    pub log: String,
    /// The rules of judging.
    pub rules: String,
    /// The goal.
    pub goal: Named,
    /// SHA-256 of the kit file, in hex.
    pub kit: String,
    /// SHA-256 of the arm file, in hex.
    pub arm: String,
    /// The world.
    pub world: Named,
    /// The start.
    pub start: Named,
    /// Name of the track.
    pub track: String,
    /// Seed of all randomness of the world, if there is no secret.
    pub seed: u64,
    /// The seed with the secret mixed in.
    pub secret: Option<SecretSeed>,
    /// Version and commit of the program that ran the episode.
    pub software: Software,
    /// Digest of the result ([`ramp_result::EpisodeResult::digest`]).
    pub result: String,
    /// SHA-256 of the bytes of the calls, in hex.
    pub calls: String,
}

impl Log {
    /// What a board compares of it. The hashes are those of the texts in the log.
    pub fn facts(&self) -> Facts {
        let header = &self.header;
        let hash = |text: &str| sha256(text.as_bytes());
        Facts {
            log: self.sha256.clone(),
            rules: header.rules.clone(),
            goal: Named { name: header.goal.name.clone(), sha256: hash(&header.goal.xml) },
            kit: hash(&header.kit.xml),
            arm: hash(&header.arm.json),
            world: Named { name: header.world.name.clone(), sha256: hash(&header.world.toml) },
            start: Named { name: header.start.name.clone(), sha256: hash(&header.start.toml) },
            track: header.track.clone(),
            seed: header.seed,
            secret: header.secret.clone(),
            software: header.software.clone(),
            result: self.result.digest(),
            calls: self.calls_sha256(),
        }
    }
}
