//! Reads a log from an untrusted file: the outcome is a log, or one message that says what is
//! wrong.

use std::collections::BTreeMap;
use std::path::Path;

use ramp_kit::source::{MAX_SENTENCE, plain, shorten};
use ramp_result::episode::{self, EpisodeResult};
use ramp_result::sha256;

use crate::calls::Decoder;
use crate::error::LogError;
use crate::header::{CALLS, Header, SCHEMA};
use crate::records::{Channel, Limits, Record, Wrong, bytes_of, size, walk};

/// An episode's log.
#[derive(Clone, Debug)]
pub struct Log {
    /// The sources of the episode.
    pub header: Header,
    /// The result in the log; its `log` is `None`.
    pub result: EpisodeResult,
    /// SHA-256 of the file, in hex.
    pub sha256: String,
    calls: Vec<u8>,
}

impl Log {
    /// Reads a file.
    ///
    /// # Errors
    /// When it cannot be read or is not a log.
    pub fn read(path: &Path) -> Result<Log, LogError> {
        let limits = Limits::default();
        Log::from_bytes(path, &bytes_of(path, &limits)?, &limits)
    }

    /// Reads a log from a file's bytes; `path` is its name in messages.
    ///
    /// # Errors
    /// When they are not a log, or exceed a limit.
    pub fn from_bytes(path: &Path, bytes: &[u8], limits: &Limits) -> Result<Log, LogError> {
        let mut parts = Parts::default();
        parts.collect(bytes, limits).map_err(|wrong| wrong.at(path))?;
        parts.log(sha256(bytes)).map_err(|what| LogError::Other { path: path.to_path_buf(), what })
    }

    /// The calls of the agent, in order.
    pub fn calls(&self) -> Decoder<'_> {
        Decoder::new(&self.calls)
    }

    /// SHA-256 of the bytes of the calls, in hex: two episodes of one goal, seed and track that share it were
    /// driven alike, to the last bit.
    pub fn calls_sha256(&self) -> String {
        sha256(&self.calls)
    }
}

/// The parts of a file.
#[derive(Default)]
struct Parts {
    /// Topics of the channels, by number.
    channels: BTreeMap<u16, Topic>,
    /// Whether it has the channel of a run over the wire, or of a lab's cameras.
    real_run: bool,
    header: Option<Header>,
    result: Option<EpisodeResult>,
    calls: Vec<u8>,
}

#[derive(Clone, Copy, PartialEq)]
enum Topic {
    Episode,
    Calls,
    Result,
}

impl Parts {
    fn collect(&mut self, bytes: &[u8], limits: &Limits) -> Result<(), Wrong> {
        walk(bytes, limits, |record| match record {
            Record::Channel(channel) => self.channel(&channel),
            Record::Message { channel, data } => match self.channels.get(&channel) {
                Some(topic) => self.message(*topic, data, limits),
                None => Ok(()),
            },
        })
    }

    fn channel(&mut self, channel: &Channel) -> Result<(), String> {
        let topic = match channel.topic {
            b"/episode" => Topic::Episode,
            b"/result" => Topic::Result,
            b"/calls" if channel.encoding == CALLS.as_bytes() => Topic::Calls,
            b"/calls" => {
                let found = shorten(&String::from_utf8_lossy(channel.encoding));
                return Err(format!(
                    "its calls are encoded as `{found}`, and `{CALLS}` is what this program knows"
                ));
            }
            topic => {
                self.real_run |= topic == b"/run";
                return Ok(());
            }
        };
        // A writer repeats its channels at the end of the file.
        self.channels.entry(channel.id).or_insert(topic);
        Ok(())
    }

    fn message(&mut self, topic: Topic, data: &[u8], limits: &Limits) -> Result<(), String> {
        match topic {
            Topic::Episode => {
                if self.header.is_some() {
                    return Err("it has two messages on /episode, and one is expected".to_string());
                }
                same_schema(data, |schema| schema == SCHEMA, SCHEMA, "/episode")?;
                self.header = Some(serde_json::from_slice(data).map_err(|error| wrong("/episode", &error))?);
            }
            Topic::Result => {
                if self.result.is_some() {
                    return Err("it has two messages on /result, and one is expected".to_string());
                }
                same_schema(data, EpisodeResult::reads, episode::SCHEMA, "/result")?;
                self.result = Some(EpisodeResult::from_json(data).map_err(|error| wrong("/result", &error))?);
            }
            Topic::Calls => {
                if self.calls.len() + data.len() > limits.calls {
                    return Err(format!("it has more than {} of calls", size(limits.calls as u64)));
                }
                self.calls.extend_from_slice(data);
            }
        }
        Ok(())
    }

    fn log(self, sha256: String) -> Result<Log, String> {
        let missing = |topic: &str| format!("it has no message on {topic}");
        if self.real_run && self.header.is_none() {
            return Err("it is the log of a real run, which `ramp score` judges".to_string());
        }
        let header = self.header.ok_or_else(|| missing("/episode"))?;
        let result = self.result.ok_or_else(|| missing("/result"))?;
        let state = header.state.iter().map(|state| ("state", &state.json, &state.sha256));
        let texts = [
            ("kit", &header.kit.xml, &header.kit.sha256),
            ("arm", &header.arm.json, &header.arm.sha256),
            ("world", &header.world.toml, &header.world.sha256),
            ("start", &header.start.toml, &header.start.sha256),
        ];
        for (what, text, hash) in texts.into_iter().chain(state) {
            if ramp_result::sha256(text.as_bytes()) != *hash {
                return Err(format!("its {what} does not match its hash"));
            }
        }
        Ok(Log { header, result, sha256, calls: self.calls })
    }
}

/// Another version is told as such, and not as a field that is missing.
fn same_schema(data: &[u8], reads: impl Fn(&str) -> bool, expected: &str, topic: &str) -> Result<(), String> {
    #[derive(serde::Deserialize)]
    struct Only {
        schema: String,
    }
    let Only { schema } = serde_json::from_slice(data).map_err(|error| wrong(topic, &error))?;
    if reads(&schema) {
        Ok(())
    } else {
        let schema = shorten(&schema);
        Err(format!("{topic} is of the schema `{schema}`, and `{expected}` is what this program knows"))
    }
}

/// A library's complaint about a message, which may quote from it.
fn wrong(topic: &str, error: &serde_json::Error) -> String {
    format!("{topic}: {}", plain(&error.to_string(), MAX_SENTENCE))
}
