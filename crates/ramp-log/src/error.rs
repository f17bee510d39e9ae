//! Why a log could not be written or read.

use std::path::PathBuf;

/// Why a log could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The system says no.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// It cannot be written.
    #[error("{path} cannot be written: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// What the library said.
        source: mcap::McapError,
    },
    /// It is no MCAP file, or one that was cut or damaged.
    #[error("{path} is no whole MCAP file: {what}")]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// It is an MCAP file, but none of an episode.
    #[error("{path} is no log of an episode: {what}")]
    Other {
        /// The file.
        path: PathBuf,
        /// What was found, and what was expected.
        what: String,
    },
}
