//! How a process ended.

use std::process::ExitStatus;

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
