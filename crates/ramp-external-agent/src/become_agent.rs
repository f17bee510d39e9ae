//! How a process becomes an agent: it gives up what an agent must not have, and then runs the agent's program
//! in its own place.

use std::ffi::OsString;
use std::os::unix::process::CommandExt;
use std::process::Command;

use crate::powers::{TO_LOOK_INTO_OTHERS, give_up};
use crate::sandbox::Inside;
use rustix::process::{DumpableBehavior, Signal};

/// Becomes another program that is killed when the process `parent`, which started this one, is gone. It
/// cannot look into other processes, not even as the superuser; with `inside` it is in a sandbox. Returns
/// only when that cannot be done.
pub fn become_agent(parent: u32, inside: Option<&Inside>, command: &[OsString]) -> std::io::Error {
    if let Err(error) = rustix::process::set_parent_process_death_signal(Some(Signal::KILL)) {
        return error.into();
    }
    // It may have gone before this process began to watch.
    let present = rustix::process::getppid().map(|pid| pid.as_raw_nonzero().get());
    if present != i32::try_from(parent).ok() {
        return std::io::Error::other("its parent is gone");
    }
    let Some((program, arguments)) = command.split_first() else {
        return std::io::ErrorKind::InvalidInput.into();
    };
    let Some(inside) = inside else {
        give_up(TO_LOOK_INTO_OTHERS);
        return Command::new(program).args(arguments).exec();
    };
    let mut command = inside.command(program, arguments);
    match inside.enter() {
        Ok(()) => command.exec(),
        Err(error) => std::io::Error::other(error),
    }
}

/// From now on, other processes of the same user cannot look into this one: not at its memory, its open files
/// or its environment.
pub fn hide() {
    let _ = rustix::process::set_dumpable_behavior(DumpableBehavior::NotDumpable);
}
