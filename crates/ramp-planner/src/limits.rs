//! What rules of strangers may cost: memory and time.
//!
//! Rules can be so written that they never end, and a watch keeps them from taking the machine with them. It is a thread
//! that looks at the whole process, because nothing else covers all of it: clingo cannot be interrupted while it grounds,
//! a domain of the action language grows before clingo sees it, and a run plans again in the middle of its work, where no
//! other process could take over. What has no way back can only end with the process. So the watch does not stop
//! anything itself: it hands over what was too much to the function of whoever set the limits, and that ends the
//! process.
//!
//! A plan does not depend on the limits: within them it is the same on every machine, beyond them there is none.

use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How often the watch looks.
const LOOK: Duration = Duration::from_millis(10);

/// How much memory and time rules may take.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Memory that one plan may take in addition to what the process has, bytes. Watched on Linux only.
    pub memory: u64,
    /// How long one plan may take, on the wall.
    pub time: Duration,
    /// How long one plan with the proof that no other is shorter may take, on the wall.
    pub proof: Duration,
    /// Gets what was too much, on a thread of its own, while the rules are still at work. It has to end the process.
    pub exceeded: fn(&Exceeded),
}

impl Limits {
    /// The limits of the program. The built-in rules take 20 MB and 0.2 s for the largest of the nine goals; the
    /// proof for hard-2 takes 60 MB and a minute.
    pub const fn new(exceeded: fn(&Exceeded)) -> Limits {
        Limits { memory: 1 << 30, time: Duration::from_secs(60), proof: Duration::from_secs(1200), exceeded }
    }

    /// Watches this process until the watch is dropped; `files` are the rules that are at work.
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

/// Watches this process while rules are at work.
#[derive(Debug)]
pub struct Watch {
    /// Dropped, it ends the thread.
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

/// Rules took more than they may.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, miette::Diagnostic)]
#[error("planning was ended because the rules took {limit}: {files}")]
#[diagnostic(help(
    "make the rules or the goal smaller, or look for a rule that never ends; `ramp plan GOAL --pddl DIR` and `--emit-asp` \
     write the problem for other planners"
))]
pub struct Exceeded {
    /// The rule files.
    pub files: String,
    /// Which limit.
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

/// Memory that this process may write to, also where the system has put it on the disk; bytes. None where the system
/// does not tell.
fn taken() -> u64 {
    let text = std::fs::read_to_string(Path::new("/proc/self/statm")).unwrap_or_default();
    let pages = text.split(' ').nth(5).and_then(|pages| pages.parse::<u64>().ok()).unwrap_or(0);
    pages * rustix::param::page_size() as u64
}
