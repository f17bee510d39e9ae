//! Holds an agent's processes still while the twin works.
//!
//! A real robot moves by the clock on the wall, and an agent may think meanwhile. The twin stops that clock
//! while it computes. An agent that went on thinking then would think for nothing, and would take processors
//! from the twin. So its processes stand still during an image, and as soon as the twin has taken longer for
//! a motion than the robot.

use std::time::Instant;

use rustix::process::{Pid, Signal, kill_process};

use crate::family::descendants;

/// How far robot time may be ahead of the time that the twin took, s. What is ahead more is lost: an agent
/// cannot save it for later.
const MOST_AHEAD: f64 = 0.1;
/// Looks for processes that others have just started.
const MOST_LOOKS: usize = 100;

/// Processes that stand still until this is dropped.
#[derive(Debug)]
struct Still(Vec<i32>);

impl Still {
    /// Stops all children of this process but those in `before`, with all that they have started.
    fn hold(before: &[i32]) -> Still {
        let mut stopped = Vec::new();
        // A process that is being started while its parent is stopped is found by the next look.
        for _ in 0..MOST_LOOKS {
            let family = descendants(before);
            let more: Vec<i32> = family.into_iter().filter(|it| !stopped.contains(it)).collect();
            if more.is_empty() {
                break;
            }
            send(&more, Signal::STOP);
            stopped.extend(more);
        }
        Still(stopped)
    }
}

impl Drop for Still {
    fn drop(&mut self) {
        send(&self.0, Signal::CONT);
    }
}

fn send(processes: &[i32], signal: Signal) {
    for process in processes.iter().filter_map(|it| Pid::from_raw(*it)) {
        let _ = kill_process(process, signal);
    }
}

/// Decides when an agent's processes stand still. All times in s.
#[derive(Debug)]
pub(crate) struct Pace {
    /// Robot time less the twin's time, up to the last call.
    ahead: f64,
    /// The begin of the call, on the wall and of the robot.
    begin: (Instant, f64),
    /// The processes that stand still now, and the twin's time before.
    still: Option<(Still, f64)>,
}

impl Pace {
    /// At the begin of an episode.
    pub(crate) fn new() -> Pace {
        Pace { ahead: MOST_AHEAD, begin: (Instant::now(), 0.0), still: None }
    }

    /// A call begins at a robot time. With `always` the processes stand still from its begin.
    pub(crate) fn begin(&mut self, robot: f64, always: bool, before: &[i32]) {
        self.begin = (Instant::now(), robot);
        if always {
            self.still = Some((Still::hold(before), 0.0));
        }
        self.check(robot, before);
    }

    /// The call goes on, at a robot time.
    pub(crate) fn check(&mut self, robot: f64, before: &[i32]) {
        let taken = self.begin.0.elapsed().as_secs_f64();
        if self.still.is_none() && self.ahead + robot - self.begin.1 < taken {
            self.still = Some((Still::hold(before), taken));
        }
    }

    /// The call ends at a robot time, and the agent goes on.
    pub(crate) fn end(&mut self, robot: f64) {
        let taken = match self.still.take() {
            Some((_, taken)) => taken,
            None => self.begin.0.elapsed().as_secs_f64(),
        };
        self.ahead = (self.ahead + robot - self.begin.1 - taken).min(MOST_AHEAD);
    }
}
