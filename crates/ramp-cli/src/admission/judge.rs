//! Reads and replays logs in processes of their own, so that a log that is made to crash, to hang or to use
//! up the machine harms its own entry only.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use miette::{IntoDiagnostic, Report as Failure};
use ramp_episode::tape::kept_elsewhere;
use ramp_kit::source::shorten;
use ramp_log::records::bytes_of;
use ramp_log::{Facts, Limits, Log};
use ramp_result::sha256;
use rustix::process::{Resource, Rlimit, setrlimit};
use serde::{Deserialize, Serialize};

use crate::engine::{Answer, Attachments, Engine, Job, LARGEST_ATTACHMENTS};
use crate::output::print;
use crate::status::DONE;

/// Longest reason, characters.
const LONGEST: usize = 1000;
/// Most bytes of an answer. A pipe's buffer holds more, so that a process never waits for its reader.
const MOST_ANSWER: usize = 48 << 10;
/// Polling interval for the end of a process.
const LOOK: Duration = Duration::from_millis(5);

/// Limits on the process of a log.
#[derive(Clone, Copy, Debug)]
pub struct Allowance {
    /// Longest time on the wall for reading a log: a hundred times that of the longest one.
    pub reading: Duration,
    /// Longest time on the wall for its replay.
    pub replay: Duration,
}

impl Default for Allowance {
    fn default() -> Allowance {
        Allowance { reading: Duration::from_secs(120), replay: Duration::from_secs(1800) }
    }
}

/// The replay of a log, in words.
const REPLAY: &str = "its replay";

/// Address space of a process, bytes. Twice what the largest log needs.
const MEMORY: u64 = 8 << 30;

/// Outcome of reading or replaying a log. It depends only on the log and on this program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The log can be read or, after a replay, is equal in every bit.
    Valid(Box<Facts>),
    /// The log cannot be read, cannot be replayed, or its replay differs.
    Refused(String),
}

/// A log, and its hash when it was first read.
pub struct LogFile {
    /// Path of the log.
    pub path: PathBuf,
    /// SHA-256 of its bytes, in hex.
    pub sha256: String,
}

/// Reads a log in a process of its own. An error is specific to this attempt and this machine.
pub fn read(log: &LogFile, allowance: &Allowance) -> Result<Verdict, String> {
    ask(log, &["--only-read"], "reading it", allowance.reading)
}

/// Replays a log in a process of its own. An error is specific to this attempt and this machine.
pub fn replay(log: &LogFile, allowance: &Allowance) -> Result<Verdict, String> {
    ask(log, &[], REPLAY, allowance.replay)
}

/// Replays logs on a cluster, each in a process of its own, and calls `each` after each. An error of an item
/// is specific to this attempt and that machine. After logs of which one is not valid, no further log starts;
/// the outcome of a log that did not start is `None`.
///
/// # Errors
/// If the engine or a node fails.
pub fn replay_on(
    engine: &mut Engine,
    logs: &[&LogFile],
    allowance: &Allowance,
    each: &dyn Fn(),
) -> Result<Vec<Option<Result<Verdict, String>>>, Failure> {
    let mut outcomes: Vec<Option<Result<Verdict, String>>> = logs.iter().map(|_| None).collect();
    let size = |log: &LogFile| log.path.metadata().map_or(0, |meta| meta.len());
    let mut first = 0;
    while first < logs.len() && outcomes.iter().flatten().all(|it| matches!(it, Ok(Verdict::Valid(_)))) {
        // As many as travel together.
        let mut sum = size(logs[first]);
        let mut end = first + 1;
        while end < logs.len() && sum + size(logs[end]) <= LARGEST_ATTACHMENTS as u64 {
            sum += size(logs[end]);
            end += 1;
        }
        let mut attachments = Attachments::default();
        let jobs: Vec<Job> = logs[first..end]
            .iter()
            .map(|log| {
                let place = attachments.pack(&log.path);
                let words = vec!["judge-log".to_string(), "--".to_string(), place.clone()];
                Job { words, files: vec![place], limit: allowance.replay.as_secs_f64() }
            })
            .collect();
        engine.run(&attachments, &jobs, &|| false, &mut |job, answer| {
            let index = first + job;
            let outcome = match answer {
                Answer::Lost(why) => Err(why),
                Answer::Ended(ended) => match ended.status {
                    None => Err(late(REPLAY, allowance.replay)),
                    Some(status) if !status.success() => Err(format!("{REPLAY} ended with {status}")),
                    Some(_) => judged(&ended.printed, logs[index], REPLAY).map(|it| it.verdict),
                },
            };
            outcomes[index] = Some(outcome);
            each();
            Ok(())
        })?;
        first = end;
    }
    Ok(outcomes)
}

/// Plays the commands of a log without sight on two other seeds, in a process of its own: the pegs that
/// count, and all of them.
pub fn elsewhere(log: &LogFile, allowance: &Allowance) -> Result<[usize; 2], String> {
    let judged = ask_all(log, &["--elsewhere"], "playing it on other seeds", allowance.replay)?;
    match (judged.verdict, judged.kept) {
        (_, Some(kept)) => Ok(kept),
        (Verdict::Refused(why), None) => Err(why),
        (Verdict::Valid(_), None) => Err("playing it on other seeds gave no answer".to_string()),
    }
}

fn ask(log: &LogFile, words: &[&str], what: &str, limit: Duration) -> Result<Verdict, String> {
    Ok(ask_all(log, words, what, limit)?.verdict)
}

/// Starts the process of a log and waits for its answer. `what` is its work, in words.
fn ask_all(log: &LogFile, words: &[&str], what: &str, limit: Duration) -> Result<Judged, String> {
    let fail = |error: std::io::Error| format!("{what} cannot be started: {error}");
    let mut child = Command::new(std::env::current_exe().map_err(fail)?)
        .arg("judge-log")
        .args(words)
        .arg(&log.path)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .map_err(fail)?;
    let text = answer(&mut child, what, limit);
    if text.is_err() {
        let _ = child.kill();
    }
    let status = child.wait().map_err(fail)?;
    let text = text?;
    if !status.success() {
        return Err(format!("{what} ended with {status}"));
    }
    judged(text.as_bytes(), log, what)
}

/// The answer of the process of a log.
fn judged(text: &[u8], log: &LogFile, what: &str) -> Result<Judged, String> {
    let judged: Judged = serde_json::from_slice(text).map_err(|_| format!("{what} gave no answer"))?;
    if judged.sha256 != log.sha256 {
        return Err("the log was changed while it was read".to_string());
    }
    Ok(judged)
}

/// The reason for stopping the process of a log.
fn late(what: &str, limit: Duration) -> String {
    format!("{what} was not done after {} s", limit.as_secs_f64())
}

/// The output of a process that ends within the limit.
fn answer(child: &mut Child, what: &str, limit: Duration) -> Result<String, String> {
    let fail = |error: std::io::Error| format!("{what} cannot be followed: {error}");
    let begin = Instant::now();
    loop {
        if begin.elapsed() > limit {
            return Err(late(what, limit));
        }
        if child.try_wait().map_err(fail)?.is_some() {
            break;
        }
        std::thread::sleep(LOOK);
    }
    let mut text = String::new();
    if let Some(output) = child.stdout.take() {
        output.take(MOST_ANSWER as u64).read_to_string(&mut text).map_err(fail)?;
    }
    Ok(text)
}

/// The output of the other process.
#[derive(Serialize, Deserialize)]
struct Judged {
    sha256: String,
    verdict: Verdict,
    /// Pegs that its commands keep on other seeds, and all of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    kept: Option<[usize; 2]>,
}

/// The log of this process.
#[derive(clap::Args)]
pub struct Arguments {
    log: PathBuf,
    /// Read the log, and do not replay it
    #[arg(long)]
    only_read: bool,
    /// Play the commands of the log without sight on two other seeds, and do not replay it
    #[arg(long, conflicts_with = "only_read")]
    elsewhere: bool,
}

/// Reads a log in this process, replays it, and prints the verdict as JSON.
pub fn judge(arguments: &Arguments) -> Result<u8, Failure> {
    let memory = Some(MEMORY);
    setrlimit(Resource::As, Rlimit { current: memory, maximum: memory }).into_diagnostic()?;
    let limits = Limits::default();
    let bytes = bytes_of(&arguments.log, &limits).into_diagnostic()?;
    let sha256 = sha256(&bytes);
    // Verdicts are stored, so they do not tell where the file was.
    let log = Log::from_bytes(Path::new("the log"), &bytes, &limits);
    drop(bytes);
    let mut kept = None;
    let verdict = match log {
        Err(error) => Verdict::Refused(error.to_string()),
        Ok(log) if arguments.only_read => Verdict::Valid(Box::new(log.facts())),
        Ok(log) if arguments.elsewhere => match kept_elsewhere(&log) {
            Ok(pegs) => {
                kept = Some(pegs);
                Verdict::Valid(Box::new(log.facts()))
            }
            Err(error) => Verdict::Refused(in_words(&error)),
        },
        Ok(log) => replayed(&log),
    };
    let verdict = match verdict {
        Verdict::Refused(why) => Verdict::Refused(why.chars().take(LONGEST).collect()),
        valid @ Verdict::Valid(_) => valid,
    };
    let mut text =
        serde_json::to_string(&Judged { sha256: sha256.clone(), verdict, kept }).into_diagnostic()?;
    if text.len() > MOST_ANSWER {
        let verdict = Verdict::Refused("its names are too long".to_string());
        text = serde_json::to_string(&Judged { sha256, verdict, kept: None }).into_diagnostic()?;
    }
    print(&text)?;
    Ok(DONE)
}

/// The verdict of a replay.
fn replayed(log: &Log) -> Verdict {
    match ramp_episode::replay(log) {
        Ok(replayed) => match (replayed.differences.first(), replayed.breach) {
            (None, None) => Verdict::Valid(Box::new(log.facts())),
            (None, Some(breach)) => Verdict::Refused(breach.to_string()),
            (Some(first), _) => Verdict::Refused(format!(
                "it does not replay: at {:.3} s, {} is {} in the log and {} in the replay",
                first.time,
                first.what,
                shorten(&first.logged),
                shorten(&first.replayed)
            )),
        },
        Err(error) => Verdict::Refused(format!("it cannot be run again: {}", in_words(&error))),
    }
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
