//! Reading a log, whoever made it: whatever the bytes, there is a log or one message that says what is wrong.

use std::io::Read;
use std::path::Path;

use mcap::records::op;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::calls::Decoder;
use super::{CALLS, Header, LogError, SCHEMA, sha256};
use crate::result::{self, EpisodeResult};

/// The largest log that is read, bytes; the longest episode makes a tenth of it.
const LARGEST: u64 = 512 << 20;
/// The largest record and the largest chunk, bytes.
const LARGEST_RECORD: usize = 16 << 20;
/// The most bytes of calls; the longest episode has a tenth of them.
const MOST_CALLS: usize = 256 << 20;

/// An episode's log.
#[derive(Clone, Debug)]
pub struct Log {
    /// What the episode was made from.
    pub header: Header,
    /// The result that the log tells; its `log` is `None`.
    pub result: EpisodeResult,
    /// SHA-256 of the file, in hex.
    pub sha256: String,
    calls: Vec<u8>,
}

impl Log {
    /// Reads a file.
    ///
    /// # Errors
    /// When it cannot be read or is no log.
    pub fn read(path: &Path) -> Result<Log, LogError> {
        Log::from_bytes(path, &bytes_of(path)?)
    }

    /// From a file's bytes; `path` is what messages call it.
    ///
    /// # Errors
    /// When they are no log.
    pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Log, LogError> {
        let mut parts = Parts::default();
        parts.collect(bytes).map_err(|wrong| wrong.at(path))?;
        parts.log(sha256(bytes)).map_err(|what| LogError::Other { path: path.to_path_buf(), what })
    }

    /// The calls of the agent, in order.
    pub fn calls(&self) -> Decoder<'_> {
        Decoder::new(&self.calls)
    }
}

/// The bytes of a file, if they are not too many.
pub(crate) fn bytes_of(path: &Path) -> Result<Vec<u8>, LogError> {
    let io = |source| LogError::Io { path: path.to_path_buf(), source };
    let file = std::fs::File::open(path).map_err(io)?;
    let mut bytes = Vec::new();
    file.take(LARGEST + 1).read_to_end(&mut bytes).map_err(io)?;
    if bytes.len() as u64 > LARGEST {
        let what = format!("it is larger than {} MiB", LARGEST >> 20);
        return Err(LogError::Other { path: path.to_path_buf(), what });
    }
    Ok(bytes)
}

/// What is wrong with a file.
pub(crate) enum Wrong {
    File(mcap::McapError),
    Content(String),
}

impl Wrong {
    /// The error that tells the file, too.
    pub(crate) fn at(self, path: &Path) -> LogError {
        match self {
            Wrong::File(error) => LogError::Broken { path: path.to_path_buf(), what: in_words(&error) },
            Wrong::Content(what) => LogError::Other { path: path.to_path_buf(), what },
        }
    }
}

impl From<mcap::McapError> for Wrong {
    fn from(error: mcap::McapError) -> Wrong {
        Wrong::File(error)
    }
}

fn in_words(error: &mcap::McapError) -> String {
    match error {
        mcap::McapError::UnexpectedEof | mcap::McapError::UnexpectedEoc => "it ends too early".to_string(),
        error => error.to_string(),
    }
}

/// A channel, as far as it matters here. The library's own reader believes the lengths that the record tells, and asks
/// for as much memory.
pub(crate) struct Channel<'d> {
    pub id: u16,
    pub topic: &'d [u8],
    pub encoding: &'d [u8],
}

impl<'d> Channel<'d> {
    fn parse(data: &'d [u8]) -> Option<Channel<'d>> {
        // Its number, its schema's, the topic and the encoding; what follows is not needed.
        let id = number16(data)?;
        let (topic, rest) = text(data.get(4..)?)?;
        let (encoding, _) = text(rest)?;
        Some(Channel { id, topic, encoding })
    }
}

fn number16(data: &[u8]) -> Option<u16> {
    data.first_chunk().map(|bytes| u16::from_le_bytes(*bytes))
}

/// A text with its length in front, and what follows it.
fn text(data: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = data.split_first_chunk()?;
    rest.split_at_checked(u32::from_le_bytes(*length) as usize)
}

/// What of a file matters here.
pub(crate) enum Record<'d> {
    Channel(Channel<'d>),
    Message {
        /// Number of its channel.
        channel: u16,
        data: &'d [u8],
    },
}

/// Goes through an MCAP file, every checksum in it looked at.
pub(crate) fn walk(bytes: &[u8], mut visit: impl FnMut(Record) -> Result<(), String>) -> Result<(), Wrong> {
    let options = LinearReaderOptions::default()
        .with_check_finishes_after_end_magic(true)
        .with_prevalidate_chunk_crcs(true)
        .with_validate_data_section_crc(true)
        .with_validate_summary_section_crc(true)
        .with_record_length_limit(LARGEST_RECORD);
    let mut reader = LinearReader::new_with_options(options);
    let mut rest = bytes;
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(wanted) => {
                let (next, after) = rest.split_at(wanted.min(rest.len()));
                reader.insert(next.len()).copy_from_slice(next);
                reader.notify_read(next.len());
                rest = after;
            }
            LinearReadEvent::Record { data, opcode: op::CHANNEL } => {
                let channel = Channel::parse(data).ok_or(mcap::McapError::UnexpectedEoc)?;
                visit(Record::Channel(channel)).map_err(Wrong::Content)?;
            }
            LinearReadEvent::Record { data, opcode: op::MESSAGE } => {
                // The channel's number, a sequence number and two times come first.
                let (Some(channel), Some(data)) = (number16(data), data.get(2 + 4 + 8 + 8..)) else {
                    return Err(mcap::McapError::UnexpectedEoc.into());
                };
                visit(Record::Message { channel, data }).map_err(Wrong::Content)?;
            }
            LinearReadEvent::Record { .. } => {}
        }
    }
    Ok(())
}

/// What is found in the file.
#[derive(Default)]
struct Parts {
    /// Numbers and topics of the channels.
    channels: Vec<(u16, Topic)>,
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
    fn collect(&mut self, bytes: &[u8]) -> Result<(), Wrong> {
        walk(bytes, |record| match record {
            Record::Channel(channel) => self.channel(&channel),
            Record::Message { channel, data } => match self.channels.iter().find(|(id, _)| *id == channel) {
                Some((_, topic)) => self.message(*topic, data),
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
                let found = ramp_kit::source::shorten(&String::from_utf8_lossy(channel.encoding));
                return Err(format!(
                    "its calls are encoded as `{found}`, and `{CALLS}` is what this program knows"
                ));
            }
            _ => return Ok(()),
        };
        // A writer repeats its channels at the end of the file.
        if !self.channels.iter().any(|(id, _)| *id == channel.id) {
            self.channels.push((channel.id, topic));
        }
        Ok(())
    }

    fn message(&mut self, topic: Topic, data: &[u8]) -> Result<(), String> {
        match topic {
            Topic::Episode => {
                if self.header.is_some() {
                    return Err("it has two messages on /episode, and one is expected".to_string());
                }
                same_schema(data, SCHEMA, "/episode")?;
                self.header =
                    Some(serde_json::from_slice(data).map_err(|error| format!("/episode: {error}"))?);
            }
            Topic::Result => {
                if self.result.is_some() {
                    return Err("it has two messages on /result, and one is expected".to_string());
                }
                same_schema(data, result::SCHEMA, "/result")?;
                self.result =
                    Some(serde_json::from_slice(data).map_err(|error| format!("/result: {error}"))?);
            }
            Topic::Calls => {
                if self.calls.len() + data.len() > MOST_CALLS {
                    return Err(format!("it has more than {} MiB of calls", MOST_CALLS >> 20));
                }
                self.calls.extend_from_slice(data);
            }
        }
        Ok(())
    }

    fn log(self, sha256: String) -> Result<Log, String> {
        let missing = |topic: &str| format!("it has no message on {topic}");
        let header = self.header.ok_or_else(|| missing("/episode"))?;
        let result = self.result.ok_or_else(|| missing("/result"))?;
        for (what, text, hash) in
            [("kit", &header.kit.xml, &header.kit.sha256), ("arm", &header.arm.json, &header.arm.sha256)]
        {
            if super::sha256(text.as_bytes()) != *hash {
                return Err(format!("its {what} is not the one whose hash it tells"));
            }
        }
        Ok(Log { header, result, sha256, calls: self.calls })
    }
}

/// Another version is told as such, and not as a field that is missing.
fn same_schema(data: &[u8], expected: &str, topic: &str) -> Result<(), String> {
    #[derive(serde::Deserialize)]
    struct Only {
        schema: String,
    }
    let Only { schema } = serde_json::from_slice(data).map_err(|error| format!("{topic}: {error}"))?;
    if schema == expected {
        Ok(())
    } else {
        let schema: String = schema.chars().take(40).collect();
        Err(format!("{topic} is of the schema `{schema}`, and `{expected}` is what this program knows"))
    }
}
