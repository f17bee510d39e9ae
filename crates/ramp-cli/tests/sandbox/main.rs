//! Tests of agents in a sandbox and of boards, which run agents again in one. A kernel without Landlock skips
//! some.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

use std::process::ExitCode;

use ramp_external_agent::sandbox::open_ends;
use ramp_testing::trials::run;

mod board;
mod seal;

/// The reason why no sandbox is available on this system.
fn missing() -> Option<String> {
    open_ends().is_none().then(|| "this kernel has no Landlock or no seccomp".to_string())
}

fn main() -> ExitCode {
    let mut checks = seal::checks();
    checks.extend(board::checks());
    run(checks)
}
