//! The integration tests of `ramp-kit`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod bad_kits;
#[cfg(feature = "export")]
mod export;
mod kit;
mod mutations;
#[cfg(feature = "export")]
mod paper;
#[cfg(feature = "export")]
mod solids;
