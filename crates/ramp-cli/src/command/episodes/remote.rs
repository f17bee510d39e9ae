//! Runs the episodes of a batch on a cluster.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitStatus;
use std::time::Duration;

use miette::{Report, miette};
use ramp_log::ENDING;

use super::display::Display;
use super::episode::{Episode, Outcome};
use crate::ending::requested;
use crate::engine::{Answer, Attachments, Ended, Engine, Job};
use crate::status::MachineFault;

/// The worker's file for the result. The other files of an episode lie beside it, with other endings.
pub const RESULT: &str = "out/result.json";

/// Gives the worker's path of a file.
type Place<'p> = dyn FnMut(&Path) -> PathBuf + 'p;

/// Gives the arguments of an episode.
type Words<'w> = dyn Fn(&Episode, &mut Place<'_>) -> Vec<OsString> + 'w;

/// Keeps the files of an ended episode, which lie in the folder for unfinished files.
type Keep<'k> = dyn Fn(&Episode, Option<ExitStatus>) -> Result<Outcome, Report> + 'k;

/// The common parts of the episodes of a batch.
pub struct Remote<'a> {
    /// Folder for unfinished files.
    pub running: &'a Path,
    /// Time that an episode has on its worker.
    pub limit: Duration,
    /// The arguments of an episode with [`RESULT`] for its result.
    pub words: &'a Words<'a>,
    /// Keeps the files of an ended episode.
    pub keep: &'a Keep<'a>,
}

impl Remote<'_> {
    /// Runs the open episodes. Returns false if it was stopped.
    ///
    /// # Errors
    /// If the engine or a node fails, or a result cannot be kept.
    pub fn work(&self, mut engine: Engine, episodes: &mut [Episode], open: &[usize]) -> Result<bool, Report> {
        let mut attachments = Attachments::default();
        let mut jobs = Vec::new();
        for &index in open {
            let mut files = Vec::new();
            let words = (self.words)(&episodes[index], &mut |path: &Path| {
                let place = attachments.pack(path);
                files.push(place.clone());
                place.into()
            });
            let words = words.into_iter().map(text).collect::<Result<_, Report>>()?;
            jobs.push(Job { words, files, limit: self.limit.as_secs_f64() });
        }
        let display = Display::new(open.len(), episodes.len() - open.len(), engine.processors);
        display.at_work_elsewhere();
        let worked = engine.run(&attachments, &jobs, &|| requested().is_some(), &mut |job, answer| {
            let episode = &mut episodes[open[job]];
            let (outcome, took) = match answer {
                Answer::Lost(why) => (Outcome::Lost(why), Duration::ZERO),
                Answer::Ended(ended) => {
                    self.write(episode, &ended).map_err(MachineFault::of)?;
                    ((self.keep)(episode, ended.status)?, ended.took)
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

    /// Writes what a worker has sent to the folder for unfinished files.
    fn write(&self, episode: &Episode, ended: &Ended) -> std::io::Result<()> {
        let path = |ending: &str| self.running.join(format!("{}.{ending}", episode.stem));
        std::fs::write(path("log"), &ended.told)?;
        for ending in ["json", "svg", ENDING] {
            if let Some(bytes) = ended.files.get(&format!("result.{ending}")) {
                std::fs::write(path(ending), bytes)?;
            }
        }
        Ok(())
    }
}

/// An argument as text.
fn text(word: OsString) -> Result<String, Report> {
    word.into_string().map_err(|word| miette!("the argument {} is no UTF-8", word.display()))
}
