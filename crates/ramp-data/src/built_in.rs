//! A file of the data folder: on the disk, or built into the program.

use std::path::PathBuf;

use ramp_assembly::GoalError;
use ramp_source::{MAX_FILE, ReadError, SourceFile, read_text};

include!(concat!(env!("OUT_DIR"), "/built_in.rs"));

/// The built-in files: path in a data folder, and text.
pub fn built_in() -> &'static [(&'static str, &'static str)] {
    BUILT_IN
}

/// A file of the data.
pub(crate) enum File {
    /// On the disk.
    Path(PathBuf),
    /// Its name in messages, and its text.
    BuiltIn(String, &'static str),
}

impl File {
    /// The built-in file with this path; empty if there is none.
    pub(crate) fn built_in(name: &str) -> File {
        let text = BUILT_IN.iter().find(|(known, _)| *known == name).map_or("", |(_, text)| *text);
        File::BuiltIn(format!("built-in {name}"), text)
    }

    /// Its name in messages.
    pub(crate) fn name(&self) -> String {
        match self {
            File::Path(path) => path.display().to_string(),
            File::BuiltIn(name, _) => name.clone(),
        }
    }

    /// Its text.
    pub(crate) fn text(&self) -> Result<String, ReadError> {
        match self {
            File::Path(path) => read_text(path, MAX_FILE),
            File::BuiltIn(_, text) => Ok((*text).to_string()),
        }
    }

    /// Its text with its name, for the parser of goals.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub(crate) fn goal_source(&self) -> Result<SourceFile, GoalError> {
        match self {
            File::Path(path) => SourceFile::read(path),
            File::BuiltIn(name, text) => Ok(SourceFile::new(name, text)),
        }
    }
}
