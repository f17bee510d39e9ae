//! The integration tests of `ramp-report`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod leaderboard;
mod many;
mod results_fuzz;
