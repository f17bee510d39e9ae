//! The integration tests of `ramp-cli`.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod agents;
mod alone;
mod arms;
mod backend;
mod bench;
mod built_in;
mod calibrate;
mod clusters;
mod demos;
mod docs;
mod faults;
mod finder;
mod kit;
mod machine;
mod names;
mod open;
mod own;
mod people;
mod plan;
mod planners;
mod policies;
mod ramp;
mod reference;
mod replay;
mod report;
mod secret;
mod see;
mod skills;
mod teleop;
mod world;

use std::path::Path;
use std::process::Output;

/// Runs `ramp` in a folder.
fn ramp(folder: impl AsRef<Path>, arguments: &[&str]) -> Output {
    ramp_testing::program::run(env!("CARGO_BIN_EXE_ramp"), folder, arguments)
}
