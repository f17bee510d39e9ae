//! Verdicts on logs, stored between builds of a leaderboard.

use std::collections::BTreeMap;
use std::io::{IsTerminal, Read};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use miette::{IntoDiagnostic, Report as Failure};
use ramp_log::Facts;
use ramp_result::episode::Software;
use ramp_result::write_whole;
use serde::{Deserialize, Serialize};

use super::judge::{self, Allowance, LogFile, Verdict};
use crate::engine::{Backend, Engine};
use crate::output::{print, tell};
use crate::pool;
use crate::software::software;
use crate::status::MachineFault;

/// File of verdicts in the site's folder.
const FILE: &str = "replayed.json";
/// Version of its format.
const SCHEMA: &str = "ramp-replayed-2";
/// Largest size of that file, bytes.
const LARGEST: u64 = 256 << 20;

/// The work on logs without a verdict, in words.
const RUNNING_AGAIN: &str = "running again";

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

impl Remembered {
    fn nothing() -> Remembered {
        Remembered { schema: SCHEMA.to_string(), software: software(), logs: BTreeMap::new() }
    }
}

/// All verdicts.
pub struct Verdicts {
    /// The file that holds them, if they are stored.
    path: Option<PathBuf>,
    remembered: Remembered,
    /// Number of replayed logs, and of logs with a known verdict.
    counts: [usize; 2],
    /// The engine that replays logs, once it is at work.
    engine: Option<Engine>,
}

impl Verdicts {
    /// No verdicts yet. None will be stored.
    pub fn unstored() -> Verdicts {
        Verdicts { path: None, remembered: Remembered::nothing(), counts: [0, 0], engine: None }
    }

    /// Loads the verdicts in the site's folder that this version of the program found.
    ///
    /// # Errors
    /// If standard output cannot be written to.
    pub fn open(folder: &Path) -> Result<Verdicts, Failure> {
        let path = folder.join(FILE);
        let empty = Remembered::nothing();
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
        Ok(Verdicts { path: Some(path), remembered, counts: [0, 0], engine: None })
    }

    /// Number of replayed logs, and of logs with a verdict from before.
    pub fn counts(&self) -> [usize; 2] {
        self.counts
    }

    /// The facts of logs, in their order. Logs without a known verdict are read, several in parallel.
    ///
    /// # Errors
    /// The reason for the first log that is not valid.
    pub fn facts(&self, logs: &[LogFile], allowance: &Allowance) -> Result<Vec<Facts>, String> {
        let remembered = &self.remembered.logs;
        let known = |log: &&LogFile| remembered.contains_key(&log.sha256);
        let counts = [logs.len(), logs.iter().filter(known).count()];
        let found = in_parallel("reading", counts, |index| match remembered.get(&logs[index].sha256) {
            Some(verdict) => Ok(verdict.clone()),
            None => judge::read(&logs[index], allowance),
        });
        let mut facts = Vec::new();
        // A log without an outcome comes after one that is not valid.
        for (log, found) in logs.iter().zip(found) {
            match found {
                Some(Ok(Verdict::Valid(found))) => facts.push(*found),
                Some(Ok(Verdict::Refused(why)) | Err(why)) => return Err(reason(log, &why)),
                None => {}
            }
        }
        Ok(facts)
    }

    /// Replays the logs without a known verdict, several in parallel or on a cluster, and stores the
    /// verdicts. Returns the reason for the first log that is not equal.
    ///
    /// # Errors
    /// If the verdicts cannot be stored, or the cluster fails.
    pub fn replay(
        &mut self,
        logs: &[LogFile],
        allowance: &Allowance,
        backend: Option<&Backend>,
    ) -> Result<Result<(), String>, Failure> {
        let known = |log: &&LogFile| self.remembered.logs.contains_key(&log.sha256);
        let (old, mut new): (Vec<&LogFile>, Vec<&LogFile>) = logs.iter().partition(known);
        // One rejected log is enough.
        if self.refused(logs).is_some() {
            new.clear();
        }
        let found = match backend {
            Some(backend) if !new.is_empty() => {
                let engine = match &mut self.engine {
                    Some(engine) => engine,
                    none => none.insert(Engine::start(backend)?),
                };
                on_cluster(engine, &new, allowance)?
            }
            _ => in_parallel(RUNNING_AGAIN, [new.len(), 0], |index| judge::replay(new[index], allowance)),
        };
        self.counts[0] += found.iter().flatten().count();
        self.counts[1] += old.len();
        let mut failure = None;
        for (log, found) in new.iter().zip(found) {
            match found {
                Some(Ok(verdict)) => {
                    self.remembered.logs.insert(log.sha256.clone(), verdict);
                }
                // This depends on more than the log, so do not store it; the next build tries again.
                Some(Err(why)) => failure = failure.or(Some(reason(log, &why))),
                None => {}
            }
        }
        if let Some(path) = self.path.as_ref().filter(|_| !new.is_empty()) {
            let mut text = serde_json::to_string_pretty(&self.remembered).into_diagnostic()?;
            text.push('\n');
            write_whole(path, text).map_err(MachineFault::of)?;
        }
        Ok(self.refused(logs).or(failure).map_or(Ok(()), Err))
    }

    /// The first log that is known to be rejected, with the reason.
    fn refused(&self, logs: &[LogFile]) -> Option<String> {
        logs.iter().find_map(|log| match self.remembered.logs.get(&log.sha256) {
            Some(Verdict::Refused(why)) => Some(reason(log, why)),
            _ => None,
        })
    }
}

/// The reason for refusing an entry because of this log.
fn reason(log: &LogFile, why: &str) -> String {
    format!("{}: {why}", log.path.display())
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

/// Progress on standard error: a bar on a terminal, one line elsewhere; nothing without work.
fn progress(work: &str, count: usize) -> Option<ProgressBar> {
    if count == 0 {
        return None;
    }
    if !std::io::stderr().is_terminal() {
        tell(&format!("{work}: {count} {}", if count == 1 { "log" } else { "logs" }));
        return None;
    }
    let bar = ProgressBar::new(count as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len} logs  {elapsed}, {eta} left  {msg}")
    {
        bar.set_style(style);
    }
    bar.set_message(work.to_string());
    bar.enable_steady_tick(Duration::from_millis(200));
    Some(bar)
}

/// Replays logs on a cluster, and shows the progress of this work.
fn on_cluster(
    engine: &mut Engine,
    logs: &[&LogFile],
    allowance: &Allowance,
) -> Result<Vec<Option<Result<Verdict, String>>>, Failure> {
    let bar = progress(RUNNING_AGAIN, logs.len());
    let outcomes = judge::replay_on(engine, logs, allowance, &|| {
        if let Some(bar) = &bar {
            bar.inc(1);
        }
    });
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    outcomes
}

/// Judges logs in parallel on all cores, and shows the progress of this work. After the first log that is not
/// valid, no further log starts; the outcome of a log that did not start is `None`. Known logs take no time.
fn in_parallel(
    work: &str,
    [count, known]: [usize; 2],
    judge: impl Fn(usize) -> Result<Verdict, String> + Sync,
) -> Vec<Option<Result<Verdict, String>>> {
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let bar = progress(work, count - known);
    let outcomes = pool::work(count, cores, |index| {
        let outcome = judge(index);
        if let Some(bar) = &bar {
            bar.inc(1);
        }
        match outcome {
            Ok(valid @ Verdict::Valid(_)) => ControlFlow::Continue(Ok(valid)),
            other => ControlFlow::Break(other),
        }
    });
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    outcomes
}
