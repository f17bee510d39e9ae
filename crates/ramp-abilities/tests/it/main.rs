//! The integration tests of `ramp-abilities`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod skills;
