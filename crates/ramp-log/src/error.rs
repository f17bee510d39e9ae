//! Errors of reading and writing logs.

use std::path::PathBuf;

/// Error of reading or writing a log.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The operating system refused.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// It cannot be written.
    #[error("{path} cannot be written: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// The library's reason.
        source: mcap::McapError,
    },
    /// The file is not MCAP, or was truncated or damaged.
    #[error("{path} is not a complete MCAP file: {what}")]
    Broken {
        /// The file.
        path: PathBuf,
        /// The defect, as a sentence for a person.
        what: String,
    },
    /// An MCAP file, but not the log of an episode.
    #[error("{path} is not the log of an episode: {what}")]
    Other {
        /// The file.
        path: PathBuf,
        /// The content found, and the content expected.
        what: String,
    },
}
