//! How a process becomes an agent: it gives up what an agent must not have, and then runs the agent's program
//! in its own place.

use std::ffi::OsString;
use std::os::unix::process::CommandExt;
use std::process::Command;

use rustix::process::{DumpableBehavior, Signal};
use rustix::thread::CapabilitySet;

use crate::sandbox::Inside;

/// Powers of the superuser by which one process looks into another.
const TO_LOOK_INTO_OTHERS: CapabilitySet = CapabilitySet::SYS_PTRACE
    .union(CapabilitySet::SYS_ADMIN)
    .union(CapabilitySet::SYS_RAWIO)
    .union(CapabilitySet::SYS_MODULE)
    .union(CapabilitySet::PERFMON)
    .union(CapabilitySet::BPF)
    .union(CapabilitySet::CHECKPOINT_RESTORE);

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
    give_up(CapabilitySet::all());
    let mut command = inside.command(program, arguments);
    match inside.enter() {
        Ok(()) => command.exec(),
        Err(error) => std::io::Error::other(error),
    }
}

/// No program that this process becomes has these powers. Who is not the superuser has none to give up.
fn give_up(powers: CapabilitySet) {
    for power in powers.iter() {
        let _ = rustix::thread::remove_capability_from_bounding_set(power);
    }
}

/// From now on, other processes of the same user cannot look into this one: not at its memory, its open files
/// or its environment.
pub fn hide() {
    let _ = rustix::process::set_dumpable_behavior(DumpableBehavior::NotDumpable);
}
