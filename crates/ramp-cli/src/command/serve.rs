//! `ramp twin serve`: the twin behind Franka's protocol, for any client of it.

use std::net::SocketAddr;

use miette::Report;
use ramp_data::Data;

use crate::options::{StartOption, TrackName, WorldOption};

#[derive(clap::Args)]
pub struct Arguments {
    /// Name of a goal, or a goal file
    goal: String,
    /// Readings that the cell gives beside the protocol: poses of parts on `state`, images on `tags`
    #[arg(long, value_enum, default_value_t = TrackName::Tags)]
    track: TrackName,
    #[command(flatten)]
    world: WorldOption,
    #[command(flatten)]
    start: StartOption,
    /// Seed of all random numbers of the twin
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Address of the arm's service; the gripper is at the next port, the cell at the one after it
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:1337")]
    fci: SocketAddr,
    /// Version of the protocol: 10 is an FR3's, 5 a Panda's
    #[arg(long, value_enum, default_value_t = Version::Ten)]
    version: Version,
    /// How time passes
    #[arg(long, value_enum, default_value_t = Pace::RealTime)]
    pace: Pace,
    /// In real time: the world's delay and losses on the line, too, beside those of this machine
    #[arg(long)]
    line: bool,
}

/// Versions of the protocol.
#[derive(Clone, Copy, clap::ValueEnum)]
enum Version {
    /// Of an FR3
    #[value(name = "10")]
    Ten,
    /// Of a Panda
    #[value(name = "5")]
    Five,
}

/// How time passes.
#[derive(Clone, Copy, clap::ValueEnum)]
enum Pace {
    /// A millisecond takes a millisecond
    RealTime,
    /// In a motion the arm waits for each command, and two runs give the same result
    LockStep,
}

/// Without the feature there is nothing to serve or to drive.
#[cfg(not(feature = "franka"))]
pub fn built_without() -> Report {
    miette::miette!(
        help = "build it with `cargo build --release --features franka`",
        "this program was built without Franka's protocol"
    )
}

#[cfg(not(feature = "franka"))]
pub fn run(_: &Data, _: &Arguments) -> Result<u8, Report> {
    Err(built_without())
}

#[cfg(feature = "franka")]
pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    use miette::IntoDiagnostic;
    use ramp_assembly::Task;
    use ramp_served_twin::{FciVersion, Options, Server};
    use ramp_twin::{Setup, Twin};

    use crate::ending;
    use crate::output::{print, tell};
    use crate::status::DONE;

    let (version, arm) = match arguments.version {
        Version::Ten => (FciVersion::V10, "fr3"),
        Version::Five => (FciVersion::V5, "panda"),
    };
    let assembly = data.goal(&arguments.goal)?;
    let arm = data.with_arm(arm)?.arm()?;
    let (mut world, start) = (arguments.world.read(data)?, arguments.start.read(data)?);
    let name = world.name.clone();
    if matches!(arguments.pace, Pace::RealTime) && !arguments.line {
        for quantity in ["line.delay", "line.lost"] {
            world = world.with(quantity, 0.0).map_err(Report::msg)?;
        }
    }
    let setup = Setup {
        assembly: &assembly,
        arm: &arm,
        track: arguments.track.into(),
        seed: arguments.seed,
        start: &start,
        world: &world,
        state: None,
        task: Task::Build,
        fault: None,
    };
    let twin = Twin::new(&setup).into_diagnostic()?;
    let options = Options {
        address: arguments.fci,
        version,
        pace: match arguments.pace {
            Pace::RealTime => ramp_served_twin::Pace::RealTime,
            Pace::LockStep => ramp_served_twin::Pace::LockStep,
        },
        recovery: world.draw(arguments.seed).controller.recovery,
        model_library: match version {
            FciVersion::V5 => model_library(),
            FciVersion::V10 => None,
        },
    };
    let mut server = Server::new(options, twin, &assembly, &arm)
        .map_err(|error| {
            miette::miette!(
                help = "give an address of this machine whose port and the two after it are free, such as \
                        --fci 127.0.0.1:2337",
                "cannot serve at {}: {error}",
                arguments.fci
            )
        })?
        .with_listener(Box::new(tell));
    tell(&format!("{} at {}, world {name}; Ctrl-C ends it", assembly.name, arguments.fci));
    ending::defer_requests();
    server.run(|| ending::requested().is_some());
    let statistics = server.statistics();
    let verdict = server.end();
    print(&format!(
        "{} of {} pegs count; {:.3} s of the twin, largest force {:.0} N, state {:016x}\n{} cycles in motions, {} without a command \
         in time; {} cycles late by the clock, the longest took {:.1} ms\n",
        verdict.seated,
        verdict.pegs,
        verdict.time,
        verdict.largest_force,
        verdict.state,
        statistics.cycles,
        statistics.missed,
        statistics.late,
        statistics.longest.as_secs_f64() * 1e3,
    ))?;
    Ok(DONE)
}

/// The shared library with the arm's model, which lies beside this program. Without it the arm is served all
/// the same: some clients have a model of their own.
#[cfg(feature = "franka")]
fn model_library() -> Option<Vec<u8>> {
    use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};

    let program = std::env::current_exe().ok()?;
    let file = program.with_file_name(format!("{DLL_PREFIX}ramp_franka_model{DLL_SUFFIX}"));
    std::fs::read(&file)
        .inspect_err(|error| {
            crate::output::tell(&format!(
                "clients get no model library: {}: {error}; `cargo build --release` in the checkout makes it",
                file.display()
            ));
        })
        .ok()
}
