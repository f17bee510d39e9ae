//! Atomic writing: a file is complete or absent.

use std::fs::Permissions;
use std::io::Write;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use tempfile::NamedTempFile;

/// A file could not be written.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("cannot write {path}: {source}")]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// The system's reason.
    pub source: std::io::Error,
}

/// Unfinished files of this process, by their temporary names.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// An entry in the list of unfinished files, removed on drop.
struct Listed(PathBuf);

impl Listed {
    fn new(path: &Path) -> Listed {
        UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).push(path.to_path_buf());
        Listed(path.to_path_buf())
    }
}

impl Drop for Listed {
    fn drop(&mut self) {
        UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).retain(|path| *path != self.0);
    }
}

/// Removes the unfinished files of this process. For a program that was asked to end and ends at
/// once.
pub fn remove_unfinished() {
    for path in UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner).iter() {
        let _ = std::fs::remove_file(path);
    }
}

/// A file that is being written. It has a new, unpredictable name in its folder until
/// [`WholeFile::finish`] gives it its own name. If it is dropped before, it is removed. A link with
/// its name is replaced, not followed.
pub struct WholeFile {
    path: PathBuf,
    file: NamedTempFile,
    listed: Listed,
}

impl WholeFile {
    /// Starts a file.
    ///
    /// # Errors
    /// When the folder cannot be written to.
    pub fn new(path: &Path) -> Result<WholeFile, WriteError> {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        // The default mode; the umask applies, as for any other file.
        let ordinary = Permissions::from_mode(0o666);
        let mut builder = tempfile::Builder::new();
        match builder.prefix(".").suffix(".partial").permissions(ordinary).tempfile_in(folder) {
            Ok(file) => {
                let listed = Listed::new(file.path());
                Ok(WholeFile { path: path.to_path_buf(), file, listed })
            }
            Err(error) => {
                // The temporary name means nothing to the reader of the message.
                let source = error.raw_os_error().map_or(error, std::io::Error::from_raw_os_error);
                Err(WriteError { path: path.to_path_buf(), source })
            }
        }
    }

    /// Its temporary path, for another program that writes it.
    pub fn place(&self) -> &Path {
        self.file.path()
    }

    /// Renames it to its own name, once all of it is on the disk.
    ///
    /// # Errors
    /// When the system cannot write it, or the path is taken by something other than a file.
    pub fn finish(self) -> Result<(), WriteError> {
        let WholeFile { path, file, listed: _listed } = self;
        let done = file.as_file().sync_all();
        match done.and_then(|()| file.persist(&path).map(drop).map_err(|error| error.error)) {
            Ok(()) => Ok(()),
            Err(source) => Err(WriteError { path, source }),
        }
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.file.as_file_mut().write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.file.as_file_mut().flush()
    }
}

/// Writes a file atomically.
///
/// # Errors
/// When the folder cannot be written to.
pub fn write_whole(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), WriteError> {
    let mut file = WholeFile::new(path)?;
    file.write_all(bytes.as_ref()).map_err(|source| WriteError { path: path.to_path_buf(), source })?;
    file.finish()
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn no_link_is_followed_and_nothing_is_left_behind() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("victim"), "mine").unwrap();
        for name in ["result.json", "result.json.partial"] {
            std::os::unix::fs::symlink(at("victim"), at(name)).unwrap();
        }
        write_whole(&at("result.json"), "{}").unwrap();
        assert_eq!(std::fs::read_to_string(at("result.json")).unwrap(), "{}");
        assert_eq!(std::fs::read_to_string(at("victim")).unwrap(), "mine");
        assert!(at("result.json.partial").is_symlink(), "it is not ours");
        // A folder with the file's name is in the way.
        std::fs::create_dir_all(at("taken/inside")).unwrap();
        assert!(write_whole(&at("taken"), "{}").is_err());
        let mut names: Vec<_> =
            std::fs::read_dir(folder.path()).unwrap().map(|it| it.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, ["result.json", "result.json.partial", "taken", "victim"]);
    }

    #[test]
    fn what_is_not_whole_can_be_taken_away() {
        let folder = tempfile::tempdir().unwrap();
        let names = || std::fs::read_dir(folder.path()).unwrap().count();
        let file = WholeFile::new(&folder.path().join("film.gif")).unwrap();
        write_whole(&folder.path().join("whole"), "").unwrap();
        assert_eq!(names(), 2);
        remove_unfinished();
        assert_eq!(names(), 1);
        assert!(file.finish().is_err());
    }

    #[test]
    fn others_may_read_what_they_may_read_of_any_file() {
        let folder = tempfile::tempdir().unwrap();
        let mode = |name: &str| folder.path().join(name).metadata().unwrap().permissions().mode();
        std::fs::write(folder.path().join("any"), "").unwrap();
        write_whole(&folder.path().join("whole"), "").unwrap();
        assert_eq!(mode("whole"), mode("any"));
    }
}
