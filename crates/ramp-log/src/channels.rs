//! The file of a log: its channels, and messages on them.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Read, Seek};
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use ramp_result::sha256;

use crate::error::LogError;

/// Size of a chunk, bytes before compression.
const CHUNK: u64 = 512 * 1024;

/// A file that is being written. Until it is whole it has no name, so that nobody else can open it, and
/// nothing of it is left when the program ends early.
pub struct LogFile {
    path: PathBuf,
    /// `None` after the end.
    file: Option<mcap::Writer<BufWriter<File>>>,
    failed: Option<mcap::McapError>,
    /// Number of each channel.
    channels: BTreeMap<&'static str, u16>,
    sequence: u32,
}

impl LogFile {
    /// Opens a file without a name in the folder of `path`, which gets that name when it is whole.
    ///
    /// # Errors
    /// When it cannot be opened.
    pub fn create(path: &Path) -> Result<LogFile, LogError> {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let file = tempfile::tempfile_in(folder.unwrap_or(Path::new(".")))
            .map_err(|source| LogError::Io { path: path.to_path_buf(), source })?;
        let options = mcap::WriteOptions::new()
            .profile("ramp")
            .library("ramp")
            .chunk_size(Some(CHUNK))
            .compression_threads(0);
        let file = options
            .create(BufWriter::new(file))
            .map_err(|source| LogError::Write { path: path.to_path_buf(), source })?;
        Ok(LogFile {
            path: path.to_path_buf(),
            file: Some(file),
            failed: None,
            channels: BTreeMap::new(),
            sequence: 0,
        })
    }

    /// Runs `work` on the file, unless an earlier write failed. [`LogFile::finish`] tells of the failure.
    fn attempt(
        &mut self,
        work: impl FnOnce(&mut mcap::Writer<BufWriter<File>>) -> Result<(), mcap::McapError>,
    ) {
        if let (None, Some(file)) = (&self.failed, &mut self.file) {
            self.failed = work(file).err();
        }
    }

    /// Adds facts about the log, for viewers.
    pub fn describe(&mut self, metadata: BTreeMap<String, String>) {
        self.attempt(|file| file.write_metadata(&Metadata { name: "ramp".to_string(), metadata }));
    }

    /// Adds channels of JSON messages: topic, name of the schema, and the schema itself.
    pub fn add_json(&mut self, channels: &[(&'static str, &str, &str)]) {
        for (topic, name, schema) in channels {
            let mut added = 0;
            self.attempt(|file| {
                let schema = file.add_schema(name, "jsonschema", schema.as_bytes())?;
                added = file.add_channel(schema, topic, "json", &BTreeMap::new())?;
                Ok(())
            });
            self.channels.insert(topic, added);
        }
    }

    /// Adds a channel of another encoding.
    pub fn add_encoded(&mut self, topic: &'static str, encoding: &str) {
        let mut added = 0;
        self.attempt(|file| {
            added = file.add_channel(0, topic, encoding, &BTreeMap::new())?;
            Ok(())
        });
        self.channels.insert(topic, added);
    }

    /// Writes a message; `time` is in ns.
    pub fn put(&mut self, topic: &str, time: u64, data: &[u8]) {
        let Some(&channel_id) = self.channels.get(topic) else { return };
        self.sequence = self.sequence.wrapping_add(1);
        let header =
            MessageHeader { channel_id, sequence: self.sequence, log_time: time, publish_time: time };
        self.attempt(|file| file.write_to_known_channel(&header, data));
    }

    /// Ends the file, which is whole then and gets its name. Returns its bytes and their SHA-256 in hex.
    ///
    /// # Errors
    /// When something could not be written, now or earlier.
    pub fn finish(mut self) -> Result<(Vec<u8>, String), LogError> {
        let fail = |source| LogError::Write { path: self.path.clone(), source };
        if let Some(source) = self.failed.take() {
            return Err(fail(source));
        }
        let mut bytes = Vec::new();
        if let Some(mut file) = self.file.take() {
            file.finish().map_err(fail)?;
            let file = file.into_inner().into_inner().map_err(std::io::IntoInnerError::into_error);
            file.and_then(|mut file| {
                file.rewind()?;
                file.read_to_end(&mut bytes)
            })
            .map_err(|source| LogError::Io { path: self.path.clone(), source })?;
        }
        ramp_result::write_whole(&self.path, &bytes)
            .map_err(|error| LogError::Io { path: error.path, source: error.source })?;
        let hash = sha256(&bytes);
        Ok((bytes, hash))
    }
}
