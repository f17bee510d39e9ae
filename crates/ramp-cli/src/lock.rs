//! A folder that one run at a time may write to.
//!
//! The run holds a lock of the system on the file `.lock`. Some network file systems have no locks. There the
//! run creates the file `.lock-held`, which only one run can do, and removes it at its end.

use std::fs::{File, TryLockError};
use std::io::{Error, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use rustix::io::Errno;

use crate::output::tell;

/// The file on which the system's lock lies.
const LOCK: &str = ".lock";
/// The file that is there while a run holds a folder without locks. It names the run: host and process.
const HELD: &str = ".lock-held";
/// Longest name of a run in that file, bytes.
const LONGEST: u64 = 512;

/// A folder that is held. Dropping it lets the folder go.
pub struct FolderLock {
    _file: File,
    held: Option<PathBuf>,
}

/// Why a folder is not held.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// Another run holds it.
    #[error("another run is at work in the folder{}", who.as_deref().unwrap_or_default())]
    Busy {
        /// The run and its file, on a file system without locks.
        who: Option<String>,
    },
    /// The system failed.
    #[error(transparent)]
    Failed(#[from] Error),
}

impl FolderLock {
    /// Holds an existing folder, or returns [`LockError::Busy`] at once.
    pub fn take(folder: &Path) -> Result<FolderLock, LockError> {
        FolderLock::take_by(folder, File::try_lock)
    }

    /// As [`FolderLock::take`], with the system's lock as an argument.
    fn take_by(
        folder: &Path,
        lock: impl Fn(&File) -> Result<(), TryLockError>,
    ) -> Result<FolderLock, LockError> {
        let file = File::create(folder.join(LOCK))?;
        match lock(&file) {
            Ok(()) => Ok(FolderLock { _file: file, held: None }),
            Err(TryLockError::WouldBlock) => Err(LockError::Busy { who: None }),
            Err(TryLockError::Error(error)) if has_no_locks(&error) => {
                let held = folder.join(HELD);
                create(&held)?;
                tell(&format!(
                    "the file system of {} has no locks ({error}): the file {HELD} keeps other runs out",
                    folder.display()
                ));
                Ok(FolderLock { _file: file, held: Some(held) })
            }
            Err(TryLockError::Error(error)) => Err(error.into()),
        }
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        if let Some(held) = &self.held {
            let _ = std::fs::remove_file(held);
        }
    }
}

/// Whether a lock failed because the file system has none.
fn has_no_locks(error: &Error) -> bool {
    let errno = error.raw_os_error().map(Errno::from_raw_os_error);
    matches!(errno, Some(Errno::NOLCK | Errno::NOSYS | Errno::OPNOTSUPP))
        || error.kind() == ErrorKind::Unsupported
}

/// Creates the file of this run. One that a killed run of this computer left is replaced.
fn create(held: &Path) -> Result<(), LockError> {
    let us = format!("{} {}\n", host(), std::process::id());
    for attempt in [1, 2] {
        match File::create_new(held) {
            Ok(mut file) => return Ok(file.write_all(us.as_bytes())?),
            Err(error) if error.kind() != ErrorKind::AlreadyExists => return Err(error.into()),
            Err(_) if attempt == 1 && is_left_over(held) => std::fs::remove_file(held)?,
            Err(_) => break,
        }
    }
    let words = read(held).unwrap_or_default();
    let (host, process) = words.trim().rsplit_once(' ').unwrap_or(("another computer", "unknown"));
    let who = format!(
        " (process {} on {}); if it was killed, delete {}",
        ramp_kit::source::shorten(process),
        ramp_kit::source::shorten(host),
        held.display()
    );
    Err(LockError::Busy { who: Some(who) })
}

/// Whether the run that created this file was one of this computer and has ended.
fn is_left_over(held: &Path) -> bool {
    let Some(words) = read(held) else { return false };
    let Some((theirs, process)) = words.trim().rsplit_once(' ') else { return false };
    let process = process.parse().ok().and_then(rustix::process::Pid::from_raw);
    theirs == host()
        && process.is_some_and(|process| rustix::process::test_kill_process(process) == Err(Errno::SRCH))
}

fn read(held: &Path) -> Option<String> {
    let mut words = String::new();
    File::open(held).ok()?.take(LONGEST).read_to_string(&mut words).ok()?;
    Some(words)
}

/// The name of this computer.
fn host() -> String {
    rustix::system::uname().nodename().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file system without locks.
    fn take(folder: &Path) -> Result<FolderLock, LockError> {
        FolderLock::take_by(folder, |_| Err(TryLockError::Error(Errno::NOLCK.into())))
    }

    #[test]
    fn a_folder_without_locks_is_held_by_one_run() {
        let folder = tempfile::tempdir().unwrap();
        let held = folder.path().join(HELD);
        let first = take(folder.path()).unwrap();
        let Err(LockError::Busy { who: Some(who) }) = take(folder.path()) else { panic!("it is held twice") };
        assert!(who.contains(&format!("process {} on", std::process::id())) && who.contains(HELD), "{who}");
        drop(first);
        assert!(!held.exists());
        drop(take(folder.path()).unwrap());
        // Left by a run of this computer that was killed: no process has this number.
        std::fs::write(&held, format!("{} {}\n", host(), i32::MAX)).unwrap();
        drop(take(folder.path()).unwrap());
        // A run of another computer may still be at work.
        std::fs::write(&held, format!("elsewhere {}\n", i32::MAX)).unwrap();
        let Err(error) = take(folder.path()) else { panic!("it is held twice") };
        assert!(error.to_string().contains("on elsewhere); if it was killed, delete "), "{error}");
    }

    #[test]
    fn a_lock_that_fails_otherwise_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let failing = |_: &File| Err(TryLockError::Error(Errno::IO.into()));
        assert!(matches!(FolderLock::take_by(folder.path(), failing), Err(LockError::Failed(_))));
        let busy = |_: &File| Err(TryLockError::WouldBlock);
        assert!(matches!(FolderLock::take_by(folder.path(), busy), Err(LockError::Busy { who: None })));
    }
}
