//! Verdicts on logs, stored between builds of a leaderboard.

use std::collections::BTreeMap;
use std::io::Read;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, Report as Failure};
use ramp_result::episode::Software;
use ramp_result::write_whole;
use serde::{Deserialize, Serialize};

use super::judge::{LogFile, Verdict, replay};
use crate::output::print;
use crate::pool;
use crate::software::software;

/// File of verdicts in the site's folder.
const FILE: &str = "replayed.json";
/// Version of its format.
const SCHEMA: &str = "ramp-replayed-1";
/// Largest size of that file, bytes.
const LARGEST: u64 = 256 << 20;
/// Content of the file of verdicts.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Remembered {
    schema: String,
    /// The program that replayed the logs.
    software: Software,
    /// Verdict of each log, by its SHA-256.
    logs: BTreeMap<String, Verdict>,
}

/// All verdicts.
pub struct Verdicts {
    path: PathBuf,
    remembered: Remembered,
    /// Number of replayed logs, and of logs with a known verdict.
    counts: [usize; 2],
}

impl Verdicts {
    /// Loads the verdicts in the site's folder that this version of the program found.
    ///
    /// # Errors
    /// If standard output cannot be written to.
    pub fn open(folder: &Path) -> Result<Verdicts, Failure> {
        let path = folder.join(FILE);
        let empty = Remembered { schema: SCHEMA.to_string(), software: software(), logs: BTreeMap::new() };
        let remembered = match read(&path) {
            Ok(None) => empty,
            Ok(Some(found)) if found.software == empty.software => found,
            Ok(Some(found)) => {
                let Software { version, commit } = found.software;
                print(&format!(
                    "{} is of ramp {version} ({commit}): every log is run again\n",
                    path.display()
                ))?;
                empty
            }
            Err(why) => {
                print(&format!("{} is damaged ({why}): every log is run again\n", path.display()))?;
                empty
            }
        };
        Ok(Verdicts { path, remembered, counts: [0, 0] })
    }

    /// Number of replayed logs, and of logs with a verdict from before.
    pub fn counts(&self) -> [usize; 2] {
        self.counts
    }

    /// Replays the logs without a known verdict, several in parallel, and stores the verdicts. Returns the
    /// reason for the first log that is not equal.
    ///
    /// # Errors
    /// If the verdicts cannot be stored.
    pub fn replay(&mut self, logs: &[LogFile]) -> Result<Result<(), String>, Failure> {
        let known = |log: &&LogFile| self.remembered.logs.contains_key(&log.sha256);
        let (old, mut new): (Vec<&LogFile>, Vec<&LogFile>) = logs.iter().partition(known);
        // One rejected log is enough.
        if self.refused(logs).is_some() {
            new.clear();
        }
        let found = replay_all(&new);
        self.counts[0] += found.iter().flatten().count();
        self.counts[1] += old.len();
        let mut failure = None;
        for (log, found) in new.iter().zip(found) {
            match found {
                Some(Ok(verdict)) => {
                    self.remembered.logs.insert(log.sha256.clone(), verdict);
                }
                // This depends on more than the log, so do not store it; the next build tries again.
                Some(Err(why)) => failure = failure.or(Some(format!("{}: {why}", log.path.display()))),
                None => {}
            }
        }
        if !new.is_empty() {
            let mut text = serde_json::to_string_pretty(&self.remembered).into_diagnostic()?;
            text.push('\n');
            write_whole(&self.path, text)?;
        }
        Ok(self.refused(logs).or(failure).map_or(Ok(()), Err))
    }

    /// The first log that is known to be rejected, with the reason.
    fn refused(&self, logs: &[LogFile]) -> Option<String> {
        logs.iter().find_map(|log| match self.remembered.logs.get(&log.sha256) {
            Some(Verdict::Refused(why)) => Some(format!("{}: {why}", log.path.display())),
            _ => None,
        })
    }
}

/// The content of the file, if it exists.
fn read(path: &Path) -> Result<Option<Remembered>, String> {
    let file = match std::fs::File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error.to_string()),
    };
    let mut bytes = Vec::new();
    file.take(LARGEST).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    let found: Remembered = serde_json::from_slice(&bytes).map_err(|error| error.to_string())?;
    if found.schema != SCHEMA {
        return Err(format!("its schema is not {SCHEMA}"));
    }
    Ok(Some(found))
}

/// Replays logs in parallel on all cores. After the first log that is not equal, no further log starts; the
/// outcome of a log that did not start is `None`.
fn replay_all(logs: &[&LogFile]) -> Vec<Option<Result<Verdict, String>>> {
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    pool::work(logs.len(), cores, |index| match replay(logs[index]) {
        Ok(Verdict::Equal) => ControlFlow::Continue(Ok(Verdict::Equal)),
        other => ControlFlow::Break(other),
    })
}
