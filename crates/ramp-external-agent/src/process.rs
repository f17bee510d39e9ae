//! The process of an agent: started in a group of its own, listened and talked to with limits, and ended with
//! all that it has started.

use std::ffi::OsString;
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal};

use crate::family::{children, end_orphans, time_of_ended};
use crate::limits::Patience;
use crate::protocol::LONGEST_MESSAGE;
use crate::sandbox::{Sandbox, Watch};
use crate::words::pass_on;

/// How long an agent may take to be gone after it was told the end.
const FAREWELL: Duration = Duration::from_secs(1);

/// Why nothing more is heard from an agent.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Silence {
    /// It does not answer.
    #[error("the agent sent nothing for {seconds} s")]
    Hangs {
        /// s.
        seconds: String,
    },
    /// It does not listen.
    #[error("the agent did not read its answer for {seconds} s")]
    Deaf {
        /// s.
        seconds: String,
    },
    /// The wall's clock is over.
    #[error("the agent was not done when the episode's time on the wall was over")]
    Late,
    /// It sends a line without an end.
    #[error("the agent sent a line of more than {LONGEST_MESSAGE} bytes")]
    Endless,
    /// It is no more.
    #[error("the agent {how}")]
    Ended {
        /// In words.
        how: String,
    },
}

/// A message of the listening thread.
enum Heard {
    Line(Vec<u8>),
    Endless,
    /// The end, or an error, which is the end as well.
    End,
}

/// A child process and the threads that talk to it.
pub struct Process {
    child: Child,
    group: Option<Pid>,
    patience: Patience,
    heard: Receiver<Heard>,
    to_say: Option<SyncSender<Vec<u8>>>,
    said: Receiver<bool>,
    /// Children of this process that were there before.
    before: Vec<i32>,
    /// Whether it was told the end, and gets a moment to go by itself.
    dismissed: bool,
    /// The watch over its resources, in a sandbox.
    watch: Option<Watch>,
    /// Processor time of the children that had ended before it began, s.
    time_before: f64,
    /// Its processor time, s, once it has ended.
    time: Option<f64>,
}

impl Process {
    /// Starts a program with pipes to its standard input and output. What it uses is watched where there is a
    /// sandbox; that `command` puts up the walls is up to the caller.
    pub fn start(
        command: &[OsString],
        patience: Patience,
        sandbox: Option<&Sandbox>,
    ) -> std::io::Result<Process> {
        let (program, arguments) =
            command.split_first().ok_or_else(|| std::io::Error::from(std::io::ErrorKind::InvalidInput))?;
        let before = children();
        let time_before = time_of_ended();
        let mut child = Command::new(program)
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .process_group(0)
            .spawn()?;
        let group = i32::try_from(child.id()).ok().and_then(Pid::from_raw);
        let (hear, heard) = sync_channel(1);
        let (to_say, say) = sync_channel::<Vec<u8>>(1);
        let (answer, said) = sync_channel(1);
        if let Some(output) = child.stdout.take() {
            std::thread::spawn(move || listen(output, &hear));
        }
        if let Some(mut input) = child.stdin.take() {
            std::thread::spawn(move || {
                for bytes in say {
                    let done = input.write_all(&bytes).and_then(|()| input.flush()).is_ok();
                    if answer.send(done).is_err() || !done {
                        break;
                    }
                }
            });
        }
        if let Some(words) = child.stderr.take() {
            std::thread::spawn(move || pass_on(words, std::io::stderr()));
        }
        let watch = sandbox.map(|sandbox| sandbox.watch(before.clone()));
        let (to_say, dismissed) = (Some(to_say), false);
        Ok(Process {
            child,
            group,
            patience,
            heard,
            to_say,
            said,
            before,
            dismissed,
            watch,
            time_before,
            time: None,
        })
    }

    /// How long is waited now, and whether that is less than the agent's own time.
    fn wait(&self) -> (Duration, bool) {
        let left = self.patience.end.map(|end| end.saturating_duration_since(Instant::now()));
        match left {
            Some(left) if left < self.patience.answer => (left, true),
            _ => (self.patience.answer, false),
        }
    }

    fn seconds(&self) -> String {
        self.patience.answer.as_secs_f64().to_string()
    }

    /// The next line, without its end.
    pub fn hear(&mut self) -> Result<Vec<u8>, Silence> {
        let (wait, late) = self.wait();
        match self.heard.recv_timeout(wait) {
            Ok(Heard::Line(line)) => Ok(line),
            Ok(Heard::Endless) => Err(Silence::Endless),
            Ok(Heard::End) | Err(RecvTimeoutError::Disconnected) => Err(self.how_it_ended()),
            Err(RecvTimeoutError::Timeout) if self.was_ended() => Err(self.how_it_ended()),
            Err(RecvTimeoutError::Timeout) if late => Err(Silence::Late),
            Err(RecvTimeoutError::Timeout) => Err(Silence::Hangs { seconds: self.seconds() }),
        }
    }

    /// Writes to the agent, and waits until it has taken it.
    pub fn tell(&mut self, bytes: Vec<u8>) -> Result<(), Silence> {
        // The channel is empty: the last answer was taken.
        let sent = self.to_say.as_ref().is_some_and(|to_say| to_say.send(bytes).is_ok());
        if !sent {
            return Err(self.how_it_ended());
        }
        let (wait, late) = self.wait();
        match self.said.recv_timeout(wait) {
            Ok(true) => Ok(()),
            Ok(false) | Err(RecvTimeoutError::Disconnected) => Err(self.how_it_ended()),
            Err(RecvTimeoutError::Timeout) if self.was_ended() => Err(self.how_it_ended()),
            Err(RecvTimeoutError::Timeout) if late => Err(Silence::Late),
            Err(RecvTimeoutError::Timeout) => Err(Silence::Deaf { seconds: self.seconds() }),
        }
    }

    /// Whether it was ended for what it used. A process that outlives it may still hold its pipe open.
    fn was_ended(&self) -> bool {
        self.watch.as_ref().is_some_and(|watch| watch.found().is_some())
    }

    /// The end of an agent that closed a pipe, or that was ended.
    fn how_it_ended(&mut self) -> Silence {
        let status = self.wait_for_end(FAREWELL);
        if let Some(how) = self.watch.as_ref().and_then(Watch::found) {
            return Silence::Ended { how };
        }
        let how = match status {
            Some(status) => match (status.signal(), status.code()) {
                (Some(signal), _) => format!("was killed by signal {signal}"),
                (None, Some(0)) => "ended without saying that it is done".to_string(),
                (None, code) => format!("crashed: it ended with status {}", code.unwrap_or(-1)),
            },
            None => "closed its pipe without saying that it is done".to_string(),
        };
        Silence::Ended { how }
    }

    /// Whether it has ended by itself, with status 0.
    pub(crate) fn ended_well(&mut self) -> bool {
        !self.was_ended() && self.wait_for_end(FAREWELL).is_some_and(|status| status.success())
    }

    fn wait_for_end(&mut self, longest: Duration) -> Option<ExitStatus> {
        let begin = Instant::now();
        loop {
            match self.child.try_wait() {
                Ok(Some(status)) => return Some(status),
                Ok(None) if begin.elapsed() < longest => std::thread::sleep(Duration::from_millis(5)),
                _ => return None,
            }
        }
    }

    /// Tells the agent the end, if it listens: it gets a moment to go by itself.
    pub fn dismiss(&mut self, bytes: Vec<u8>) {
        self.dismissed = self.tell(bytes).is_ok();
    }

    /// Ends the agent and all that it has started.
    pub fn end(&mut self) {
        self.watch = None;
        // With this its standard input is at an end.
        self.to_say = None;
        if self.dismissed {
            self.wait_for_end(FAREWELL);
        }
        if let Some(group) = self.group {
            let _ = rustix::process::kill_process_group(group, Signal::KILL);
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
        end_orphans(&self.before);
        self.time.get_or_insert(time_of_ended() - self.time_before);
    }

    /// Processor time of all its processes, s, once it has ended. A process whose parent ignored its end is
    /// not counted.
    pub fn time(&self) -> Option<f64> {
        self.time
    }

    /// Children of this process that were there before the agent.
    pub(crate) fn before(&self) -> &[i32] {
        &self.before
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.end();
    }
}

/// Takes in lines of limited length, one ahead at most.
fn listen(output: impl Read, hear: &SyncSender<Heard>) {
    let mut output = BufReader::new(output);
    loop {
        let mut line = Vec::new();
        let limit = LONGEST_MESSAGE as u64 + 1;
        let heard = match output.by_ref().take(limit).read_until(b'\n', &mut line) {
            Ok(_) if line.last() == Some(&b'\n') => {
                line.pop();
                Heard::Line(line)
            }
            Ok(length) if length as u64 == limit => Heard::Endless,
            _ => Heard::End,
        };
        let last = !matches!(heard, Heard::Line(_));
        if hear.send(heard).is_err() || last {
            return;
        }
    }
}
