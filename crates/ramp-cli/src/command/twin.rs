//! `ramp twin export`: the scene as MJCF that stock MuJoCo loads.

use std::path::PathBuf;

use miette::{IntoDiagnostic, Report};
use ramp_data::Data;
use ramp_robot::Track;
use ramp_twin::{Setup, Twin};

use crate::options::{StartOption, WorldOption};
use crate::output::{check_place, print, write_file};
use crate::status::DONE;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Write the scene of a goal as MJCF
    Export {
        /// Name of a goal, or a goal file
        goal: String,
        /// Seed of the start poses
        #[arg(long, default_value_t = 1)]
        seed: u64,
        #[command(flatten)]
        world: WorldOption,
        #[command(flatten)]
        start: StartOption,
        /// File to write; without it the scene goes to standard output
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,
    },
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let Command::Export { goal, seed, world, start, output } = &arguments.command;
    let assembly = data.goal(goal)?;
    let arm = data.arm()?;
    let (world, start) = (world.read(data)?, start.read(data)?);
    if let Some(path) = output {
        check_place(path)?;
    }
    let setup = Setup {
        assembly: &assembly,
        arm: &arm,
        track: Track::State,
        seed: *seed,
        start: &start,
        world: &world,
        fault: None,
    };
    let twin = Twin::new(&setup).into_diagnostic()?;
    match output {
        Some(path) => write_file(path, twin.scene())?,
        None => print(twin.scene())?,
    }
    Ok(DONE)
}
