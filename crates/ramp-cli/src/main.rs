//! The `ramp` command.

use std::process::ExitCode;

use rustix::process::{Resource, getrlimit};

/// The stack that the program needs, bytes. The usual limit of a shell.
const STACK: usize = 8 << 20;

fn main() -> ExitCode {
    if getrlimit(Resource::Stack).current.is_none_or(|limit| limit >= STACK as u64) {
        return ramp_cli::main();
    }
    // The limit of this shell is too small for the first thread.
    let worker = std::thread::Builder::new().stack_size(STACK).spawn(ramp_cli::main);
    match worker.map(std::thread::JoinHandle::join) {
        Ok(Ok(status)) => status,
        _ => ExitCode::FAILURE,
    }
}
