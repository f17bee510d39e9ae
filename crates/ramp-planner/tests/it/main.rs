//! The integration tests of `ramp-planner`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr)]

mod common;
mod diagnosis;
mod errors;
mod fuzz;
mod generated;
#[cfg(target_os = "linux")]
mod limits;
mod motion;
mod pddl;
mod plans;
mod quicker;
mod strips;
