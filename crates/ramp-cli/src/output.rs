//! Where results go: standard output, and files that a user has named.

use std::io::Write;
use std::path::Path;

use miette::{IntoDiagnostic, Report, miette};
use ramp_kit::source::{MAX_SENTENCE, plain, read_text, write_whole};

/// The largest file of an organiser, bytes.
const LARGEST: usize = 16 << 20;

/// Prints to standard output; whoever closed it early has seen enough.
pub fn print(text: &str) -> Result<(), Report> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.into_diagnostic(),
    }
}

/// Refuses a path that no file can have, before any work is done. Makes nothing: [`write_file`] does.
pub fn check_place(path: &Path) -> Result<(), Report> {
    if path.is_dir() {
        return Err(miette!("cannot write {}: it is a folder", path.display()));
    }
    // A file takes the place of what is there: that of a device must stay.
    if path.exists() && !path.is_file() {
        return Err(miette!("cannot write {}: it is no ordinary file", path.display()));
    }
    let existing = path.ancestors().skip(1).find(|folder| folder.exists());
    match existing.filter(|folder| !folder.is_dir()) {
        Some(file) => Err(miette!("cannot write {}: {} is no folder", path.display(), file.display())),
        None => Ok(()),
    }
}

/// Makes the folder of a file that is about to be written.
pub fn make_folder_of(path: &Path) -> Result<(), Report> {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => std::fs::create_dir_all(folder)
            .map_err(|error| miette!("cannot make the folder {}: {error}", folder.display())),
        _ => Ok(()),
    }
}

/// Writes a file, whole or not at all, in a folder that is made if it is not there.
pub fn write_file(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Report> {
    make_folder_of(path)?;
    Ok(write_whole(path, bytes)?)
}

/// Writes an organiser's file as JSON, whole or not at all.
pub fn write_json<T: serde::Serialize>(path: &Path, value: &T) -> Result<(), Report> {
    let text = serde_json::to_string_pretty(value).into_diagnostic()?;
    write_file(path, text + "\n")
}

/// Reads an organiser's file; `writer` is the command that makes such files.
pub fn read_json<T: serde::de::DeserializeOwned>(path: &Path, writer: &str) -> Result<T, Report> {
    let text = read_text(path, LARGEST)?;
    serde_json::from_str(&text).map_err(|error| {
        miette!(
            help = format!("expected a file that `{writer}` wrote"),
            "{}:{}:{}: {}",
            path.display(),
            error.line(),
            error.column(),
            plain(&error.to_string(), MAX_SENTENCE)
        )
    })
}

/// Refuses to write over what was promised.
pub fn refuse_existing(paths: [&Path; 2]) -> Result<(), Report> {
    match paths.into_iter().find(|path| path.exists()) {
        Some(path) => Err(miette!(
            help = "name another folder: what was promised must not be lost",
            "{} is there already",
            path.display()
        )),
        None => Ok(()),
    }
}
