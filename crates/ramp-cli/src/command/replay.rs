//! `ramp replay`: repeats an episode from its log, and compares it bit by bit.

use std::fmt::Write;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};
use miette::{IntoDiagnostic, Report, miette};
use ramp_data::Data;
use ramp_episode::Progress;
use ramp_episode::replay::{LoggedSetup, Replayed, replay_watched};
use ramp_log::Log;
use ramp_robot::{Event, EventKind};
use ramp_twin::Twin;
use serde_json::json;

use crate::command::python;
use crate::output::print;
use crate::pictures::{self, Pictures};
use crate::software::software;
use crate::status::{DONE, INCOMPLETE};

#[derive(clap::Args)]
pub struct Arguments {
    /// Log of an episode, as `ramp run` and `ramp bench` write it
    #[arg(required_unless_present = "dataset")]
    log: Option<PathBuf>,
    /// Play the episodes of a data set that `ramp demos` has made instead
    #[arg(long, value_name = "DIR", conflicts_with_all = ["log", "video", "video_from", "rerun"])]
    dataset: Option<PathBuf>,
    /// Print the comparison as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    pictures: pictures::Arguments,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    match (&arguments.dataset, &arguments.log) {
        (Some(folder), _) => {
            let asked = json!({ "dataset": folder, "json": arguments.json });
            python::run(data, &python::DEMOS, &["replay".into(), asked.to_string().into()])
        }
        (None, Some(log)) => replay(arguments, log),
        (None, None) => Err(miette!("a log, or `--dataset`, is needed")),
    }
}

/// Repeats the episode of a log.
fn replay(arguments: &Arguments, log: &Path) -> Result<u8, Report> {
    let log = Log::read(log).into_diagnostic()?;
    let world = LoggedSetup::of(&log).into_diagnostic()?;
    let mut pictures = Pictures::new(&arguments.pictures, &world.setup())?;
    let bar = std::io::stderr().is_terminal().then(|| {
        let bar = ProgressBar::new(log.result.time.robot.clamp(0.0, 1e6) as u64);
        if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len} s") {
            bar.set_style(style);
        }
        bar
    });
    let mut actions = Actions::of(&log.result.events);
    let mut watcher = |progress: &Progress, twin: &Twin| {
        if let Some(bar) = &bar {
            bar.set_position(progress.time as u64);
        }
        pictures.show(twin, &actions.at(progress.time), progress);
    };
    let replayed = replay_watched(&log, &world, &mut watcher).into_diagnostic()?;
    if let Some(bar) = &bar {
        bar.finish_and_clear();
    }
    pictures.end()?;
    print(&if arguments.json { as_json(&log, &replayed)? } else { as_text(&log, &replayed) })?;
    Ok(if replayed.is_equal() && replayed.breach.is_none() { DONE } else { INCOMPLETE })
}

/// The agent's action at a time, from its events.
struct Actions<'e> {
    rest: std::iter::Peekable<std::slice::Iter<'e, Event>>,
    now: String,
}

impl<'e> Actions<'e> {
    fn of(events: &'e [Event]) -> Actions<'e> {
        Actions { rest: events.iter().peekable(), now: "planning".to_string() }
    }

    fn at(&mut self, time: f64) -> String {
        while let Some(event) = self.rest.next_if(|event| event.time <= time) {
            if let EventKind::ActionBegun(action) = &event.kind {
                self.now = action.to_string();
            }
        }
        self.now.clone()
    }
}

fn as_text(log: &Log, replayed: &Replayed) -> String {
    let result = &replayed.result;
    let mut text = format!(
        "{}, track {}, seed {}, agent {} {}: {} of {} {} in {} s of robot time\n",
        result.goal,
        result.track,
        result.seed,
        result.agent.name,
        result.agent.version,
        result.counted(),
        result.wanted(),
        result.unit(),
        result.time.robot
    );
    if replayed.is_equal() {
        text.push_str("the replay is equal to the log, to the last bit\n");
    } else {
        text.push_str("the replay differs from the log:\n");
        for difference in &replayed.differences {
            let _ = writeln!(
                text,
                "  {:9.3} s  {}: {} in the log, {} in the replay",
                difference.time, difference.what, difference.logged, difference.replayed
            );
        }
        let (theirs, ours) = (&log.header.software, software());
        if *theirs != ours {
            let _ = writeln!(
                text,
                "the log was made by ramp {} ({}), and this is {} ({}): that may be why",
                theirs.version, theirs.commit, ours.version, ours.commit
            );
        }
    }
    if let Some(breach) = &replayed.breach {
        let _ = writeln!(text, "the episode counts on no board: {breach}");
    }
    let _ = writeln!(text, "log: sha256 {}", log.sha256);
    text
}

fn as_json(log: &Log, replayed: &Replayed) -> Result<String, Report> {
    let differences: Vec<_> = replayed
        .differences
        .iter()
        .map(|it| json!({"t": it.time, "what": it.what, "logged": it.logged, "replayed": it.replayed}))
        .collect();
    let value = json!({
        "sha256": log.sha256,
        "equal": replayed.is_equal(),
        "differences": differences,
        "breach": replayed.breach.as_ref().map(ToString::to_string),
        "made_by": log.header.software,
        "result": replayed.result,
    });
    let mut text = serde_json::to_string_pretty(&value).into_diagnostic()?;
    text.push('\n');
    Ok(text)
}
