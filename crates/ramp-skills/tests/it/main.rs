//! The integration tests of `ramp-skills`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod events;
mod general;
mod rehearsal;
