//! Options that several commands share.

use std::ffi::OsString;

use miette::Report;
use ramp_robot::Track;
use ramp_world::World;

use crate::data::Data;

/// The world, as on the command line.
#[derive(clap::Args)]
pub struct WorldOption {
    /// What the physics are drawn from: ideal, real, hard, or a world file
    #[arg(long = "world", value_name = "NAME|FILE", default_value = DEFAULT_WORLD)]
    name: String,
}

/// The world when none is named.
pub const DEFAULT_WORLD: &str = "ideal";

impl WorldOption {
    /// The world.
    pub fn read(&self, data: &Data) -> Result<World, Report> {
        data.world(&self.name)
    }

    /// As on the command line.
    pub fn argument(&self) -> OsString {
        OsString::from(&self.name)
    }
}

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
