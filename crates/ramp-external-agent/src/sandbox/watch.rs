//! Watches what an agent uses together with all that it has started, and ends them when it is too much.

use std::collections::HashSet;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use crate::family::{descendants, kill};

use crate::limits::Allowance;

/// Time between two looks.
const EVERY: Duration = Duration::from_millis(100);
/// The disk is looked at once in so many looks.
const DISK_EVERY: u32 = 10;
/// Files that are counted; who makes more has used too much of the disk as well.
const MOST_FILES: usize = 100_000;

/// A thread that watches.
#[derive(Debug)]
pub(crate) struct Watch {
    ended: Arc<AtomicBool>,
    found: Arc<Mutex<Option<String>>>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Watch {
    /// Watches all children of this process but those in `before`, and what is in a folder. `own` of the
    /// processes are not the agent's.
    pub(crate) fn begin(allowance: Allowance, own: usize, folder: PathBuf, before: Vec<i32>) -> Watch {
        let (ended, found) = (Arc::new(AtomicBool::new(false)), Arc::new(Mutex::new(None)));
        let (stop, tell) = (ended.clone(), found.clone());
        let thread = std::thread::spawn(move || {
            for look in 0_u32.. {
                if stop.load(Ordering::Relaxed) {
                    return;
                }
                let disk = look.is_multiple_of(DISK_EVERY);
                if let Some(what) = too_much(allowance, own, &before, disk.then_some(folder.as_path())) {
                    *tell.lock().unwrap_or_else(PoisonError::into_inner) = Some(what);
                    end(&before);
                    return;
                }
                std::thread::sleep(EVERY);
            }
        });
        Watch { ended, found, thread: Some(thread) }
    }

    /// Why the agent was ended, if it was.
    pub(crate) fn found(&self) -> Option<String> {
        self.found.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Ends all but the processes in `before`. One that starts others faster than they end is met again.
fn end(before: &[i32]) {
    for _ in 0..100 {
        let family = descendants(before);
        if family.iter().all(|process| resident(*process) == 0) {
            return;
        }
        kill(&family);
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// The exceeded allowance, in words.
fn too_much(allowance: Allowance, own: usize, before: &[i32], folder: Option<&Path>) -> Option<String> {
    let family = descendants(before);
    let mut tasks = 0;
    for process in &family {
        tasks += threads(*process);
        if tasks > allowance.tasks + own {
            return Some(format!("had more than {} processes and threads", allowance.tasks));
        }
    }
    let memory: u64 = family.iter().map(|process| resident(*process)).sum();
    if memory > allowance.memory {
        return Some(format!("used more than {} MiB of memory", allowance.memory >> 20));
    }
    let full = folder.is_some_and(|folder| disk(folder) + unlinked(&family) > allowance.disk);
    full.then(|| format!("wrote more than {} MiB", allowance.disk >> 20))
}

/// The threads of a process; one for a process that is gone.
fn threads(process: i32) -> usize {
    let text = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    // The name, in brackets, may hold spaces.
    let fields = text.rsplit_once(')').map_or("", |(_, fields)| fields);
    fields.split_whitespace().nth(17).and_then(|it| it.parse().ok()).unwrap_or(1)
}

/// Bytes of the files that processes hold open and that have no name any more.
fn unlinked(family: &[i32]) -> u64 {
    let mut seen = HashSet::new();
    let mut sum = 0_u64;
    for process in family {
        let open = std::fs::read_dir(format!("/proc/{process}/fd"));
        for entry in open.into_iter().flatten().flatten() {
            let Ok(meta) = std::fs::metadata(entry.path()) else { continue };
            if meta.is_file() && meta.nlink() == 0 && seen.insert((meta.dev(), meta.ino())) {
                sum = sum.saturating_add(meta.blocks() * 512);
            }
        }
    }
    sum
}

/// Memory of a process that is not in files, bytes; none of one that is gone.
fn resident(process: i32) -> u64 {
    let text = std::fs::read_to_string(format!("/proc/{process}/statm")).unwrap_or_default();
    let field = |index: usize| text.split(' ').nth(index).and_then(|it| it.parse::<u64>().ok());
    let pages = field(1).unwrap_or(0).saturating_sub(field(2).unwrap_or(0));
    pages * rustix::param::page_size() as u64
}

/// Bytes in a folder and in all below it.
fn disk(folder: &Path) -> u64 {
    let mut sum = 0;
    let mut files = 0;
    let mut open = vec![folder.to_path_buf()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            files += 1;
            if files > MOST_FILES {
                return u64::MAX / 2;
            }
            // Of a link its own size, not that of what it points to.
            let Ok(meta) = entry.metadata() else { continue };
            if meta.is_dir() {
                open.push(entry.path());
            }
            sum += meta.blocks() * 512;
        }
    }
    sum
}
