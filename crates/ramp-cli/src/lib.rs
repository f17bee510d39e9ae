//! The `ramp` command: goals, checks, pictures, plans and runs.
//!
//! Results go to standard output, everything else to standard error. Exit status: 0 done; 1 the run ended
//! without completing the goal, or a check failed; 2 bad usage or bad input; 3 the machine failed, so that
//! nothing of it counts; 128 and the signal's number if it was stopped by one: 130 INT (Ctrl-C), 143 TERM,
//! 129 HUP.

mod admission;
mod columns;
mod command;
mod completion;
mod ending;
mod engine;
mod film;
mod image_file;
mod lock;
mod options;
mod output;
mod pictures;
mod pool;
mod recording;
mod rules;
mod seal;
mod site;
mod software;
mod status;

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use miette::Report;
use ramp_data::Data;

use crate::seal::Seal;
use crate::status::{BAD_INPUT, MACHINE, MachineFault};

/// Version and commit of this program.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("RAMP_COMMIT"), ")");

#[derive(Parser)]
#[command(
    name = "ramp",
    version = VERSION,
    about = "RAMP: a benchmark of robotic assembly, manipulation and planning."
)]
struct Arguments {
    /// Folder with kit.xml, goals, domains and arms that replaces the built-in data
    #[arg(long, global = true, env = "RAMP_DATA", value_name = "DIR")]
    data: Option<PathBuf>,
    /// Kit file that replaces kit.xml of the data
    #[arg(long, global = true, value_name = "FILE")]
    kit: Option<PathBuf>,
    #[command(subcommand)]
    command: Command,
}

/// Definition of the command line, for completions, the manual pages and the reference.
pub fn arguments() -> clap::Command {
    Arguments::command()
}

// One value is made, once.
#[allow(clippy::large_enum_variant)]
#[derive(Subcommand)]
enum Command {
    /// List the goals, or generate new ones
    Goals(command::goals::Arguments),
    /// Check that a goal can be built: structure, geometry, order of insertions
    Check(command::check::Arguments),
    /// Draw a goal from above
    Show(command::show::Arguments),
    /// Plan a goal: coarse and fine actions
    Plan(command::plan::Arguments),
    /// Build a goal in the digital twin, and score it
    Run(command::run::Arguments),
    /// Run goals or classes several times, as the protocol asks, and summarise the results
    Bench(command::bench::Arguments),
    /// Run single skills from randomised starts, and count successes
    Trials(command::trials::Arguments),
    /// Run goals with each injected fault, and count which were detected and repaired
    Faults(command::faults::Arguments),
    /// Run goals in worlds that differ in one quantity, and plot success and time against it
    Sweep(command::sweep::Arguments),
    /// Record demonstrations as a data set for learning
    Demos(command::demos::Arguments),
    /// Drive the arm by keyboard, gamepad or 6-axis mouse, for a goal or one kind of action
    Teleop(command::teleop::Arguments),
    /// Repeat an episode from its log, or a data set of demonstrations, and compare all bits
    Replay(command::replay::Arguments),
    /// Make a report of results: tables, curves, comparisons
    Report(command::report::Arguments),
    /// Build a leaderboard site from results, each checked by repeating its log
    Leaderboard(command::leaderboard::Arguments),
    /// Check an entry as a leaderboard does, or pack it into one file
    Entry(command::entry::Arguments),
    /// Score a run of a real robot from a stopwatch log or from recorded poses, or write the form for it
    Score(command::score::Arguments),
    /// List the worlds, or print one with the values that an episode draws
    World(command::world::Arguments),
    /// List the starts, or print one
    Start(command::start::Arguments),
    /// Make a secret for the seeds of a bench, or check one
    Seeds(command::seeds::Arguments),
    /// Take camera images of a goal and detect its parts, make data sets, or judge a detector
    See(command::see::Arguments),
    /// Write the files to print, saw and lay out the parts
    Kit(command::kit::Arguments),
    /// Calibrate a real cell's cameras, table and friction from recordings
    Calibrate(command::calibrate::Arguments),
    /// Print the skills of the baseline, and their parameters
    Skills(command::skills::Arguments),
    /// Export the digital twin
    Twin(command::twin::Arguments),
    /// Export the built-in kit, goals, domains and arms, as a start for your own
    Data(command::data::Arguments),
    /// Print completions for a shell
    Completions(command::completions::Arguments),
    /// Write the manual pages
    Man(command::man::Arguments),
    /// Become an agent's program that ends with the run that started it
    #[command(hide = true)]
    AgentProcess(command::agent::ProcessArguments),
    /// Run a log again, and print the verdict for the leaderboard that asked
    #[command(hide = true)]
    JudgeLog(admission::JudgeArguments),
}

impl Command {
    /// Returns true if an external program will run.
    fn starts_an_agent(&self) -> bool {
        match self {
            Command::Run(arguments) => arguments.has_agent(),
            Command::Bench(arguments) => arguments.has_agent(),
            Command::Faults(arguments) => arguments.has_agent(),
            Command::Sweep(arguments) => arguments.has_agent(),
            Command::Trials(arguments) => arguments.has_agent(),
            _ => false,
        }
    }
}

/// Runs the program with the arguments of this process.
pub fn main() -> ExitCode {
    if std::env::args_os().skip(1).eq([ending::ENDED]) {
        return ExitCode::from(BAD_INPUT);
    }
    completion::answer();
    output::set_form_of_errors();
    match seal::arguments() {
        Ok((words, seal)) => work(&words, seal),
        Err(error) => {
            output::tell(&format!("the arguments cannot be read: {error}"));
            ExitCode::from(BAD_INPUT)
        }
    }
}

/// Runs the command that the arguments name. The first word is the program's name.
fn work(words: &[OsString], seal: Seal) -> ExitCode {
    let arguments = Arguments::parse_from(words);
    if let Command::AgentProcess(arguments) = &arguments.command {
        return command::agent::become_agent(arguments);
    }
    if arguments.command.starts_an_agent() && seal == Seal::Open {
        return end(Err(seal::seal(&words[1..])));
    }
    if let Err(error) = ending::end_on_request() {
        return end(Err(error));
    }
    if seal == Seal::Sealed && matches!(arguments.command, Command::Run(_)) {
        return end(seal::guard(&words[1..]));
    }
    // A closed pipe (`ramp goals | head -1`) ends the program without a message, as usual.
    let data = arguments.data.map_or_else(|| Ok(Data::built_in()), |folder| Data::folder(&folder));
    let data = data.map(|data| data.with_kit(arguments.kit)).map_err(Report::from);
    let result = data.and_then(|data| match arguments.command {
        Command::Goals(arguments) => command::goals::run(&data, &arguments),
        Command::Check(arguments) => command::check::run(&data, &arguments),
        Command::Show(arguments) => command::show::run(&data, &arguments),
        Command::Plan(arguments) => command::plan::run(&data, &arguments),
        Command::Run(arguments) => command::run::run(&data, &arguments),
        Command::Bench(arguments) => command::bench::run(&data, &arguments),
        Command::Trials(arguments) => command::trials::run(&data, &arguments),
        Command::Faults(arguments) => command::faults::run(&data, &arguments),
        Command::Sweep(arguments) => command::sweep::run(&data, &arguments),
        Command::Demos(arguments) => command::demos::run(&data, &arguments),
        Command::Teleop(arguments) => command::teleop::run(&data, &arguments),
        Command::Replay(arguments) => command::replay::run(&data, &arguments),
        Command::Report(arguments) => command::report::run(&arguments),
        Command::Leaderboard(arguments) => command::leaderboard::run(&data, &arguments),
        Command::Entry(arguments) => command::entry::run(&data, &arguments),
        Command::Score(arguments) => command::score::run(&data, &arguments),
        Command::World(arguments) => command::world::run(&data, &arguments),
        Command::Start(arguments) => command::start::run(&data, &arguments),
        Command::Seeds(arguments) => command::seeds::run(&arguments),
        Command::See(arguments) => command::see::run(&data, &arguments),
        Command::Kit(arguments) => command::kit::run(&data, &arguments),
        Command::Calibrate(arguments) => command::calibrate::run(&data, &arguments),
        Command::Skills(arguments) => command::skills::run(&data, &arguments),
        Command::Twin(arguments) => command::twin::run(&data, &arguments),
        Command::Data(arguments) => command::data::run(&arguments),
        Command::Completions(arguments) => command::completions::run(&arguments),
        Command::Man(arguments) => command::man::run(&arguments, crate::arguments()),
        Command::JudgeLog(arguments) => admission::judge(&arguments),
        Command::AgentProcess(_) => Ok(BAD_INPUT),
    });
    end(result)
}

/// Prints an error, and returns the exit status.
fn end(result: Result<u8, Report>) -> ExitCode {
    match result {
        Ok(status) => ExitCode::from(status),
        Err(report) => {
            output::tell(&format!("{report:?}"));
            let machine = report.downcast_ref::<MachineFault>().is_some();
            ExitCode::from(if machine { MACHINE } else { BAD_INPUT })
        }
    }
}
