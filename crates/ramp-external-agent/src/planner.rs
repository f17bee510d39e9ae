//! A task planner that is a program of its own, in any language: it gets a problem as one line of JSON, and
//! writes a plan to its standard output.

use std::ffi::OsString;
use std::time::Instant;

use serde_json::{Value, json};

use crate::file::AgentFile;
use crate::limits::Patience;
use crate::process::{Process, Silence};
use crate::sandbox::Sandbox;

/// Largest plan, bytes: as for a plan file.
const LARGEST: usize = 16 << 20;

/// The reason why there is no plan.
#[derive(Debug, thiserror::Error)]
pub enum PlannerError {
    /// The system does not start the program.
    #[error("the planner cannot be started: {0}")]
    Start(std::io::Error),
    /// The program does not answer, or does not end well.
    #[error("{}", of_planner(.0))]
    Silence(Silence),
    /// Its time is over.
    #[error("the planner was not done after {seconds} s")]
    Slow {
        /// s.
        seconds: f64,
    },
    /// It says too much.
    #[error("the planner wrote more than {LARGEST} bytes")]
    Endless,
    /// It ended well and wrote nothing.
    #[error("the planner wrote no plan")]
    Nothing,
}

/// The words about an agent that is silent, about a planner.
fn of_planner(silence: &Silence) -> String {
    silence.to_string().replacen("the agent", "the planner", 1)
}

/// Asks a program for a plan; its text. `command` is what starts it, usually [`AgentFile::command`]. If its
/// first line is `{"pddl": {}}`, it gets what `pddl` makes as a second line.
///
/// # Errors
/// If it does not end by itself, with status 0 and within `patience`, after it wrote something.
pub fn ask_planner(
    command: &[OsString],
    patience: Patience,
    sandbox: Option<&Sandbox>,
    problem: &Value,
    pddl: impl FnOnce() -> Value,
) -> Result<String, PlannerError> {
    let mut process = Process::start(command, patience, sandbox).map_err(PlannerError::Start)?;
    let line = |value: &Value| format!("{value}\n").into_bytes();
    let mut pddl = Some(pddl);
    let mut text = String::new();
    // A program that does not read the problem may still have a plan.
    let _ = process.tell(line(problem));
    let begin = Instant::now();
    let slow = PlannerError::Slow { seconds: patience.answer.as_secs_f64() };
    loop {
        if begin.elapsed() > patience.answer {
            return Err(slow);
        }
        match process.hear() {
            Ok(heard) => {
                let heard = String::from_utf8_lossy(&heard);
                if text.is_empty()
                    && is_request(&heard)
                    && let Some(pddl) = pddl.take()
                {
                    process.tell(line(&json!({ "pddl": pddl() }))).map_err(PlannerError::Silence)?;
                    continue;
                }
                text.push_str(&heard);
                text.push('\n');
                if text.len() > LARGEST {
                    return Err(PlannerError::Endless);
                }
            }
            Err(Silence::Ended { .. }) if process.ended_well() => break,
            Err(Silence::Hangs { .. }) => return Err(slow),
            Err(silence) => return Err(PlannerError::Silence(silence)),
        }
    }
    if text.trim().is_empty() { Err(PlannerError::Nothing) } else { Ok(text) }
}

/// Whether a line asks for the problem in PDDL.
fn is_request(line: &str) -> bool {
    serde_json::from_str::<Value>(line).is_ok_and(|value| value == json!({ "pddl": {} }))
}

/// The name of a planner in results: `planner`, its file's name, and the first digits of its hash.
pub fn planner_name(file: &AgentFile) -> String {
    let stem = file.path().file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
    let short: String = ramp_kit::source::to_name(&stem).chars().take(24).collect();
    format!("planner-{short}.{}", &file.sha256()[..8])
}
