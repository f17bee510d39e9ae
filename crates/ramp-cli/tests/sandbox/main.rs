//! Tests of agents in a sandbox and of boards, which run agents again in one. A kernel without Landlock skips
//! some.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::process::ExitCode;

use ramp_external_agent::sandbox::is_available;
use ramp_testing::program::text;
use ramp_testing::trials::run;
use tempfile::TempDir;

mod board;
mod calls;
mod seal;
mod walls;

/// The reason why no sandbox is available on this system.
fn missing() -> Option<String> {
    (!is_available()).then(|| "this kernel has no Landlock or no seccomp".to_string())
}

/// The reason why an agent gets no name spaces of its own on this system.
fn missing_rooms() -> Option<String> {
    let agents = seal::agents();
    let results = TempDir::new().unwrap();
    let arguments = ["run", "easy-1", "--track", "state", "-o", "out.json", "--sandbox"];
    let output = seal::ramp(&results, &arguments, &agents.path().join("mover.py")).output().unwrap();
    let none = text(&output.stderr).contains("no name spaces of its own here");
    missing().or(none.then(|| "this system gives a user no name spaces of its own".to_string()))
}

fn main() -> ExitCode {
    let mut checks = seal::checks();
    checks.extend(calls::checks());
    checks.extend(walls::checks());
    checks.extend(board::checks());
    run(checks)
}
