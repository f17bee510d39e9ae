//! The integration tests of `ramp-action-language`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod errors;
mod fuzz;
mod states;
