//! The integration tests of `ramp-motion`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod arms;
