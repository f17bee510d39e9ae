//! How a process ended, and how this one ends when it is asked to.

use std::process::ExitStatus;

use miette::{IntoDiagnostic, Report};
use ramp_kit::source::remove_unfinished;

use crate::status::STOPPED;

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
