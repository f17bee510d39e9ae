//! Replays a log in its own process, so that a crash or hang affects only its own entry.

use std::io::Read;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use miette::{IntoDiagnostic, Report as Failure};
use ramp_log::Log;
use serde::{Deserialize, Serialize};

use crate::output::print;
use crate::status::DONE;

/// Longest reason, characters.
const LONGEST: usize = 1000;
/// Wall-clock limit of a replay.
const LIMIT: Duration = Duration::from_secs(1800);
/// Polling interval for the end of a replay.
const LOOK: Duration = Duration::from_millis(5);

/// Outcome of a replay. It depends only on the log and on this program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The replay is equal in every bit.
    Equal,
    /// The replay differs, or the log cannot be replayed.
    Refused(String),
}

/// A log, and its hash when it was read.
pub struct LogFile {
    /// Path of the log.
    pub path: PathBuf,
    /// SHA-256 of its bytes, in hex.
    pub sha256: String,
}

/// Replays a log in its own process. An error is specific to this attempt and this machine.
pub fn replay(log: &LogFile) -> Result<Verdict, String> {
    let fail = |error: std::io::Error| format!("its replay cannot be started: {error}");
    let mut child = Command::new(std::env::current_exe().map_err(fail)?)
        .arg("judge-log")
        .arg(&log.path)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .map_err(fail)?;
    let begin = Instant::now();
    // The verdict is one line, which fits in a pipe's buffer.
    let status = loop {
        match child.try_wait().map_err(fail)? {
            Some(status) => break status,
            None if begin.elapsed() > LIMIT => {
                let _ = child.kill();
                let _ = child.wait();
                return Err(format!("its replay was not done after {} s", LIMIT.as_secs()));
            }
            None => std::thread::sleep(LOOK),
        }
    };
    let mut text = String::new();
    if let Some(mut output) = child.stdout.take() {
        output.read_to_string(&mut text).map_err(fail)?;
    }
    if !status.success() {
        return Err(format!("its replay ended with {status}"));
    }
    let judged: Judged = serde_json::from_str(&text).map_err(|_| "its replay said nothing".to_string())?;
    if judged.sha256 != log.sha256 {
        return Err("the log was changed while it was read".to_string());
    }
    Ok(judged.verdict)
}

/// The output of the other process.
#[derive(Serialize, Deserialize)]
struct Judged {
    sha256: String,
    verdict: Verdict,
}

/// The log that the other process replays.
#[derive(clap::Args)]
pub struct Arguments {
    log: PathBuf,
}

/// Replays a log in this process, and prints the verdict as JSON.
pub fn judge(arguments: &Arguments) -> Result<u8, Failure> {
    let log = Log::read(&arguments.log).into_diagnostic()?;
    let verdict = match ramp_episode::replay(&log) {
        Ok(replayed) => match (replayed.differences.first(), replayed.breach) {
            (None, None) => Verdict::Equal,
            (None, Some(breach)) => Verdict::Refused(breach.to_string()),
            (Some(first), _) => Verdict::Refused(format!(
                "it does not replay: at {:.3} s, {} is {} in the log and {} in the replay",
                first.time, first.what, first.logged, first.replayed
            )),
        },
        Err(error) => Verdict::Refused(format!("it cannot be run again: {}", in_words(&error))),
    };
    let verdict = match verdict {
        Verdict::Refused(why) => Verdict::Refused(why.chars().take(LONGEST).collect()),
        Verdict::Equal => Verdict::Equal,
    };
    let judged = Judged { sha256: log.sha256, verdict };
    print(&serde_json::to_string(&judged).into_diagnostic()?)?;
    Ok(DONE)
}

/// An error with all its causes.
fn in_words(error: &dyn std::error::Error) -> String {
    let mut words = error.to_string();
    let mut source = error.source();
    while let Some(error) = source {
        words = format!("{words}: {error}");
        source = error.source();
    }
    words
}
