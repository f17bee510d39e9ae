//! Options that several commands share.

use ramp_robot::Track;

/// What the agent may see, as on the command line.
#[derive(Clone, Copy, clap::ValueEnum)]
pub enum TrackName {
    /// Exact poses from the simulator
    State,
    /// Poses with noise: 1 mm and 1° a reading, one in twenty missing
    Noisy,
    /// Images of two cameras, with the parts' tags in them
    Tags,
}

impl From<TrackName> for Track {
    fn from(name: TrackName) -> Track {
        match name {
            TrackName::State => Track::State,
            TrackName::Noisy => Track::Noisy,
            TrackName::Tags => Track::Tags,
        }
    }
}
