//! The records of an untrusted MCAP file: every length is checked before it is used.

use std::collections::BTreeSet;
use std::io::Read;
use std::path::Path;

use mcap::records::op;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use ramp_kit::source::{MAX_SENTENCE, plain, shorten};

use crate::error::LogError;

/// Limits on a file that is read. The longest episode makes at most a quarter of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Size of the file, bytes.
    pub file: u64,
    /// Size of a record and of a chunk, bytes.
    pub record: usize,
    /// Number of channels.
    pub channels: usize,
    /// Number of messages.
    pub messages: u64,
    /// Size of all records after decompression, bytes.
    pub decompressed: u64,
    /// Size of all calls, bytes.
    pub calls: usize,
}

impl Default for Limits {
    fn default() -> Limits {
        Limits {
            file: 512 << 20,
            record: 16 << 20,
            channels: 64,
            messages: 4_000_000,
            decompressed: 2 << 30,
            calls: 256 << 20,
        }
    }
}

/// The bytes of a file within the size limit.
///
/// # Errors
/// When it cannot be read, or is too large.
pub fn bytes_of(path: &Path, limits: &Limits) -> Result<Vec<u8>, LogError> {
    let io = |source| LogError::Io { path: path.to_path_buf(), source };
    let file = std::fs::File::open(path).map_err(io)?;
    let mut bytes = Vec::new();
    file.take(limits.file + 1).read_to_end(&mut bytes).map_err(io)?;
    if bytes.len() as u64 > limits.file {
        let what = format!("it is larger than {}", size(limits.file));
        return Err(LogError::Other { path: path.to_path_buf(), what });
    }
    Ok(bytes)
}

/// A number of bytes for a person.
pub(crate) fn size(bytes: u64) -> String {
    if bytes.is_multiple_of(1 << 20) { format!("{} MiB", bytes >> 20) } else { format!("{bytes} bytes") }
}

/// A defect of a file.
pub enum Wrong {
    /// The MCAP container is damaged.
    File(mcap::McapError),
    /// The content of a message is wrong, described in words.
    Content(String),
}

impl Wrong {
    /// The error with the file's name.
    pub fn at(self, path: &Path) -> LogError {
        match self {
            Wrong::File(error) => LogError::Broken { path: path.to_path_buf(), what: in_words(&error) },
            Wrong::Content(what) => LogError::Other { path: path.to_path_buf(), what },
        }
    }
}

impl From<mcap::McapError> for Wrong {
    fn from(error: mcap::McapError) -> Wrong {
        match error {
            mcap::McapError::UnsupportedCompression(name) => Wrong::Content(format!(
                "it is compressed with `{}`, expected zstd, lz4 or no compression",
                shorten(&name)
            )),
            error => Wrong::File(error),
        }
    }
}

fn in_words(error: &mcap::McapError) -> String {
    match error {
        mcap::McapError::UnexpectedEof | mcap::McapError::UnexpectedEoc => "it ends too early".to_string(),
        error => plain(&error.to_string(), MAX_SENTENCE),
    }
}

/// The needed fields of a channel record. The library's own reader trusts the lengths in the record
/// and allocates as much memory.
pub struct Channel<'d> {
    /// Its number.
    pub id: u16,
    /// Its topic.
    pub topic: &'d [u8],
    /// Encoding of its messages.
    pub encoding: &'d [u8],
}

impl<'d> Channel<'d> {
    fn parse(data: &'d [u8]) -> Option<Channel<'d>> {
        // Its number, its schema's number, the topic and the encoding; the rest is not needed.
        let id = number16(data)?;
        let (topic, rest) = text(data.get(4..)?)?;
        let (encoding, _) = text(rest)?;
        Some(Channel { id, topic, encoding })
    }
}

fn number16(data: &[u8]) -> Option<u16> {
    data.first_chunk().map(|bytes| u16::from_le_bytes(*bytes))
}

/// A text preceded by its length, and the bytes after it.
fn text(data: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = data.split_first_chunk()?;
    rest.split_at_checked(u32::from_le_bytes(*length) as usize)
}

/// The records of interest in a file.
pub enum Record<'d> {
    /// A channel.
    Channel(Channel<'d>),
    /// A message.
    Message {
        /// Number of its channel.
        channel: u16,
        /// Its bytes.
        data: &'d [u8],
    },
}

/// Opcode and content of the first record of `bytes`, and the bytes after it. An eight-byte length
/// precedes the content.
fn record(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (&opcode, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk()?;
    let (content, rest) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
    Some((opcode, content, rest))
}

/// Checks that the records of every uncompressed chunk fill it. Without this check, the library
/// reads beyond the end of a chunk whose last record is too long.
fn chunks_are_filled(bytes: &[u8]) -> bool {
    let mut rest = bytes.get(mcap::MAGIC.len()..).unwrap_or_default();
    // After the last record there is only the end mark.
    while rest.len() > mcap::MAGIC.len() {
        let Some((opcode, content, after)) = record(rest) else { return false };
        rest = after;
        // Two times, the size and the checksum of the content come first.
        let inside = content.get(8 + 8 + 8 + 4..).and_then(text);
        let Some((b"", inside)) = inside.filter(|_| opcode == op::CHUNK) else { continue };
        let Some((length, inside)) = inside.split_first_chunk() else { return false };
        let length = u64::from_le_bytes(*length);
        let Some(mut inside) = usize::try_from(length).ok().and_then(|length| inside.get(..length)) else {
            return false;
        };
        while !inside.is_empty() {
            let Some((_, _, after)) = record(inside) else { return false };
            inside = after;
        }
    }
    true
}

/// The records so far.
struct Count<'l> {
    limits: &'l Limits,
    channels: BTreeSet<u16>,
    messages: u64,
    decompressed: u64,
}

impl Count<'_> {
    /// Counts a record.
    fn add(&mut self, opcode: u8, data: &[u8]) -> Result<(), String> {
        let limits = self.limits;
        // Its opcode and its length come before it.
        self.decompressed += 1 + 8 + data.len() as u64;
        if self.decompressed > limits.decompressed {
            return Err(format!("it holds more than {} after decompression", size(limits.decompressed)));
        }
        if opcode == op::MESSAGE {
            self.messages += 1;
            if self.messages > limits.messages {
                return Err(format!("it has more than {} messages", limits.messages));
            }
        }
        // A writer repeats its channels at the end of the file.
        if opcode == op::CHANNEL
            && let Some(id) = number16(data)
        {
            self.channels.insert(id);
            if self.channels.len() > limits.channels {
                return Err(format!("it has more than {} channels", limits.channels));
            }
        }
        Ok(())
    }
}

/// Visits the records of an MCAP file and checks every checksum in it.
///
/// # Errors
/// When it is not a whole MCAP file or exceeds a limit, and any error of `visit`.
pub fn walk(
    bytes: &[u8],
    limits: &Limits,
    mut visit: impl FnMut(Record) -> Result<(), String>,
) -> Result<(), Wrong> {
    let options = LinearReaderOptions::default()
        .with_check_finishes_after_end_magic(true)
        .with_prevalidate_chunk_crcs(true)
        .with_validate_data_section_crc(true)
        .with_validate_summary_section_crc(true)
        .with_record_length_limit(limits.record);
    if !chunks_are_filled(bytes) {
        return Err(mcap::McapError::UnexpectedEoc.into());
    }
    let mut reader = LinearReader::new_with_options(options);
    let mut rest = bytes;
    let mut count = Count { limits, channels: BTreeSet::new(), messages: 0, decompressed: 0 };
    while let Some(event) = reader.next_event() {
        let event = event?;
        if let LinearReadEvent::Record { data, opcode } = &event {
            count.add(*opcode, data).map_err(Wrong::Content)?;
        }
        match event {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A file with one uncompressed chunk that claims to hold `length` bytes of records.
    fn chunk(records: &[u8], length: usize) -> Vec<u8> {
        let mut content = vec![0; 8 + 8 + 8 + 4 + 4];
        content.extend((length as u64).to_le_bytes());
        content.extend(records);
        let mut file = mcap::MAGIC.to_vec();
        file.push(op::CHUNK);
        file.extend((content.len() as u64).to_le_bytes());
        file.extend(content);
        file
    }

    #[test]
    fn a_record_that_is_longer_than_its_chunk_is_refused() {
        let record = [&[op::MESSAGE][..], &3u64.to_le_bytes(), b"abc"].concat();
        assert!(chunks_are_filled(&chunk(&record, record.len())));
        for length in [record.len() - 1, record.len() + 1, 0] {
            assert_eq!(chunks_are_filled(&chunk(&record, length)), length == 0, "{length}");
        }
        let whole = chunk(&record, record.len());
        assert!(!chunks_are_filled(&whole[..whole.len() - 1]));
        let wrong = walk(&chunk(&record, record.len() - 1), &Limits::default(), |_| Ok(()));
        assert!(wrong.is_err());
    }
}
