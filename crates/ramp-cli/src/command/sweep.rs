//! `ramp sweep`: success and time against a quantity of the world.

use std::path::{Path, PathBuf};

use miette::{Diagnostic, IntoDiagnostic, Report};
use ramp_data::Data;
use ramp_kit::source::{A_NAME, is_name, shorten};
use ramp_report::sweep::{Curve, Point, Sweep};
use ramp_result::episode::WorldLabel;
use ramp_world::World;

use super::episodes::{self, Batch, BatchWorld, Episode, Outcome};
use crate::output::{print, write_file};
use crate::status::{DONE, INCOMPLETE};

/// Largest number of values in a list.
const MOST: usize = 1000;

#[derive(clap::Args)]
pub struct Arguments {
    /// Goals, classes (easy, medium, hard) or `all`
    #[arg(required = true, value_name = "CLASS|GOAL")]
    goals: Vec<String>,
    /// Quantity of the world that is varied, such as friction.coulomb=0..1.5
    #[arg(long, value_name = "QUANTITY=FROM..TO")]
    vary: String,
    /// Number of values, evenly spaced
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(2..=1000))]
    steps: u32,
    /// Draw one curve for each of these values of another quantity, such as controller.compensation=0,1
    #[arg(long, value_name = "QUANTITY=VALUE,…")]
    curves: Option<String>,
    #[command(flatten)]
    shared: episodes::Arguments,
    /// Episodes of each goal at each value, with seeds in a row
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    repeats: u32,
    /// Folder for results, worlds, table and figure; results that it already has are not run again
    #[arg(short, long, value_name = "DIR", default_value = "results/sweep")]
    output: PathBuf,
}

/// Errors in the varied quantity or its values.
#[derive(Debug, thiserror::Error, Diagnostic)]
enum SweepError {
    #[error("found --{option} `{found}`, expected {expected}")]
    Form { option: &'static str, found: String, expected: &'static str },
    #[error("--{option}: {why}")]
    #[diagnostic(help("`ramp world show` lists what a world holds"))]
    Quantity { option: &'static str, why: String },
    #[error("the world would be called `{name}`, expected {A_NAME}")]
    #[diagnostic(help("give the world file a shorter name"))]
    Name { name: String },
}

impl Arguments {
    /// Returns true if an external agent program runs.
    pub fn has_agent(&self) -> bool {
        self.shared.has_agent()
    }
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let goals = episodes::find(data, &arguments.goals)?;
    let base = arguments.shared.world.read(data)?;
    let (quantity, values) = values(&arguments.vary, arguments.steps as usize)?;
    let curves = curves(&base, arguments.curves.as_deref())?;
    let mut worlds = Vec::new();
    for (_, world) in &curves {
        for value in &values {
            worlds.push(varied(world, "vary", quantity, *value)?);
        }
    }
    let folder = &arguments.output;
    let mut batch = arguments.shared.batch(data, folder, goals, arguments.repeats, "--repeats", None)?;
    batch.worlds = Vec::new();
    for world in &worlds {
        let file = folder.join(format!("{}.toml", world.name));
        batch.worlds.push(BatchWorld::new(file.clone().into_os_string(), world));
    }
    for (file, world) in batch.worlds.iter().zip(&worlds) {
        write_file(Path::new(&file.argument), &world.text)?;
    }
    let mut episodes = plan(&batch, &worlds);
    if let Some(status) = batch.run(&mut episodes)? {
        return Ok(status);
    }
    let sweep = sum_up(&batch, &episodes, &base, (quantity, &values), &curves);
    let files = [("csv", sweep.csv()), ("svg", sweep.figure()), ("html", sweep.page())];
    for (ending, text) in &files {
        write_file(&folder.join(format!("sweep.{ending}")), text)?;
    }
    if arguments.shared.json {
        print(&(serde_json::to_string_pretty(&sweep).into_diagnostic()? + "\n"))?;
    } else {
        let place = folder.join("sweep.html");
        print(&format!("{}table and figure: {}\n", sweep.text(), place.display()))?;
    }
    let lost = episodes.iter().any(|episode| matches!(episode.outcome, Outcome::Lost(_)));
    Ok(if lost { INCOMPLETE } else { DONE })
}

/// The world with one quantity set to a value.
fn varied(world: &World, option: &'static str, quantity: &str, value: f64) -> Result<World, SweepError> {
    let world = world.with(quantity, value).map_err(|why| SweepError::Quantity { option, why })?;
    if !is_name(&world.name) {
        return Err(SweepError::Name { name: shorten(&world.name) });
    }
    Ok(world)
}

/// Formats a number in few characters.
fn rounded(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

/// The varied quantity and its values.
fn values(word: &str, steps: usize) -> Result<(&str, Vec<f64>), SweepError> {
    let wrong = || SweepError::Form {
        option: "vary",
        found: shorten(word),
        expected: "QUANTITY=FROM..TO, such as friction.coulomb=0..1.5",
    };
    let (quantity, range) = word.split_once('=').ok_or_else(wrong)?;
    let (from, to) = range.split_once("..").ok_or_else(wrong)?;
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|it| it.is_finite());
    let (from, to) = number(from).zip(number(to)).filter(|(from, to)| from < to).ok_or_else(wrong)?;
    let last = (steps - 1) as f64;
    let values = (0..steps).map(|step| rounded(from + (to - from) * step as f64 / last));
    Ok((quantity, values.collect()))
}

/// The label of each curve, and the world in which the quantity is varied.
fn curves(base: &World, word: Option<&str>) -> Result<Vec<(String, World)>, SweepError> {
    let Some(word) = word else { return Ok(vec![(String::new(), base.clone())]) };
    let wrong = || SweepError::Form {
        option: "curves",
        found: shorten(word),
        expected: "QUANTITY=VALUE,…, such as controller.compensation=0,1",
    };
    let (quantity, values) = word.split_once('=').ok_or_else(wrong)?;
    let values: Option<Vec<f64>> =
        values.split(',').map(|it| it.trim().parse::<f64>().ok().filter(|it| it.is_finite())).collect();
    let values = values.filter(|values| values.len() <= MOST).ok_or_else(wrong)?;
    values
        .into_iter()
        .map(|value| Ok((format!("{quantity} {value}"), varied(base, "curves", quantity, value)?)))
        .collect()
}

/// All episodes. Each seed runs in every world before the next seed, so that an interrupted sweep has samples
/// of each world.
fn plan(batch: &Batch, worlds: &[World]) -> Vec<Episode> {
    let mut episodes = Vec::new();
    for (repeat, seed) in batch.repeats() {
        for (goal, it) in batch.goals.iter().enumerate() {
            for (world, its) in worlds.iter().enumerate() {
                let stem = format!("{}-{}-{}-{seed}", it.name, its.name, batch.track);
                episodes.push(Episode {
                    goal,
                    world,
                    seed,
                    repeat,
                    fault: None,
                    stem,
                    outcome: Outcome::Open,
                });
            }
        }
    }
    episodes
}

fn sum_up(
    batch: &Batch,
    episodes: &[Episode],
    base: &World,
    (quantity, values): (&str, &[f64]),
    curves: &[(String, World)],
) -> Sweep {
    let at = |world: usize, value: f64| {
        let those: Vec<_> = episodes
            .iter()
            .filter(|episode| episode.world == world)
            .map(|episode| (batch.goals[episode.goal].count, episode.result()))
            .collect();
        Point::of(value, &those)
    };
    let field = base.quantities().find(|(group, field, _)| format!("{group}.{}", field.name) == quantity);
    Sweep {
        quantity: quantity.to_string(),
        unit: field.map_or(String::new(), |(_, field, _)| field.unit.to_string()),
        meaning: field.map_or(String::new(), |(_, field, _)| field.meaning.trim().to_string()),
        world: WorldLabel::of(base).title,
        track: batch.track.to_string(),
        goals: batch.goals.iter().map(|goal| goal.name.clone()).collect(),
        seeds: [*batch.seeds.start(), *batch.seeds.end()],
        software: format!("ramp {} ({})", batch.software.version, batch.software.commit),
        curves: curves
            .iter()
            .enumerate()
            .map(|(index, (label, _))| Curve {
                label: label.clone(),
                points: values
                    .iter()
                    .enumerate()
                    .map(|(step, value)| at(index * values.len() + step, *value))
                    .collect(),
            })
            .collect(),
    }
}
