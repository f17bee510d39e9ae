//! How a run hides from an agent what the agent must not know.
//!
//! An agent is a process of the same user. It may read the command line of every other one, and with it the seed. A
//! program that works with such an agent therefore gets its arguments through standard input: [`seal`] starts this
//! program anew in its own place, and [`arguments`] takes them in. [`child`] starts another one in the same way, and
//! [`guard`] a child of which nothing is left when it ends, however that happens.

use std::ffi::{OsStr, OsString};
use std::io::{Read, Seek, Write};
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use miette::{IntoDiagnostic, Report};
use ramp_external_agent::{adopt_orphans, end_orphans, hide};

use crate::ending::end_of;
use crate::status::{INCOMPLETE, MachineFault, STOPPED};

/// The only argument of a program that gets the others through standard input.
const SEALED: &str = "sealed";
/// The same, of a program that ends when its standard input does: whoever started it is gone.
const LEASHED: &str = "leashed";
/// All arguments together, bytes; a system allows no more either.
const MOST: usize = 2 << 20;
/// How often it is looked after a child.
const LOOK: Duration = Duration::from_millis(20);

/// Who may see the arguments of this program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seal {
    /// Every process of the user.
    Open,
    /// Nobody.
    Sealed,
    /// Nobody, and this program ends with the one that started it.
    Leashed,
}

/// The arguments of this program, its own name first. From then on a sealed program cannot be looked into.
///
/// # Errors
/// When standard input holds no arguments.
pub fn arguments() -> std::io::Result<(Vec<OsString>, Seal)> {
    let mut words: Vec<OsString> = std::env::args_os().collect();
    let seal = match words.get(1) {
        Some(word) if words.len() == 2 && word == SEALED => Seal::Sealed,
        Some(word) if words.len() == 2 && word == LEASHED => Seal::Leashed,
        _ => return Ok((words, Seal::Open)),
    };
    hide();
    words.truncate(1);
    let mut input = std::io::stdin().lock();
    let mut word = Vec::new();
    // One byte at a time: what follows the arguments is left where it is.
    let mut byte = [0];
    for _ in 0..MOST {
        input.read_exact(&mut byte)?;
        match byte {
            [0] if word == [END] => {
                if seal == Seal::Leashed {
                    hold_leash();
                }
                return Ok((words, seal));
            }
            [0] => words.push(OsString::from_vec(std::mem::take(&mut word))),
            [byte] => word.push(byte),
        }
    }
    Err(std::io::Error::other("the sealed arguments have no end"))
}

/// Ends this program when its standard input does.
fn hold_leash() {
    std::thread::spawn(|| {
        let _ = std::io::copy(&mut std::io::stdin().lock(), &mut std::io::sink());
        std::process::exit(INCOMPLETE.into());
    });
}

/// The byte of a word that ends the arguments; no argument is this byte alone, for a terminal cannot send it.
const END: u8 = 4;

/// Arguments as they go through standard input: each ends with a zero, and the last one is [`END`].
fn bytes_of(words: &[OsString]) -> Vec<u8> {
    let end = OsStr::from_bytes(&[END]);
    let words = words.iter().map(OsString::as_os_str).chain([end]);
    words.flat_map(|word| [word.as_bytes(), &[0]].concat()).collect()
}

/// Starts this program anew in its own place, with its arguments sealed.
///
/// # Errors
/// Returns only when that cannot be done.
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

/// Starts this program as a child with sealed arguments. The pipe to its standard input is its leash: it closes when
/// this process ends, however that happens, and then the child ends as well.
///
/// # Errors
/// When the system does not start it.
pub fn child(words: &[OsString], prepare: impl FnOnce(&mut Command)) -> std::io::Result<Child> {
    let mut command = Command::new(std::env::current_exe()?);
    command.arg(LEASHED).stdin(Stdio::piped());
    // Ctrl-C on a terminal is for this process alone, which then ends the child.
    command.process_group(0);
    prepare(&mut command);
    let mut child = command.spawn()?;
    if let Some(input) = &mut child.stdin {
        input.write_all(&bytes_of(words))?;
    }
    Ok(child)
}

/// Runs this program as a child, and ends all that is left of it: also when an agent has killed the child, or when this
/// process is asked to end.
///
/// # Errors
/// When the system does not start it.
pub fn guard(words: &[OsString]) -> Result<u8, Report> {
    adopt_orphans();
    let stop = Arc::new(AtomicBool::new(false));
    let handler = stop.clone();
    ctrlc::set_handler(move || handler.store(true, Ordering::Relaxed)).into_diagnostic()?;
    // What the child leaves behind when it is killed is in there, and goes with this process.
    let folder = tempfile::tempdir().map_err(MachineFault::of)?;
    let mut child = child(words, |command| {
        command.env("TMPDIR", folder.path());
    })
    .into_diagnostic()?;
    let status = loop {
        if let Some(status) = child.try_wait().into_diagnostic()? {
            break Some(status);
        }
        if stop.load(Ordering::Relaxed) {
            break None;
        }
        std::thread::sleep(LOOK);
    };
    if status.is_none() {
        let _ = child.kill();
        let _ = child.wait();
    }
    end_orphans(&[]);
    let Some(status) = status else { return Ok(STOPPED) };
    Ok(status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or_else(|| {
        eprintln!("the run was {}; it has no result", end_of(status));
        INCOMPLETE
    }))
}
