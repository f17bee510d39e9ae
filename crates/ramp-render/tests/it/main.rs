//! The integration tests of `ramp-render`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod depth;
mod pictures;
