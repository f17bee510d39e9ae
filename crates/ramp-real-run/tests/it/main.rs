//! The integration tests of `ramp-real-run`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod drive;
mod mistakes;
mod poses;
mod rules;
mod stopwatch;
