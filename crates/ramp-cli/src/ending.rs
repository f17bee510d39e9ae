//! How a process ended, and how this one ends when it is asked to.

use std::os::unix::process::CommandExt;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::Once;

use miette::{IntoDiagnostic, Report};
use ramp_kit::source::remove_unfinished;
use ramp_planner::Exceeded;

use crate::status::STOPPED;

/// The only argument of a program that has nothing to do but to end with the status of bad input.
pub const ENDED: &str = "ended";

/// From now on, Ctrl-C and a request to end (SIGTERM) take away what is not whole before the program ends.
///
/// # Errors
/// When the system does not let it.
pub fn end_on_request() -> Result<(), Report> {
    ctrlc::set_handler(|| {
        remove_unfinished();
        std::process::exit(STOPPED.into());
    })
    .into_diagnostic()
}

/// How a process ended, in words.
pub fn end_of(status: ExitStatus) -> String {
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return format!("killed by signal {signal}");
    }
    match status.code() {
        Some(code) => format!("ended with status {code} and no result"),
        None => "ended without a result".to_string(),
    }
}

/// Ends this program while rules are at work on another thread. That thread cannot be asked to stop, and must not be at
/// work while the program takes itself apart: so another program takes its place, which knows nothing of it.
pub fn end_planning(exceeded: &Exceeded) {
    static ENDING: Once = Once::new();
    ENDING.call_once(|| {
        eprintln!("{:?}", Report::new(exceeded.clone()));
        remove_unfinished();
        if let Ok(program) = std::env::current_exe() {
            // Returns only when that cannot be done.
            let _ = Command::new(program).arg(ENDED).stdin(Stdio::null()).exec();
        }
        std::process::abort();
    });
}
