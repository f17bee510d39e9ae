//! A log run again in a process of its own, so that whatever it does costs its own entry only.

use std::io::Read;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use miette::{IntoDiagnostic, Report as Failure};
use ramp_log::Log;
use serde::{Deserialize, Serialize};

use crate::output::print;
use crate::status::DONE;

/// The longest reason, letters.
const LONGEST: usize = 1000;
/// Time on the wall that a replay may take.
const LIMIT: Duration = Duration::from_secs(1800);
/// How often it is looked whether a replay has ended.
const LOOK: Duration = Duration::from_millis(5);

/// What came out of running a log again: it depends on the log and on this program alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// It is equal to the last bit.
    Equal,
    /// It is not, or cannot be run again.
    Refused(String),
}

/// A log, and its hash when it was read.
pub struct LogFile {
    /// Where it is.
    pub path: PathBuf,
    /// SHA-256 of its bytes, in hex.
    pub sha256: String,
}

/// Runs a log again in a process of its own. An error is of this time and this machine.
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
    // One line, which fits into a pipe.
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

/// What the other process says.
#[derive(Serialize, Deserialize)]
struct Judged {
    sha256: String,
    verdict: Verdict,
}

/// The log that the other process runs again.
#[derive(clap::Args)]
pub struct Arguments {
    log: PathBuf,
}

/// Runs a log again, in this process, and prints the verdict as JSON.
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

/// An error with all that it follows from.
fn in_words(error: &dyn std::error::Error) -> String {
    let mut words = error.to_string();
    let mut source = error.source();
    while let Some(error) = source {
        words = format!("{words}: {error}");
        source = error.source();
    }
    words
}
