//! `ramp teleop`: a person drives the arm. The Python package does it; this checks the arguments.

use std::ffi::OsString;
use std::path::PathBuf;

use miette::{Report, miette};
use ramp_data::Data;
use ramp_gym::own::kind;
use serde_json::json;

use crate::command::demos::Format;
use crate::command::python;
use crate::options::{StartOption, TrackName, WorldOption};

#[derive(clap::Args)]
pub struct Arguments {
    /// Goal to build by hand, or action to carry out by hand while the baseline does all others, such as
    /// `fasten`
    #[arg(value_name = "ACTION|GOAL")]
    what: String,
    /// Goal whose actions of this kind are yours [default: the first of the nine that has one]
    #[arg(long, value_name = "GOAL")]
    goal: Option<String>,
    /// Knowledge of the parts' poses; images exist on `tags` only
    #[arg(long, value_enum, default_value_t = TrackName::Tags)]
    track: TrackName,
    #[command(flatten)]
    world: WorldOption,
    #[command(flatten)]
    start: StartOption,
    /// Seed of all random numbers of the episode
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Take timed keys and axes from this file, without a window
    #[arg(long, value_name = "FILE")]
    input: Option<PathBuf>,
    /// Format of the demonstration
    #[arg(long, value_enum, default_value_t = Format::Lerobot)]
    format: Format,
    /// New folder for result, log, input and demonstration
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let skill = check(data, arguments)?;
    let text = |word: OsString| word.to_string_lossy().into_owned();
    let asked = json!({
        "what": arguments.what,
        "skill": skill,
        "goal": arguments.goal,
        "track": ramp_robot::Track::from(arguments.track).name(),
        "world": text(arguments.world.argument()),
        "start": text(arguments.start.argument()),
        "seed": arguments.seed,
        "input": arguments.input,
        "format": arguments.format.name(),
        "output": arguments.output,
    });
    python::run(data, &python::TELEOP, &[asked.to_string().into()])
}

/// Checks what the options name; whether a skill is teleoperated.
fn check(data: &Data, arguments: &Arguments) -> Result<bool, Report> {
    let skill = kind(&arguments.what).is_some();
    match (&arguments.goal, skill) {
        (Some(goal), true) => drop(data.goal(goal)?),
        (Some(_), false) => {
            return Err(miette!("`--goal` belongs to an action, such as `fasten`"));
        }
        (None, true) => {}
        (None, false) => drop(data.goal(&arguments.what)?),
    }
    arguments.world.read(data)?;
    arguments.start.read(data)?;
    if let Some(file) = arguments.input.as_ref().filter(|file| !file.is_file()) {
        return Err(miette!("cannot read {}: there is no such file", file.display()));
    }
    let folder = &arguments.output;
    let occupied = match std::fs::read_dir(folder) {
        Ok(mut entries) => entries.next().is_some(),
        Err(_) => folder.exists(),
    };
    if occupied {
        return Err(miette!(help = "name a new folder with -o", "{} is not empty", folder.display()));
    }
    Ok(skill)
}
