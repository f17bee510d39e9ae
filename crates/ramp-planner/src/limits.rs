//! Memory and time limits for untrusted rules.
//!
//! Rules may never terminate, so a watchdog thread monitors the whole process. Nothing smaller
//! would do. clingo cannot be interrupted while it grounds, a domain of the action language grows
//! before clingo sees it, and a run replans in the middle of its work, where no other process could
//! take over. A computation that cannot be interrupted can only end with its process. So the
//! watchdog stops nothing itself: it passes the exceeded limit to the caller's function, which ends
//! the process.
//!
//! A plan does not depend on the limits: within them it is the same on every machine, beyond them
//! there is none.

use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Period of the checks.
const LOOK: Duration = Duration::from_millis(10);

/// Memory and time limits of the rules.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Memory of one plan in addition to the process's current memory, bytes. Checked on Linux
    /// only.
    pub memory: u64,
    /// Wall-clock time of one plan.
    pub time: Duration,
    /// Wall-clock time of one plan with the proof that it is the shortest.
    pub proof: Duration,
    /// Receives the exceeded limit on a thread of its own, while the rules are still running. It
    /// must end the process.
    pub exceeded: fn(&Exceeded),
}

impl Limits {
    /// The limits of the program. The built-in rules need 20 MB and 0.2 s for the largest of the
    /// nine goals; the proof for hard-2 needs 60 MB and a minute.
    pub const fn new(exceeded: fn(&Exceeded)) -> Limits {
        Limits { memory: 1 << 30, time: Duration::from_secs(60), proof: Duration::from_secs(1200), exceeded }
    }

    /// Monitors this process until the watch is dropped; `files` are the rules in use.
    pub fn watch(&self, files: Vec<String>) -> Watch {
        self.watch_for(files, self.time)
    }

    pub(crate) fn watch_for(&self, files: Vec<String>, time: Duration) -> Watch {
        let Limits { memory, exceeded, .. } = *self;
        let begin = Instant::now();
        let before = taken();
        let (end, ended) = channel();
        let thread = std::thread::spawn(move || {
            while ended.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
                let limit = if taken().saturating_sub(before) > memory {
                    Limit::Memory(memory)
                } else if begin.elapsed() > time {
                    Limit::Time(time)
                } else {
                    continue;
                };
                return exceeded(&Exceeded { files: files.join(", "), limit });
            }
        });
        Watch { end: Some(end), thread: Some(thread) }
    }
}

/// Monitors this process while rules are in use.
#[derive(Debug)]
pub struct Watch {
    /// Dropping it ends the thread.
    end: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.end.take();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// The rules exceeded a limit.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, miette::Diagnostic)]
#[error("planning was ended because the rules took {limit}: {files}")]
#[diagnostic(help(
    "make the rules or the goal smaller, or look for a rule that never ends; `ramp plan GOAL --pddl DIR` and `--emit-asp` \
     write the problem for other planners"
))]
pub struct Exceeded {
    /// The rule files.
    pub files: String,
    /// The limit.
    pub limit: Limit,
}

/// A limit that was exceeded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Limit {
    /// Of memory, bytes.
    #[error("more than {} MiB of memory", .0 >> 20)]
    Memory(u64),
    /// Of time.
    #[error("more than {} s", .0.as_secs_f64())]
    Time(Duration),
}

/// Writable memory of this process, including swapped memory, bytes. 0 where the system does not
/// report it.
fn taken() -> u64 {
    let text = std::fs::read_to_string(Path::new("/proc/self/statm")).unwrap_or_default();
    let pages = text.split(' ').nth(5).and_then(|pages| pages.parse::<u64>().ok()).unwrap_or(0);
    pages * rustix::param::page_size() as u64
}
