//! Hides the arguments of a run, such as its seed, from the agent.
//!
//! An agent is a process of the same user. It can read the command line of every other process of that user,
//! and with it the seed. A program that runs such an agent therefore gets its arguments through standard
//! input: [`seal`] restarts this program in the same process, and [`arguments`] reads them. [`child`] starts
//! a child process in the same way. [`guard`] starts a child and cleans up all that remains of it, however it
//! ends.

use std::ffi::{OsStr, OsString};
use std::io::{Read, Seek, Write};
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use miette::{IntoDiagnostic, Report};
use ramp_external_agent::{adopt_orphans, end_orphans, hide};
use signal_hook::consts::SIGTERM;

use crate::ending::{defer_requests, end_of, requested};
use crate::output::tell;
use crate::status::{INCOMPLETE, MachineFault};

/// Only argument of a program that reads its other arguments from standard input.
const SEALED: &str = "sealed";
/// The same for a program that ends when its standard input closes, because its parent has ended.
const LEASHED: &str = "leashed";
/// The same for a program on a worker of a cluster. It is guarded like one whose arguments are sealed, and
/// asks itself to end when its standard input closes.
const GUARDED: &str = "guarded";
/// Largest total size of the arguments, bytes. The system's own limit is no larger.
const MOST: usize = 2 << 20;
/// Polling interval for a child.
const LOOK: Duration = Duration::from_millis(20);

/// Visibility of this program's arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seal {
    /// Visible to every process of the user.
    Open,
    /// Visible to no other process.
    Sealed,
    /// Visible to no other process, and this program ends with its parent.
    Leashed,
}

/// The arguments of this program, its own name first. After this call, other processes cannot inspect a
/// sealed program.
///
/// # Errors
/// If standard input holds no arguments.
pub fn arguments() -> std::io::Result<(Vec<OsString>, Seal)> {
    let mut words: Vec<OsString> = std::env::args_os().collect();
    let (seal, leash): (_, Option<fn()>) = match words.get(1).and_then(|word| word.to_str()) {
        Some(SEALED) if words.len() == 2 => (Seal::Sealed, None),
        Some(GUARDED) if words.len() == 2 => (Seal::Sealed, Some(ask_to_end)),
        Some(LEASHED) if words.len() == 2 => (Seal::Leashed, Some(end_at_once)),
        _ => return Ok((words, Seal::Open)),
    };
    hide();
    words.truncate(1);
    let mut input = std::io::stdin().lock();
    let mut word = Vec::new();
    // Read one byte at a time, so that input after the arguments stays unread.
    let mut byte = [0];
    for _ in 0..MOST {
        input.read_exact(&mut byte)?;
        match byte {
            [0] if word == [END] => {
                if let Some(end) = leash {
                    hold_leash(end);
                }
                return Ok((words, seal));
            }
            [0] => words.push(OsString::from_vec(std::mem::take(&mut word))),
            [byte] => word.push(byte),
        }
    }
    Err(std::io::Error::other("the sealed arguments have no end"))
}

/// Calls `end` when standard input closes.
fn hold_leash(end: fn()) {
    std::thread::spawn(move || {
        let _ = std::io::copy(&mut std::io::stdin().lock(), &mut std::io::sink());
        end();
    });
}

/// Ends this program.
fn end_at_once() {
    std::process::exit(INCOMPLETE.into());
}

/// Asks this program to end, as a cluster does.
fn ask_to_end() {
    let _ = signal_hook::low_level::raise(SIGTERM);
}

/// Word of one byte that ends the arguments. No argument consists of this byte alone, since a terminal cannot
/// send it.
const END: u8 = 4;

/// Encodes arguments for standard input: each ends with a zero byte, and the last one is [`END`].
fn bytes_of(words: &[OsString]) -> Vec<u8> {
    let end = OsStr::from_bytes(&[END]);
    let words = words.iter().map(OsString::as_os_str).chain([end]);
    words.flat_map(|word| [word.as_bytes(), &[0]].concat()).collect()
}

/// Restarts this program in the same process, with sealed arguments.
///
/// # Errors
/// Returns only if that fails.
pub fn seal(words: &[OsString]) -> Report {
    let start = || -> std::io::Result<std::io::Error> {
        let mut file = tempfile::tempfile()?;
        file.write_all(&bytes_of(words))?;
        file.rewind()?;
        Ok(Command::new(std::env::current_exe()?).arg(SEALED).stdin(file).exec())
    };
    let error = start().unwrap_or_else(|error| error);
    MachineFault { what: format!("this program cannot be started anew: {error}") }.into()
}

/// Starts this program as a child with sealed arguments. The pipe to the child's standard input closes when
/// this process ends, however that happens, and then the child ends as well.
///
/// # Errors
/// If the system cannot start it.
pub fn child(words: &[OsString], prepare: impl FnOnce(&mut Command)) -> std::io::Result<Child> {
    let mut command = Command::new(std::env::current_exe()?);
    command.arg(LEASHED).stdin(Stdio::piped());
    // Ctrl-C on a terminal reaches only this process, which then ends the child.
    command.process_group(0);
    prepare(&mut command);
    let mut child = command.spawn()?;
    let written = child.stdin.as_mut().map_or(Ok(()), |input| input.write_all(&bytes_of(words)));
    match written {
        // A child that was killed before it has read them: its status tells.
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error),
        _ => Ok(child),
    }
}

/// Runs this program as a child, and ends all its remaining processes, even if an agent killed the child or
/// this process receives a request to end.
///
/// # Errors
/// If the system cannot start it.
pub fn guard(words: &[OsString]) -> Result<u8, Report> {
    adopt_orphans();
    defer_requests();
    // Temporary files of a killed child lie in this folder, which this process removes.
    let folder = tempfile::tempdir().map_err(MachineFault::of)?;
    let mut child = child(words, |command| {
        command.env("TMPDIR", folder.path());
    })
    .into_diagnostic()?;
    let status = loop {
        if let Some(status) = child.try_wait().into_diagnostic()? {
            break Some(status);
        }
        if requested().is_some() {
            break None;
        }
        std::thread::sleep(LOOK);
    };
    if status.is_none() {
        let _ = child.kill();
        let _ = child.wait();
    }
    end_orphans(&[]);
    let Some(status) = status else { return Ok(requested().unwrap_or(INCOMPLETE)) };
    Ok(status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or_else(|| {
        tell(&format!("the run was {}; it has no result", end_of(status)));
        INCOMPLETE
    }))
}
