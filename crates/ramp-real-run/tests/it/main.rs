//! The integration tests of `ramp-real-run`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

#[path = "../../../ramp-episode/tests/it/common.rs"]
mod common;
mod poses;
mod rules;
mod stopwatch;
