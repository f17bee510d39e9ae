//! Runs of this program on a cluster. An engine spreads them: the Python package drives it
//! (`python3 -m ramp.ray`), and this starts that module and talks to it over its standard input and output.
//!
//! A message is a line of JSON, and the bytes whose lengths it tells. The module ends when its input closes.

mod attachments;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, Write};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::process::{Child, ChildStdin, ChildStdout, ExitStatus, Stdio};
use std::str::FromStr;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use miette::{Report, miette};
use serde::{Deserialize, Serialize};
use serde_json::json;

pub use self::attachments::{Attachments, LARGEST as LARGEST_ATTACHMENTS};
use crate::command::python::{self, RAY};
use crate::software::software;
use crate::status::MachineFault;

/// Longest line of a message, bytes.
const LONGEST_LINE: u64 = 1 << 20;
/// Largest file that a worker may send, bytes.
const LARGEST: usize = 1 << 30;
/// Interval at which a request to end is looked for.
const LOOK: Duration = Duration::from_millis(50);
/// Time that the module has to end by itself.
const PATIENCE: Duration = Duration::from_secs(20);
/// Length of the end of the module's standard error that is shown when it fails, bytes.
const LAST_WORDS: usize = 400;

/// The engine that runs the episodes, as on the command line.
#[derive(Clone, Debug, Serialize)]
pub struct Backend {
    /// Address of a cluster of Ray. Without one, it is the cluster that runs here, or a new one.
    address: Option<String>,
}

impl FromStr for Backend {
    type Err = String;

    fn from_str(text: &str) -> Result<Backend, String> {
        match text.split_once(':') {
            None if text == "ray" => Ok(Backend { address: None }),
            Some(("ray", address)) if !address.is_empty() => {
                Ok(Backend { address: Some(address.to_string()) })
            }
            _ => Err("`ray` or `ray:ADDRESS` is expected".to_string()),
        }
    }
}

/// A run of this program on a worker, in a folder of its own.
#[derive(Serialize)]
pub struct Job {
    /// Its arguments. Files go to the folder `out`, from which all come back.
    pub words: Vec<String>,
    /// The files and folders that they name, as they are packed.
    pub files: Vec<String>,
    /// Time that it has on the worker, s.
    pub limit: f64,
}

/// The outcome of a job.
pub enum Answer {
    /// It has ended.
    Ended(Box<Ended>),
    /// Its worker was lost again and again, with the reason.
    Lost(String),
}

/// A job that has ended.
pub struct Ended {
    /// How; `None` if it was stopped after its time.
    pub status: Option<ExitStatus>,
    /// Time that it took on the worker.
    pub took: Duration,
    /// Its standard output.
    pub printed: Vec<u8>,
    /// Its standard error.
    pub told: Vec<u8>,
    /// The files of its folder `out`, by name.
    pub files: BTreeMap<String, Vec<u8>>,
}

/// A message of the module.
#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Message {
    /// The cluster is there, and has so many processors.
    Ready { processors: usize },
    /// The cluster, or a job, is refused.
    Refused { why: String },
    /// A node has failed, and with it all.
    Failed { why: String },
    /// A job has ended; then come the bytes of its standard output and error, and of its files.
    Ended {
        job: usize,
        status: Option<i32>,
        took: f64,
        printed: usize,
        told: usize,
        files: BTreeMap<String, usize>,
    },
    /// The worker of a job was lost.
    Lost { job: usize, why: String },
}

/// A message with the bytes that came after it.
struct Received {
    message: Message,
    printed: Vec<u8>,
    told: Vec<u8>,
    files: BTreeMap<String, Vec<u8>>,
}

/// A cluster, and the process that drives it. The process ends with this value.
pub struct Engine {
    child: Child,
    input: Option<ChildStdin>,
    received: Receiver<std::io::Result<Received>>,
    errors: File,
    /// Number of processors of the cluster.
    pub processors: usize,
}

impl Backend {
    /// Checks that the Python package is there, with the extra.
    ///
    /// # Errors
    /// If it is not.
    pub fn check(&self) -> Result<(), Report> {
        python::command(&RAY).map(drop)
    }
}

impl Engine {
    /// Connects to the cluster.
    ///
    /// # Errors
    /// If the Python package or the cluster is not there.
    pub fn start(backend: &Backend) -> Result<Engine, Report> {
        let errors = tempfile::tempfile().map_err(MachineFault::of)?;
        let mut command = python::command(&RAY)?;
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        command.stderr(errors.try_clone().map_err(MachineFault::of)?);
        // Ctrl-C on a terminal reaches only this process, which then ends the other.
        command.process_group(0);
        let mut child = command.spawn().map_err(MachineFault::of)?;
        let (sender, received) = channel();
        if let Some(output) = child.stdout.take() {
            std::thread::spawn(move || {
                let mut output = BufReader::new(output);
                loop {
                    let next = receive(&mut output);
                    let ended = next.is_err();
                    if sender.send(next).is_err() || ended {
                        return;
                    }
                }
            });
        }
        let input = child.stdin.take();
        let mut engine = Engine { child, input, received, errors, processors: 1 };
        let software = software();
        let program = format!("ramp {} ({})", software.version, software.commit);
        engine.send(&json!({"address": backend.address, "program": program}).to_string())?;
        match engine.next(&|| crate::ending::requested().is_some())?.map(|it| it.message) {
            Some(Message::Ready { processors }) => engine.processors = processors.max(1),
            Some(Message::Refused { why }) => return Err(miette!("{why}")),
            None => return Err(miette!("stopped before the cluster was there")),
            Some(_) => return Err(engine.fault("an answer to nothing")),
        }
        Ok(engine)
    }

    /// Runs jobs, and calls `each` with the number of each as it is finished. Returns false if `stopped` has
    /// ended it.
    ///
    /// # Errors
    /// If a node has another build or fails, the module fails, a file cannot be read, or as `each`.
    pub fn run(
        &mut self,
        attachments: &Attachments,
        jobs: &[Job],
        stopped: &dyn Fn() -> bool,
        each: &mut dyn FnMut(usize, Answer) -> Result<(), Report>,
    ) -> Result<bool, Report> {
        let files = attachments.read()?;
        let packed: Vec<_> = files.iter().map(|(packed, _)| packed).collect();
        self.send(&json!({"files": packed, "jobs": jobs}).to_string())?;
        for (_, bytes) in &files {
            self.write(bytes)?;
        }
        for _ in 0..jobs.len() {
            let Some(received) = self.next(stopped)? else { return Ok(false) };
            let Received { message, printed, told, files } = received;
            match message {
                Message::Ended { job, status, took, .. } if job < jobs.len() => {
                    let status = status.map(status_of);
                    let took = Duration::try_from_secs_f64(took).unwrap_or_default();
                    each(job, Answer::Ended(Box::new(Ended { status, took, printed, told, files })))?;
                }
                Message::Lost { job, why } if job < jobs.len() => each(job, Answer::Lost(why))?,
                Message::Refused { why } => return Err(miette!("{why}")),
                Message::Failed { why } => return Err(MachineFault { what: why }.into()),
                _ => return Err(self.fault("an answer to nothing")),
            }
        }
        Ok(true)
    }

    /// The next message; `None` if `stopped` comes first.
    fn next(&mut self, stopped: &dyn Fn() -> bool) -> Result<Option<Received>, Report> {
        loop {
            if stopped() {
                return Ok(None);
            }
            match self.received.recv_timeout(LOOK) {
                Ok(Ok(received)) => return Ok(Some(received)),
                Ok(Err(error)) => return Err(self.fault(&error.to_string())),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Err(self.fault("no answer")),
            }
        }
    }

    fn send(&mut self, line: &str) -> Result<(), Report> {
        self.write(format!("{line}\n").as_bytes())
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), Report> {
        let written = match &mut self.input {
            Some(input) => input.write_all(bytes).and_then(|()| input.flush()),
            None => Ok(()),
        };
        written.map_err(|error| self.fault(&error.to_string()))
    }

    /// Ends the module: by itself, or after a while.
    fn end(&mut self) {
        self.input = None;
        let begin = Instant::now();
        while begin.elapsed() < PATIENCE && matches!(self.child.try_wait(), Ok(None)) {
            std::thread::sleep(LOOK);
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }

    /// The fault of a module that has ended, or says what cannot be.
    fn fault(&mut self, what: &str) -> Report {
        // Its last words are there when it has ended.
        self.end();
        let mut text = String::new();
        let mut bytes = Vec::new();
        if self.errors.rewind().is_ok() && self.errors.read_to_end(&mut bytes).is_ok() {
            text = String::from_utf8_lossy(&bytes[bytes.len().saturating_sub(LAST_WORDS)..]).into_owned();
        }
        let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
        MachineFault { what: format!("`python3 -m {}` has failed: {what}: {words}", RAY.name) }.into()
    }
}

impl Drop for Engine {
    fn drop(&mut self) {
        self.end();
    }
}

/// Reads a message and the bytes after it.
fn receive(input: &mut BufReader<ChildStdout>) -> std::io::Result<Received> {
    let mut line = String::new();
    input.take(LONGEST_LINE).read_line(&mut line)?;
    if line.is_empty() {
        return Err(std::io::Error::other("it has ended"));
    }
    let message: Message = serde_json::from_str(&line).map_err(std::io::Error::other)?;
    let (mut printed, mut told, mut files) = (Vec::new(), Vec::new(), BTreeMap::new());
    if let Message::Ended { printed: first, told: second, files: others, .. } = &message {
        printed = bytes(input, *first)?;
        told = bytes(input, *second)?;
        for (name, length) in others {
            files.insert(name.clone(), bytes(input, *length)?);
        }
    }
    Ok(Received { message, printed, told, files })
}

/// Reads so many bytes.
fn bytes(input: &mut impl Read, length: usize) -> std::io::Result<Vec<u8>> {
    if length > LARGEST {
        return Err(std::io::Error::other(format!("a file of {length} bytes is too large")));
    }
    let mut bytes = vec![0; length];
    input.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// The status of a process from Python's return code, which is negative for a signal.
fn status_of(code: i32) -> ExitStatus {
    ExitStatus::from_raw(if code < 0 { -code } else { code << 8 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_backend_is_ray_with_or_without_an_address() {
        let address = |text: &str| text.parse::<Backend>().map(|backend| backend.address);
        assert_eq!(address("ray"), Ok(None));
        assert_eq!(address("ray:10.0.0.1:6379"), Ok(Some("10.0.0.1:6379".to_string())));
        for wrong in ["", "ray:", "rays", "dask", "dask:1"] {
            assert!(address(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_return_code_is_a_status_or_a_signal() {
        assert_eq!(status_of(2).code(), Some(2));
        assert_eq!(status_of(-9).signal(), Some(9));
    }
}
