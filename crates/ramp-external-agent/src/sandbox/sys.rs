//! The calls of the system that Rust cannot check.

use std::ffi::CString;
use std::io::{Error, Result};
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use rustix::process::{Pid, Signal};
use rustix::thread::UnshareFlags;

/// The argument of `mount_setattr`.
#[repr(C)]
struct MountAttributes {
    set: u64,
    clear: u64,
    propagation: u64,
    user_name_space: u64,
}

const READ_ONLY: u64 = 0x1;
const NO_SET_USER: u64 = 0x2;

/// Moves this process into new name spaces.
///
/// # Errors
/// The system's error, such as for a process with several threads.
#[allow(unsafe_code)]
pub fn unshare(spaces: UnshareFlags) -> Result<()> {
    // SAFETY: the table of open files is not among these; nothing else of Rust's depends on a name space.
    unsafe { rustix::thread::unshare_unsafe(spaces - UnshareFlags::FILES) }?;
    Ok(())
}

/// Splits this process in two: the number of the new one, and `None` in the new one. This process must have
/// one thread only, which [`unshare`] with a user name space has already shown.
///
/// # Errors
/// The system's error.
#[allow(unsafe_code)]
pub fn fork() -> Result<Option<Pid>> {
    // SAFETY: there is one thread, so that no lock is held in the new process.
    match unsafe { libc::fork() } {
        -1 => Err(Error::last_os_error()),
        number => Ok(Pid::from_raw(number)),
    }
}

/// Ends this process at once, without what others have registered for its end.
#[allow(unsafe_code)]
pub fn leave(status: i32) -> ! {
    // SAFETY: it does not return, and touches no memory.
    unsafe { libc::_exit(status) }
}

/// Ends this process by a signal.
#[allow(unsafe_code)]
pub fn die_by(signal: Signal) -> ! {
    // SAFETY: the default action of a signal is no function of this program.
    unsafe { libc::signal(signal.as_raw(), libc::SIG_DFL) };
    let _ = rustix::process::kill_process(rustix::process::getpid(), signal);
    // A signal that ends no process.
    leave(127)
}

/// Makes a mount and all below it read-only: no file, attribute, mode or time of access changes there.
///
/// # Errors
/// The system's error.
#[allow(unsafe_code)]
pub fn make_read_only(mount: &Path) -> Result<()> {
    let path = CString::new(mount.as_os_str().as_bytes())?;
    let set = MountAttributes { set: READ_ONLY | NO_SET_USER, clear: 0, propagation: 0, user_name_space: 0 };
    // SAFETY: path and attributes live until the call is over, and the size is that of the attributes.
    let done = unsafe {
        libc::syscall(
            libc::SYS_mount_setattr,
            libc::AT_FDCWD,
            path.as_ptr(),
            libc::AT_RECURSIVE,
            &raw const set,
            size_of::<MountAttributes>(),
        )
    };
    if done == 0 { Ok(()) } else { Err(Error::last_os_error()) }
}
