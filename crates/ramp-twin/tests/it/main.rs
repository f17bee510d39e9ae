//! The integration tests of `ramp-twin`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod cameras;
mod effects;
mod extending;
mod geometry;
mod grip;
mod readings;
mod snapshot;
mod starts;
mod twin;
