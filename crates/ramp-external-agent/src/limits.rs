//! How much an agent may send, how long it may take, and in a sandbox how much of the machine it may use.

use std::time::{Duration, Instant};

/// The most periods that one message may ask for: ten seconds.
pub const MOST_PERIODS: u64 = 10_000;
/// The most messages in a row between which the robot does not move.
pub const MOST_IDLE: u32 = 10_000;

/// How patient one is with an agent.
#[derive(Clone, Copy, Debug)]
pub struct Patience {
    /// Longest time from an answer to the agent's next message, and for it to read an answer.
    pub answer: Duration,
    /// When the episode has to be over, whatever the agent does.
    pub end: Option<Instant>,
}

/// The resources that an agent in a sandbox may use, together with all processes that it has started.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Allowance {
    /// Memory, bytes: enough for a policy of a few hundred million parameters.
    pub memory: u64,
    /// Processes and threads: enough for a library of mathematics with a thread for each processor.
    pub tasks: usize,
    /// Files in its own folder, bytes.
    pub disk: u64,
}

impl Default for Allowance {
    fn default() -> Allowance {
        Allowance { memory: 8 << 30, tasks: 512, disk: 2 << 30 }
    }
}
