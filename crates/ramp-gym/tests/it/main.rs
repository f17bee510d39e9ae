//! The integration tests of `ramp-gym`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod gym;
mod images;
