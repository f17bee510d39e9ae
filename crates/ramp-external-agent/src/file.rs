//! The file of an agent's program.

use std::path::{Path, PathBuf};

use ramp_result::sha256;

/// The largest agent file, bytes.
const LARGEST_FILE: u64 = 1 << 30;

/// An agent's program.
#[derive(Clone, Debug)]
pub struct AgentFile {
    path: PathBuf,
    sha256: String,
}

/// Why a file is no agent.
#[derive(Debug, thiserror::Error)]
pub enum AgentFileError {
    /// It cannot be read.
    #[error("the agent {path} cannot be read: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// It is not one that can be run.
    #[error("the agent {path} is neither a Python file (.py) nor an executable")]
    NotExecutable {
        /// The file.
        path: PathBuf,
    },
    /// The system does not start it.
    #[error("the agent {path} cannot be started: {source}")]
    Start {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
}

impl AgentFile {
    /// Looks at a file: an executable, or a Python file.
    ///
    /// # Errors
    /// When it is neither.
    pub fn find(path: &Path) -> Result<AgentFile, AgentFileError> {
        let io = |source| AgentFileError::Io { path: path.to_path_buf(), source };
        // The working folder changes nothing.
        let path = path.canonicalize().map_err(io)?;
        let meta = path.metadata().map_err(io)?;
        let python = path.extension().is_some_and(|ending| ending == "py");
        let executable = std::os::unix::fs::PermissionsExt::mode(&meta.permissions()) & 0o111 != 0;
        if !meta.is_file() || !(python || executable) || meta.len() > LARGEST_FILE {
            return Err(AgentFileError::NotExecutable { path });
        }
        let sha256 = sha256(&std::fs::read(&path).map_err(io)?);
        Ok(AgentFile { path, sha256 })
    }

    /// SHA-256 of the file, in hex.
    pub fn sha256(&self) -> &str {
        &self.sha256
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it is a Python file; every other is an executable.
    pub fn is_python(&self) -> bool {
        self.path.extension().is_some_and(|ending| ending == "py")
    }

    /// Its command: program and arguments.
    pub fn command(&self) -> Vec<std::ffi::OsString> {
        let path = self.path.clone().into_os_string();
        if self.is_python() {
            // Unbuffered, so that `print` is a message sent.
            vec!["python3".into(), "-u".into(), path]
        } else {
            vec![path]
        }
    }
}
