//! Options shared by several commands.

use std::ffi::{OsStr, OsString};
use std::path::Path;

use miette::Report;
use ramp_assembly::Task;
use ramp_data::{ARMS, Data};
use ramp_robot::Track;
use ramp_world::{Start, World};

/// Whether an argument is a file, with this ending or in a folder, and not a name.
pub fn is_file(argument: &OsStr, ending: &str) -> bool {
    argument.to_string_lossy().ends_with(ending) || Path::new(argument).components().count() > 1
}

/// The world, as on the command line.
#[derive(clap::Args)]
pub struct WorldOption {
    /// World that the physics are drawn from: ideal, real, hard, or a world file
    #[arg(long, value_name = "NAME|FILE", default_value = "real")]
    world: String,
}

impl WorldOption {
    /// The world.
    pub fn read(&self, data: &Data) -> Result<World, Report> {
        Ok(data.world(&self.world)?)
    }

    /// The world's argument on the command line.
    pub fn argument(&self) -> OsString {
        OsString::from(&self.world)
    }
}

/// The arm, as on the command line.
#[derive(clap::Args)]
pub struct ArmOption {
    /// Arm of the twin: a Franka Emika Panda or a Franka Research 3
    #[arg(long, value_name = "NAME", value_parser = ARMS, default_value = ARMS[0])]
    arm: String,
}

impl ArmOption {
    /// The data with this arm.
    pub fn of(&self, data: &Data) -> Result<Data, Report> {
        Ok(data.with_arm(&self.arm)?)
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.arm
    }
}

/// The start, as on the command line.
#[derive(clap::Args)]
pub struct StartOption {
    /// Start that the places of the parts are drawn from: moved, sheet, scattered, jumbled, or a start file
    #[arg(long, value_name = "NAME|FILE", default_value = "moved")]
    start: String,
}

impl StartOption {
    /// The start.
    pub fn read(&self, data: &Data) -> Result<Start, Report> {
        Ok(data.start(&self.start)?)
    }

    /// The start's argument on the command line.
    pub fn argument(&self) -> OsString {
        OsString::from(&self.start)
    }
}

/// A task, as on the command line.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum TaskName {
    /// Build it from the parts on the sheet
    Build,
    /// Take the built frame apart, and put each part back in its place on the sheet
    TakeApart,
}

impl From<TaskName> for Task {
    fn from(name: TaskName) -> Task {
        match name {
            TaskName::Build => Task::Build,
            TaskName::TakeApart => Task::TakeApart,
        }
    }
}

/// Information that the agent receives.
#[derive(Clone, Copy, clap::ValueEnum)]
pub enum TrackName {
    /// Exact poses from the simulator
    State,
    /// Poses with noise: 1 mm and 1° a reading, one in twenty missing
    Noisy,
    /// Images of two cameras, with the parts' tags in them
    Tags,
    /// Images of two cameras, without any tag
    Colour,
    /// The same, with the measured distance in each pixel
    Depth,
}

impl From<TrackName> for Track {
    fn from(name: TrackName) -> Track {
        match name {
            TrackName::State => Track::State,
            TrackName::Noisy => Track::Noisy,
            TrackName::Tags => Track::Tags,
            TrackName::Colour => Track::Colour,
            TrackName::Depth => Track::Depth,
        }
    }
}
