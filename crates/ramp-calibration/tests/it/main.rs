//! The integration tests of `ramp-calibration`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod cameras;
mod file;
mod friction;
mod table;
