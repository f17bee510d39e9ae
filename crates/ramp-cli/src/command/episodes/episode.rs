//! One of many episodes.

use ramp_result::EpisodeResult;
use ramp_twin::Fault;

/// One episode that is asked for.
pub struct Episode {
    pub goal: usize,
    /// Its world among those of the batch.
    pub world: usize,
    pub seed: u64,
    pub repeat: u32,
    /// What goes wrong on purpose.
    pub fault: Option<Fault>,
    /// Name of its files, without an ending.
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
    /// Crashed, killed or out of time, and why.
    Lost(String),
}
