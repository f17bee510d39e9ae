//! Helpers that tests share. Only tests and benchmarks use this crate, as a development dependency.

// A helper may panic as its test may.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

#[cfg(feature = "calibration")]
pub mod calibration;
#[cfg(feature = "episode")]
pub mod episode;
#[cfg(feature = "twin")]
pub mod goal;
#[cfg(feature = "episode")]
pub mod log;
pub mod mangle;
pub mod program;
#[cfg(feature = "twin")]
pub mod robot;
#[cfg(feature = "table")]
pub mod table;
pub mod trials;

#[cfg(feature = "twin")]
pub use goal::GoalFiles;

/// The data folder of the project.
#[must_use]
pub fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")
}
