//! Describes how a process ended, and ends this one on request.

use std::os::unix::process::CommandExt;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::Once;

use miette::{IntoDiagnostic, Report};
use ramp_kit::source::remove_unfinished;
use ramp_planner::Exceeded;

use crate::output::tell;
use crate::status::STOPPED;

/// Only argument of a process that ends at once with the status of bad input.
pub const ENDED: &str = "ended";

/// Installs a handler that removes unfinished files on Ctrl-C and SIGTERM before the program ends.
///
/// # Errors
/// If the handler cannot be installed.
pub fn end_on_request() -> Result<(), Report> {
    ctrlc::set_handler(|| {
        remove_unfinished();
        std::process::exit(STOPPED.into());
    })
    .into_diagnostic()
}

/// Describes in words how a process ended.
pub fn end_of(status: ExitStatus) -> String {
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return format!("killed by signal {signal}");
    }
    match status.code() {
        Some(code) => format!("ended with status {code} and no result"),
        None => "ended without a result".to_string(),
    }
}

/// Ends this program while another thread still solves rules. That thread cannot be stopped, and must not run
/// during the exit handlers of the process. Therefore `exec` replaces the process by a new one that ends at
/// once.
pub fn end_planning(exceeded: &Exceeded) {
    static ENDING: Once = Once::new();
    ENDING.call_once(|| {
        tell(&format!("{:?}", Report::new(exceeded.clone())));
        remove_unfinished();
        if let Ok(program) = std::env::current_exe() {
            // `exec` returns only if it fails.
            let _ = Command::new(program).arg(ENDED).stdin(Stdio::null()).exec();
        }
        std::process::abort();
    });
}
