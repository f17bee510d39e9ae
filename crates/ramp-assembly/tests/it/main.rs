//! The integration tests of `ramp-assembly`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr)]

mod bad_goals;
mod extending;
mod generated;
mod goals;
mod mutations;
mod open;
