//! The only place that writes to standard output and standard error; also writes the files that the user
//! names.

use std::io::Write;
use std::path::Path;

use crate::status::MachineFault;
use miette::{IntoDiagnostic, MietteHandlerOpts, Report, miette};
use ramp_kit::source::{MAX_SENTENCE, plain, read_text, write_whole};
use textwrap::WordSplitter;

/// Largest size of an organiser's file, bytes.
const LARGEST: usize = 16 << 20;

/// Prints a result to standard output. A closed pipe is not an error.
///
/// # Errors
/// If standard output cannot be written to, such as a file on a full disk.
pub fn print(text: &str) -> Result<(), Report> {
    let mut out = std::io::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(MachineFault { what: format!("standard output cannot be written to: {error}") }.into())
        }
        _ => Ok(()),
    }
}

/// Writes a message for a person to standard error, with a line break. A message that cannot be written is
/// lost: it never ends the work that it is about.
pub fn tell(text: &str) {
    let _ = std::io::stderr().write_all(format!("{text}\n").as_bytes());
}

/// Makes messages of errors break between words only, so that names stay whole.
pub fn set_form_of_errors() {
    let _ = miette::set_hook(Box::new(|_| {
        let form = MietteHandlerOpts::new().break_words(false).word_splitter(WordSplitter::NoHyphenation);
        Box::new(form.build())
    }));
}

/// Rejects a path that cannot be written, before any work starts. Creates nothing: [`write_file`] does.
pub fn check_place(path: &Path) -> Result<(), Report> {
    if path.is_dir() {
        return Err(miette!("cannot write {}: it is a folder", path.display()));
    }
    // Writing replaces the existing file, so a device must be rejected.
    if path.exists() && !path.is_file() {
        return Err(miette!("cannot write {}: it is no ordinary file", path.display()));
    }
    let existing = path.ancestors().skip(1).find(|folder| folder.exists());
    match existing.filter(|folder| !folder.is_dir()) {
        Some(file) => Err(miette!("cannot write {}: {} is no folder", path.display(), file.display())),
        None => Ok(()),
    }
}

/// Creates the parent folder of a file.
pub fn make_folder_of(path: &Path) -> Result<(), Report> {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => std::fs::create_dir_all(folder)
            .map_err(|error| miette!("cannot make the folder {}: {error}", folder.display())),
        _ => Ok(()),
    }
}

/// Writes a file atomically. Creates its folder if it is missing.
pub fn write_file(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Report> {
    make_folder_of(path)?;
    Ok(write_whole(path, bytes)?)
}

/// Writes an organiser's file as JSON, atomically.
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

/// Rejects a path that would overwrite a commitment.
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
