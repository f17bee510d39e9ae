//! Reads untrusted files within limits: as bytes, as text, and as a [`SourceFile`].

use crate::decode::{NoText, decode};
use crate::fault::{Fault, Problem};
use crate::file::{MAX_FILE, SourceFile};
use crate::form::FormProblem;
use crate::text::plain;
use std::io::Read;
use std::path::Path;

/// Reasons why a file was not read.
#[derive(Clone, Debug, PartialEq, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum ReadError {
    /// The system cannot read it.
    #[error("{file} cannot be read: {why}")]
    Unreadable {
        /// The file.
        file: String,
        /// The system's reason, in plain words.
        why: String,
    },
    /// It is larger than its limit.
    #[error("{file} is larger than {} kB", most / 1024)]
    TooLarge {
        /// The file.
        file: String,
        /// The limit, bytes.
        most: usize,
    },
    /// It is no text that [`decode`] reads.
    #[error("{file} is not UTF-8 text: found {found}")]
    NotUtf8 {
        /// The file.
        file: String,
        /// What was found instead.
        found: String,
    },
}

/// The bytes of a file of at most `most` bytes. No more is read, whatever size the system reports.
///
/// # Errors
/// When the system cannot read it, or it is larger.
pub fn read_bytes(path: &Path, most: usize) -> Result<Vec<u8>, ReadError> {
    let file = || plain(&path.display().to_string(), usize::MAX);
    let mut bytes = Vec::new();
    // One byte above the limit distinguishes a file that is too large from one that just fits.
    std::fs::File::open(path)
        .and_then(|file| file.take(most as u64 + 1).read_to_end(&mut bytes))
        .map_err(|error| ReadError::Unreadable { file: file(), why: describe_io(&error) })?;
    if bytes.len() > most { Err(ReadError::TooLarge { file: file(), most }) } else { Ok(bytes) }
}

/// The text of a file of at most `most` bytes.
///
/// # Errors
/// When the system cannot read it, it is larger, or no text that [`decode`] reads.
pub fn read_text(path: &Path, most: usize) -> Result<String, ReadError> {
    match decode(&read_bytes(path, most)?) {
        Ok(text) => Ok(text.into_owned()),
        Err(NoText { found, .. }) => {
            Err(ReadError::NotUtf8 { file: plain(&path.display().to_string(), usize::MAX), found })
        }
    }
}

impl SourceFile {
    /// Reads a text file of at most [`MAX_FILE`] bytes.
    ///
    /// # Errors
    /// When the system cannot read it, when it is too large, or where it is no text that [`decode`]
    /// reads.
    pub fn read<P: Problem + From<FormProblem>>(path: &Path) -> Result<SourceFile, Fault<P>> {
        let name = plain(&path.display().to_string(), usize::MAX);
        let unreadable = |why: String| {
            let file = SourceFile::unreadable(&name);
            Fault::new(FormProblem::Unreadable { file: name.clone(), why }.into(), file.place(0..0))
        };
        let bytes = read_bytes(path, MAX_FILE).map_err(|error| match error {
            ReadError::Unreadable { why, .. } => unreadable(why),
            _ => unreadable(FormProblem::TooLarge.to_string()),
        })?;
        match decode(&bytes) {
            Ok(text) => Ok(SourceFile::new(&name, &text)),
            Err(NoText { found, before }) => {
                let end = before.len();
                let file = SourceFile::new(&name, &(before + "\u{fffd}"));
                Err(Fault::new(FormProblem::NotUtf8 { found }.into(), file.place(end..end)))
            }
        }
    }
}

/// The reason why the system could not read a file, in plain words.
fn describe_io(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "there is no such file".to_string(),
        std::io::ErrorKind::PermissionDenied => "its permissions forbid it".to_string(),
        std::io::ErrorKind::IsADirectory => "it is a folder".to_string(),
        _ => error.to_string(),
    }
}
