//! `ramp twin export`: the scene as MJCF, for the twin's MuJoCo and for older ones. [`serve`] has the other
//! subcommand.

use std::path::PathBuf;

use miette::{IntoDiagnostic, Report};
use ramp_assembly::Task;
use ramp_data::Data;
use ramp_robot::Track;
use ramp_twin::{ForMujoco, Setup, Twin};

use crate::command::serve;
use crate::options::{StartOption, WorldOption};
use crate::output::{check_place, print, tell, write_file};
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
        /// Version of MuJoCo that reads it
        #[arg(long = "for", value_name = "VERSION", value_enum, default_value_t = Version::Newest)]
        version: Version,
        /// File to write; without it the scene goes to standard output
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,
    },
    /// Serve the twin by Franka's protocol, as a real arm with its gripper (needs the feature `franka`)
    Serve(Box<serve::Arguments>),
}

/// Versions of MuJoCo.
#[derive(Clone, Copy, clap::ValueEnum)]
enum Version {
    /// 3.13 or newer: the twin's own scene
    #[value(name = "3.13")]
    Newest,
    /// 3.3 or newer: another integrator, and no part sleeps
    #[value(name = "3.3")]
    V3_3,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let (goal, seed, world, start, version, output) = match &arguments.command {
        Command::Serve(arguments) => return serve::run(data, arguments),
        Command::Export { goal, seed, world, start, version, output } => {
            (goal, seed, world, start, version, output)
        }
    };
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
        state: None,
        task: Task::Build,
        fault: None,
    };
    let twin = Twin::new(&setup).into_diagnostic()?;
    let version = match version {
        Version::Newest => ForMujoco::Newest,
        Version::V3_3 => {
            tell(
                "for MuJoCo 3.3: the integrator is implicitfast and no part sleeps, so motions differ from the \
                 twin's",
            );
            ForMujoco::V3_3
        }
    };
    let scene = twin.export(version, &[]);
    match output {
        Some(path) => write_file(path, scene)?,
        None => print(&scene)?,
    }
    Ok(DONE)
}
