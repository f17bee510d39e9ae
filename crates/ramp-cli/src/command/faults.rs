//! `ramp faults`: runs goals with every fault and many seeds. It counts how often the agent detects the
//! fault, and how often it still completes the goal.

use std::fmt::Write;
use std::path::PathBuf;

use miette::{IntoDiagnostic, Report};
use ramp_data::Data;
use ramp_episode::faults::{Share, Tally, judge};
use ramp_result::episode::EpisodeResult;
use ramp_twin::{Fault, FaultKind};
use serde_json::{Value, json};

use super::episodes::{self, Batch, Episode, Outcome};
use crate::columns::{Table, terminal_width};
use crate::output::print;
use crate::status::{DONE, INCOMPLETE};

#[derive(clap::Args)]
pub struct Arguments {
    /// Goals, classes (easy, medium, hard) or `all`
    #[arg(value_name = "CLASS|GOAL", default_values = ["easy-3", "medium-3", "hard-2"])]
    goals: Vec<String>,
    /// Inject these faults only, each at its Nth occasion, or at one drawn from the seed [default: all kinds]
    #[arg(long = "fault", value_name = "KIND[@N]")]
    faults: Vec<Fault>,
    #[command(flatten)]
    shared: episodes::Arguments,
    /// Episodes of each goal under each fault, and without any for comparison, with seeds in a row
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    seeds: u32,
    /// Folder for the results; results that it already has are not run again
    #[arg(short, long, value_name = "DIR", default_value = "results/faults")]
    output: PathBuf,
}

/// Part of a control's file name that stands in place of the fault.
const CONTROL: &str = "no-fault";

/// One line of the table: a fault and a goal, or all goals.
struct Row<'a> {
    fault: Fault,
    goal: Option<&'a str>,
    tally: Tally,
}

impl Arguments {
    /// Returns true if an external agent program runs.
    pub fn has_agent(&self) -> bool {
        self.shared.has_agent()
    }
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let goals = episodes::find(data, &arguments.goals)?;
    let mut faults = Vec::new();
    let every = FaultKind::ALL.map(|kind| Fault { kind, occasion: None });
    for fault in if arguments.faults.is_empty() { &every[..] } else { &arguments.faults } {
        if !faults.contains(fault) {
            faults.push(*fault);
        }
    }
    let shared = &arguments.shared;
    let batch = shared.batch(data, &arguments.output, goals, arguments.seeds, "--seeds", None)?;
    let mut episodes = plan(&batch, &faults);
    if let Some(status) = batch.run(&mut episodes)? {
        return Ok(status);
    }
    let rows = rows(&batch, &faults, &episodes);
    print(&if shared.json { as_json(&batch, &rows, &episodes)? } else { as_text(&batch, &rows, &episodes) })?;
    let lost = episodes.iter().any(|episode| matches!(episode.outcome, Outcome::Lost(_)));
    Ok(if lost { INCOMPLETE } else { DONE })
}

/// All requested episodes and their controls. Each seed runs with every fault and goal before the next seed,
/// so that an interrupted suite has samples of each.
fn plan(batch: &Batch, faults: &[Fault]) -> Vec<Episode> {
    let mut episodes = Vec::new();
    for (repeat, seed) in batch.repeats() {
        for (goal, it) in batch.goals.iter().enumerate() {
            for fault in [None].into_iter().chain(faults.iter().copied().map(Some)) {
                let name = fault.map_or_else(|| CONTROL.to_string(), |fault| fault.to_string());
                let stem = format!("{}-{}-{name}-{seed}", it.name, batch.track);
                episodes.push(Episode { goal, world: 0, seed, repeat, fault, stem, outcome: Outcome::Open });
            }
        }
    }
    episodes
}

/// The result of the same goal and seed without a fault.
fn control<'e>(episodes: &'e [Episode], episode: &Episode) -> Option<&'e EpisodeResult> {
    let same = |it: &&Episode| it.fault.is_none() && (it.goal, it.seed) == (episode.goal, episode.seed);
    episodes.iter().find(same).and_then(Episode::result)
}

fn rows<'a>(batch: &'a Batch, faults: &[Fault], episodes: &[Episode]) -> Vec<Row<'a>> {
    let mut rows = Vec::new();
    for fault in faults {
        let of = |wanted: Option<usize>| {
            let those = episodes.iter().filter(|it| it.fault == Some(*fault));
            let those = those.filter(|it| wanted.is_none_or(|goal| it.goal == goal));
            Tally::of(those.map(|it| [it.result(), control(episodes, it)]))
        };
        for (index, goal) in batch.goals.iter().enumerate() {
            rows.push(Row { fault: *fault, goal: Some(&goal.name), tally: of(Some(index)) });
        }
        if batch.goals.len() > 1 {
            rows.push(Row { fault: *fault, goal: None, tally: of(None) });
        }
    }
    rows
}

/// Each episode that was lost, not run, or not diagnosed and completed, with the reason.
fn shortfalls(episodes: &[Episode]) -> impl Iterator<Item = (&Episode, String)> {
    episodes.iter().filter_map(|episode| {
        let why = match &episode.outcome {
            Outcome::Lost(reason) => format!("lost: {reason}"),
            Outcome::Open => "not run".to_string(),
            Outcome::Finished(result) => {
                let judgement = judge(result, control(episodes, episode))?;
                let short = result.pegs.len() - result.counted();
                let pegs = if short > 0 { format!("{short} pegs short, ") } else { String::new() };
                match judgement.told {
                    _ if judgement.harmless() || (judgement.diagnosed && short == 0) => return None,
                    None => format!("{pegs}nothing diagnosed"),
                    Some(cause) => format!("{pegs}diagnosed {}", cause.name()),
                }
            }
        };
        Some((episode, why))
    })
}

fn as_text(batch: &Batch, rows: &[Row], episodes: &[Episode]) -> String {
    let (first, last) = (batch.seeds.start(), batch.seeds.end());
    let world = &batch.worlds[0].title;
    let mut text = format!("world {world}, track {}, seeds {first} to {last}\n", batch.track);
    let mut table = Table::new(2, ["fault", "goal", "struck", "harmless", "diagnosed", "recovered"]);
    for Row { fault, goal, tally } in rows {
        table.add([
            fault.to_string(),
            goal.unwrap_or("all goals").to_string(),
            format!("{}/{}", tally.struck, tally.episodes),
            tally.harmless.to_string(),
            share(&tally.diagnosed),
            share(&tally.recovered),
        ]);
    }
    text.push_str(&table.text(terminal_width()));
    let mut heading = "not diagnosed, or not complete:\n";
    for (episode, why) in shortfalls(episodes) {
        text.push_str(heading);
        heading = "";
        let goal = &batch.goals[episode.goal].name;
        let fault = episode.fault.map(|fault| fault.to_string()).unwrap_or_default();
        let _ = writeln!(text, "  {fault} on {goal}, seed {}: {why}", episode.seed);
    }
    let _ = writeln!(text, "results: {}", batch.folder.display());
    text
}

/// Success rate in per cent, with its interval.
fn share(share: &Share) -> String {
    if share.count == 0 {
        return "-".to_string();
    }
    let percent = |share: f64| format!("{:.0}", 100.0 * share);
    let Share { hits, count, interval } = share;
    format!(
        "{hits}/{count}  {} % ({} to {})",
        percent(*hits as f64 / *count as f64),
        percent(interval.low),
        percent(interval.high)
    )
}

fn as_json(batch: &Batch, rows: &[Row], episodes: &[Episode]) -> Result<String, Report> {
    let rows: Vec<Value> = rows
        .iter()
        .map(|row| json!({"fault": row.fault.to_string(), "goal": row.goal, "tally": row.tally}))
        .collect();
    let shortfalls: Vec<Value> = shortfalls(episodes)
        .map(|(episode, why)| {
            json!({
                "fault": episode.fault.map(|fault| fault.to_string()),
                "goal": batch.goals[episode.goal].name,
                "seed": episode.seed,
                "why": why,
            })
        })
        .collect();
    let mut text = serde_json::to_string_pretty(&json!({
        "world": batch.worlds[0].title,
        "track": batch.track,
        "first_seed": batch.seeds.start(),
        "seeds": batch.count,
        "software": batch.software,
        "rows": rows,
        "shortfalls": shortfalls,
    }))
    .into_diagnostic()?;
    text.push('\n');
    Ok(text)
}
