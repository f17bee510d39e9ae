//! The integration tests of `ramp-twin`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr)]

mod cameras;
mod clamp;
mod effects;
mod export;
mod extending;
mod geometry;
mod grip;
mod limits;
mod pieces;
mod readings;
mod rigid;
mod scattered;
mod snapshot;
mod starts;
mod touch;
mod twin;
