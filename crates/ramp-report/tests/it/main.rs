//! The integration tests of `ramp-report`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr)]

mod leaderboard;
mod many;
mod readers;
mod results_fuzz;
mod technical;
