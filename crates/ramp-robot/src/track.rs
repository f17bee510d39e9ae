//! Tracks: how an agent observes the parts.

/// How an agent observes the parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Track {
    /// Exact poses from the simulator.
    State,
    /// Poses from the simulator with noise on each reading; some readings are missing.
    Noisy,
    /// Camera images alone, with the parts' tags in them.
    Tags,
}

impl Track {
    /// All of them.
    pub const ALL: [Track; 3] = [Track::State, Track::Noisy, Track::Tags];

    /// The name on the command line and in results.
    pub fn name(self) -> &'static str {
        match self {
            Track::State => "state",
            Track::Noisy => "noisy",
            Track::Tags => "tags",
        }
    }
}
