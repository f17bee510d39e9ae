//! One episode of a batch.

use ramp_result::EpisodeResult;
use ramp_twin::Fault;

/// A requested episode.
pub struct Episode {
    pub goal: usize,
    /// Index of its world in the batch.
    pub world: usize,
    pub seed: u64,
    pub repeat: u32,
    /// The injected fault.
    pub fault: Option<Fault>,
    /// Name of its files, without extension.
    pub stem: String,
    pub outcome: Outcome,
}

impl Episode {
    /// Its result, if it has one.
    pub fn result(&self) -> Option<&EpisodeResult> {
        match &self.outcome {
            Outcome::Finished(result) => Some(result),
            Outcome::Open | Outcome::Lost(_) => None,
        }
    }
}

pub enum Outcome {
    /// Not run yet.
    Open,
    Finished(Box<EpisodeResult>),
    /// Crashed, killed or timed out, with the reason.
    Lost(String),
}
