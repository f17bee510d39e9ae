//! The exit status of the program.

/// Done.
pub const DONE: u8 = 0;
/// The run ended without completing the goal, or a check failed.
pub const INCOMPLETE: u8 = 1;
/// Bad usage or bad input.
pub const BAD_INPUT: u8 = 2;
/// The machine failed, such as a full disk: what was being made counts as neither done nor failed.
pub const MACHINE: u8 = 3;
/// Stopped by a signal: this and the signal's number, such as 130 for Ctrl-C.
pub const STOPPED_BY: u8 = 128;

/// The machine failed.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("{what}")]
#[diagnostic(help("The machine failed (disk full or read-only?). Fix it and run the same command again."))]
pub struct MachineFault {
    /// The failed operation, and the system's error message.
    pub what: String,
}

impl MachineFault {
    /// From the error of an operation that only a fault of the machine can make fail.
    pub fn of(error: impl std::fmt::Display) -> MachineFault {
        MachineFault { what: error.to_string() }
    }
}
