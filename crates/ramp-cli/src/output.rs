//! Where results go: standard output, and files that a user has named.

use std::io::Write;
use std::path::Path;

use miette::{IntoDiagnostic, Report, miette};

/// Prints to standard output; whoever closed it early has seen enough.
pub fn print(text: &str) -> Result<(), Report> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.into_diagnostic(),
    }
}

/// Makes the folder of a file that is to be written, and refuses a path that no file can have, before any work is done.
pub fn make_folder_of(path: &Path) -> Result<(), Report> {
    if path.is_dir() {
        return Err(miette!("cannot write {}: it is a folder", path.display()));
    }
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => std::fs::create_dir_all(folder)
            .map_err(|error| miette!("cannot make the folder {}: {error}", folder.display())),
        _ => Ok(()),
    }
}
