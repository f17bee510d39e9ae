//! Runs the episodes of a batch on a cluster.

use std::ffi::OsString;
use std::path::Path;
use std::time::Duration;

use miette::{Report, miette};
use ramp_log::ENDING;

use super::batch::Batch;
use super::display::Display;
use super::episode::{Episode, Outcome};
use crate::ending::requested;
use crate::engine::{Answer, Engine, Job, Luggage};
use crate::status::MachineFault;

/// The worker's file for the result. The other files of an episode lie beside it, with other endings.
const RESULT: &str = "out/result.json";

/// Runs the open episodes; `running` is the folder for unfinished files. Returns false if it was stopped.
///
/// # Errors
/// If the engine or a node fails, or a result cannot be kept.
pub fn work(
    batch: &Batch,
    mut engine: Engine,
    episodes: &mut [Episode],
    open: &[usize],
    running: &Path,
) -> Result<bool, Report> {
    let mut luggage = Luggage::default();
    let limit = batch.limit.as_secs_f64();
    let mut jobs = Vec::new();
    for &index in open {
        let mut files = Vec::new();
        let words = batch.words(&episodes[index], RESULT.as_ref(), &mut |path| {
            let place = luggage.pack(path);
            files.push(place.clone());
            place.into()
        });
        let words = words.into_iter().map(text).collect::<Result<_, Report>>()?;
        jobs.push(Job { words, files, limit });
    }
    let display = Display::new(open.len(), episodes.len() - open.len(), engine.processors);
    display.at_work_elsewhere();
    let worked = engine.run(&luggage, &jobs, &|| requested().is_some(), &mut |job, answer| {
        let episode = &mut episodes[open[job]];
        let (outcome, took) = match answer {
            Answer::Lost(why) => (Outcome::Lost(why), Duration::ZERO),
            Answer::Ended(ended) => {
                let write = |ending: &str, bytes: &[u8]| {
                    std::fs::write(running.join(format!("{}.{ending}", episode.stem)), bytes)
                };
                write("log", &ended.told).map_err(MachineFault::of)?;
                for ending in ["json", "svg", ENDING] {
                    if let Some(bytes) = ended.files.get(&format!("result.{ending}")) {
                        write(ending, bytes).map_err(MachineFault::of)?;
                    }
                }
                (batch.keep(running, episode, ended.status)?, ended.took)
            }
        };
        episode.outcome = outcome;
        display.ended(episode, took);
        display.at_work_elsewhere();
        Ok(())
    });
    display.finish();
    worked
}

/// An argument as text.
fn text(word: OsString) -> Result<String, Report> {
    word.into_string().map_err(|word| miette!("the argument {} is no UTF-8", word.display()))
}
