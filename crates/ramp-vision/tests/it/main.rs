//! The integration tests of `ramp-vision`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod anywhere;
mod places;
mod regions;
mod round_trip;
mod untagged;
