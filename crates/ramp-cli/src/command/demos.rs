//! `ramp demos`: demonstrations as a data set for learning. The Python package makes it; this checks the
//! arguments.

use std::ffi::OsString;
use std::path::PathBuf;

use miette::{IntoDiagnostic, Report, miette};
use ramp_data::Data;
use ramp_external_agent::AgentFile;
use ramp_gym::SKILLS;
use ramp_gym::pictures::SIZES;
use serde_json::json;

use crate::command::python;
use crate::engine::Backend;
use crate::options::{StartOption, TrackName, WorldOption};

/// The skill for all types of joints, beside those of [`SKILLS`].
const ALL_JOINTS: &str = "fasten";

#[derive(clap::Args)]
pub struct Arguments {
    /// Skill or goal to demonstrate
    #[arg(value_name = "SKILL|GOAL", required_unless_present = "log", conflicts_with = "log")]
    what: Option<String>,
    /// Take the episodes from these logs, or from all logs of a folder
    #[arg(long, value_name = "FILE|DIR", num_args = 1..)]
    log: Vec<PathBuf>,
    /// Number of episodes
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..=1_000_000), conflicts_with = "log")]
    episodes: u32,
    /// Seed of the first episode; the others have the next seeds
    #[arg(long, value_name = "SEED", default_value_t = 1, conflicts_with = "log")]
    first_seed: u64,
    /// Knowledge of the parts' poses [default: noisy for a skill, tags for a goal]
    #[arg(long, value_enum, conflicts_with = "log")]
    track: Option<TrackName>,
    #[command(flatten)]
    world: WorldOption,
    #[command(flatten)]
    start: StartOption,
    /// Draw the steps of a skill from these goals [default: the nine goals]
    #[arg(long, value_name = "GOAL", num_args = 1..)]
    goal: Vec<String>,
    /// Standard deviation of an error of the goal pose of a skill along x and y, m
    #[arg(long, value_name = "METRES", default_value_t = 0.0, value_parser = belief_error)]
    belief_error: f64,
    /// Let this agent build the goal instead of the baseline: an executable, or a Python file
    #[arg(long, value_name = "FILE", conflicts_with = "log")]
    agent: Option<PathBuf>,
    /// Steps per second: a number that divides 1000
    #[arg(long, value_name = "HZ", default_value_t = 20, value_parser = rate)]
    rate: u32,
    /// Pixels along each side of an image, or 0 for none
    #[arg(long, value_name = "PIXELS", default_value_t = 96, value_parser = image_size)]
    image_size: u32,
    /// Record the depth of each image as well
    #[arg(long)]
    depth: bool,
    /// Format of the data set
    #[arg(long, value_enum, default_value_t = Format::Lerobot)]
    format: Format,
    /// Record the episodes on a cluster of Ray, one on each processor. It needs the Python package with the
    /// extra `ray`, on all nodes. Without an address, it is the cluster that runs here, or a new one
    #[arg(long, value_name = "ray[:ADDRESS]")]
    backend: Option<Backend>,
    /// Folder for the data set; a call that was stopped goes on there
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

/// Format of a data set.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
pub enum Format {
    /// LeRobot version 3: parquet files and videos
    Lerobot,
    /// One HDF5 file in the layout of robomimic
    Hdf5,
    /// A zarr folder in the layout of diffusion policies
    Zarr,
}

impl Format {
    /// Its name, as the Python package knows it.
    pub fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }
}

/// Reads the standard deviation of a goal pose, m.
fn belief_error(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(error) if (0.0..=0.05).contains(&error) => Ok(error),
        _ => Err("a number of metres from 0 to 0.05 is expected".to_string()),
    }
}

/// Reads a rate, Hz.
fn rate(text: &str) -> Result<u32, String> {
    match text.parse::<u32>() {
        Ok(rate) if (5..=100).contains(&rate) && 1000 % rate == 0 => Ok(rate),
        _ => Err("a number from 5 to 100 that divides 1000 is expected".to_string()),
    }
}

/// Reads the size of an image, pixels.
fn image_size(text: &str) -> Result<u32, String> {
    let [least, most] = SIZES.map(|size| size as u32);
    match text.parse::<u32>() {
        Ok(size) if size == 0 || (least..=most).contains(&size) => Ok(size),
        _ => Err(format!("0, or a number of pixels from {least} to {most} is expected")),
    }
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let skill = check(data, arguments)?;
    let track = arguments.track.unwrap_or(if skill { TrackName::Noisy } else { TrackName::Tags });
    let text = |word: OsString| word.to_string_lossy().into_owned();
    let asked = json!({
        "what": arguments.what,
        "skill": skill,
        "logs": arguments.log,
        "goals": arguments.goal,
        "world": text(arguments.world.argument()),
        "start": text(arguments.start.argument()),
        "track": ramp_robot::Track::from(track).name(),
        "belief_error": arguments.belief_error,
        "agent": arguments.agent,
        "rate": arguments.rate,
        "image_size": arguments.image_size,
        "depth": arguments.depth,
        "seed": arguments.first_seed,
        "episodes": arguments.episodes,
        "format": arguments.format.name(),
        "output": arguments.output,
        "backend": arguments.backend,
        "program": std::env::current_exe().into_diagnostic()?,
    });
    python::run(data, &python::DEMOS, &["record".into(), asked.to_string().into()])
}

/// Checks what the options name and need; whether a skill is demonstrated.
fn check(data: &Data, arguments: &Arguments) -> Result<bool, Report> {
    let what = arguments.what.as_deref().unwrap_or_default();
    let skill = what == ALL_JOINTS || SKILLS.contains(&what);
    for path in &arguments.log {
        if !path.exists() {
            return Err(miette!("cannot read {}: there is no such file or folder", path.display()));
        }
    }
    if !skill && (!arguments.goal.is_empty() || arguments.belief_error > 0.0) {
        return Err(miette!("`--goal` and `--belief-error` belong to a skill, such as `fasten`"));
    }
    if arguments.depth && arguments.image_size == 0 {
        return Err(miette!("`--depth` belongs to images, and `--image-size 0` asks for none"));
    }
    if skill && arguments.agent.is_some() {
        return Err(miette!("`--agent` builds a goal, and `{what}` is a skill"));
    }
    if !skill && arguments.log.is_empty() {
        data.goal(what)?;
    }
    for goal in &arguments.goal {
        data.goal(goal)?;
    }
    arguments.world.read(data)?;
    arguments.start.read(data)?;
    arguments.agent.as_deref().map(AgentFile::find).transpose().into_diagnostic()?;
    let last = arguments.first_seed.checked_add(u64::from(arguments.episodes));
    last.ok_or_else(|| miette!("`--first-seed` is too large for {} episodes", arguments.episodes))?;
    if arguments.output.exists() && !arguments.output.is_dir() {
        return Err(miette!("cannot write {}: it is no folder", arguments.output.display()));
    }
    arguments.backend.as_ref().map(Backend::check).transpose()?;
    Ok(skill)
}
