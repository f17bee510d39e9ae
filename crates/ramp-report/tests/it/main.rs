//! The integration tests of `ramp-report`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

#[path = "../../../ramp-episode/tests/it/common.rs"]
mod common;
mod leaderboard;
mod many;
mod results_fuzz;
