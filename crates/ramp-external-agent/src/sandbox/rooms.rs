//! Name spaces of an agent's own: other processes, the network and all files outside its view do not exist
//! there.
//!
//! Three processes take part. The first one, a child of the run, waits outside and ends as the agent ends.
//! The second one is process 1 of the name space: it collects what the agent leaves behind, and when it ends,
//! the kernel ends all others there. The third one becomes the agent.
//!
//! Its view of the files holds what it may read, read-only, and its own folder: a file system in memory of
//! limited size, where unlinked files count as long as they use space.

use std::fs::{File, OpenOptions, create_dir_all};
use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};

use rustix::mount::{
    MountFlags, MountPropagationFlags, UnmountFlags, mount, mount_bind_recursive, mount_change, unmount,
};
use rustix::process::{DumpableBehavior, Pid, Signal, WaitOptions, WaitStatus};
use rustix::thread::UnshareFlags;

use super::sys;

/// Processes that a name space has beside those of the agent.
pub const OWN_PROCESSES: usize = 2;
/// Files and folders that fit into the agent's own folder.
const MOST_FILES: usize = 100_000;

/// A step that failed.
#[derive(Debug, thiserror::Error)]
#[error("{step}: {source}")]
pub struct RoomError {
    step: String,
    source: std::io::Error,
}

/// Names the step of an error.
fn at<E: Into<std::io::Error>>(step: impl Into<String>) -> impl FnOnce(E) -> RoomError {
    move |source| RoomError { step: step.into(), source: source.into() }
}

/// The files, devices and folder that exist for an agent.
pub struct View<'a> {
    /// Files and folders that it may read.
    pub readable: &'a [PathBuf],
    /// Devices.
    pub devices: &'a [PathBuf],
    /// Its own folder, which must exist.
    pub folder: &'a Path,
    /// The size of its own folder, bytes.
    pub size: u64,
}

/// Moves this process into name spaces of its own with a view of the files. It returns in the process that is
/// to become the agent; the two others stay within.
///
/// # Errors
/// When the system does not allow it.
pub fn enter(view: &View) -> Result<(), RoomError> {
    let (user, group) = (rustix::process::geteuid().as_raw(), rustix::process::getegid().as_raw());
    let spaces = UnshareFlags::NEWUSER
        | UnshareFlags::NEWPID
        | UnshareFlags::NEWNET
        | UnshareFlags::NEWIPC
        | UnshareFlags::NEWNS
        | UnshareFlags::NEWUTS
        | UnshareFlags::NEWCGROUP;
    sys::unshare(spaces).map_err(at("new name spaces"))?;
    write("/proc/self/setgroups", "deny")?;
    write("/proc/self/uid_map", &format!("{user} {user} 1"))?;
    write("/proc/self/gid_map", &format!("{group} {group} 1"))?;
    let (mut outside, mut inside) = UnixStream::pair().map_err(at("a pair of sockets"))?;
    if let Some(first) = sys::fork().map_err(at("process 1"))? {
        drop(inside);
        wait_outside(first, &mut outside)
    }
    drop(outside);
    end_with(&mut inside)?;
    build(view)?;
    if let Some(agent) = sys::fork().map_err(at("the agent's process"))? {
        collect(agent, &mut inside)
    }
    Ok(())
}

fn write(path: &str, text: &str) -> Result<(), RoomError> {
    OpenOptions::new()
        .write(true)
        .open(path)
        .and_then(|mut it| it.write_all(text.as_bytes()))
        .map_err(at(path))
}

/// The process outside waits for process 1 and ends as the agent did: with its status, or by its signal.
fn wait_outside(first: Pid, socket: &mut UnixStream) -> ! {
    hide_and_let_go();
    let mut signal = [0; 4];
    let by_signal = socket.write_all(&[1]).and_then(|()| socket.read_exact(&mut signal)).is_ok();
    let status = wait_for(Some(first));
    if let Some(signal) = by_signal.then(|| Signal::from_named_raw(i32::from_le_bytes(signal))).flatten() {
        sys::die_by(signal);
    }
    match status {
        Some(status) if status.signaled() => sys::die_by(Signal::KILL),
        status => sys::leave(status.and_then(WaitStatus::exit_status).unwrap_or(127)),
    }
}

/// Process 1 ends with the process outside. That one may have ended before this process began to watch it.
fn end_with(socket: &mut UnixStream) -> Result<(), RoomError> {
    rustix::process::set_parent_process_death_signal(Some(Signal::KILL)).map_err(at("its end"))?;
    socket.read_exact(&mut [0]).map_err(at("its parent is gone"))
}

/// Process 1 collects what ends, until the agent has ended.
fn collect(agent: Pid, socket: &mut UnixStream) -> ! {
    hide_and_let_go();
    let Some(status) = wait_for(Some(agent)) else { sys::leave(127) };
    if let Some(signal) = status.terminating_signal() {
        let _ = socket.write_all(&signal.to_le_bytes());
    }
    sys::leave(status.exit_status().unwrap_or(127))
}

/// The end of a process; others that end meanwhile are collected.
fn wait_for(wanted: Option<Pid>) -> Option<WaitStatus> {
    loop {
        match rustix::process::wait(WaitOptions::empty()) {
            Ok(Some((ended, status))) if Some(ended) == wanted => return Some(status),
            Ok(_) | Err(rustix::io::Errno::INTR) => {}
            Err(_) => return None,
        }
    }
}

/// Others cannot look into this process, and it holds none of the agent's pipes.
fn hide_and_let_go() {
    let _ = rustix::process::set_dumpable_behavior(DumpableBehavior::NotDumpable);
    if let Ok(null) = OpenOptions::new().read(true).write(true).open("/dev/null") {
        let _ = rustix::stdio::dup2_stdin(&null);
        let _ = rustix::stdio::dup2_stdout(&null);
        let _ = rustix::stdio::dup2_stderr(&null);
    }
}

/// Replaces this process's view of the files.
fn build(view: &View) -> Result<(), RoomError> {
    let root = view.folder;
    let nothing = MountPropagationFlags::REC | MountPropagationFlags::PRIVATE;
    mount_change("/", nothing).map_err(at("a view of its own"))?;
    in_memory(root, 1 << 20)?;
    let mut paths: Vec<PathBuf> = view.readable.to_vec();
    paths.extend(view.readable.iter().filter_map(|path| path.canonicalize().ok()));
    paths.extend_from_slice(view.devices);
    // Those that contain others come first.
    paths.sort();
    paths.dedup();
    let mut bound: Vec<PathBuf> = Vec::new();
    for path in paths {
        let there = path.starts_with("/proc") || bound.iter().any(|other| path.starts_with(other));
        if !there && bind(&path, root)? {
            bound.push(path);
        }
    }
    let folder = within(root, view.folder);
    create_dir_all(&folder).map_err(at("a place for its folder"))?;
    let processes = root.join("proc");
    create_dir_all(&processes).map_err(at("a place for /proc"))?;
    sys::make_read_only(root).map_err(at("a view that cannot be changed"))?;
    in_memory(&folder, view.size)?;
    let flags = MountFlags::NOSUID | MountFlags::NODEV | MountFlags::NOEXEC | MountFlags::RDONLY;
    // A container that hides parts of /proc allows no new one. The old one shows no more than its own: that
    // is up to Landlock.
    if mount("proc", &processes, "proc", flags, None).is_err() {
        mount_bind_recursive("/proc", &processes).map_err(at("/proc"))?;
    }
    rustix::process::chdir(root).map_err(at("the new root"))?;
    rustix::process::pivot_root(".", ".").map_err(at("the new root"))?;
    unmount(".", UnmountFlags::DETACH).map_err(at("the old root"))?;
    rustix::process::chdir("/").map_err(at("the new root"))
}

/// The place of an absolute path in another root.
fn within(root: &Path, path: &Path) -> PathBuf {
    root.join(path.strip_prefix("/").unwrap_or(path))
}

/// Shows a path in the new root; false if there is none.
fn bind(path: &Path, root: &Path) -> Result<bool, RoomError> {
    let Ok(meta) = path.metadata() else { return Ok(false) };
    let place = within(root, path);
    let made = if meta.is_dir() {
        create_dir_all(&place)
    } else {
        place.parent().map_or(Ok(()), create_dir_all).and_then(|()| File::create(&place).map(drop))
    };
    made.map_err(at(format!("a place for {}", path.display())))?;
    mount_bind_recursive(path, &place).map_err(at(path.display().to_string()))?;
    Ok(true)
}

/// A file system in memory of limited size, bytes.
fn in_memory(place: &Path, size: u64) -> Result<(), RoomError> {
    let options = format!("size={size},nr_inodes={MOST_FILES},mode=700");
    let options = std::ffi::CString::new(options).unwrap_or_default();
    let flags = MountFlags::NOSUID | MountFlags::NODEV;
    mount("tmpfs", place, "tmpfs", flags, options.as_c_str()).map_err(at("a folder of limited size"))
}
