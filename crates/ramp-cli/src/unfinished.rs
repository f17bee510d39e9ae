//! Files that grow while the program works, such as films. What is not whole is taken away, also when the program is
//! asked to end.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use miette::{IntoDiagnostic, Report};

use crate::status::STOPPED;

/// The files that are not whole.
static FILES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// A file that is not whole. It is taken away when this is dropped.
pub struct Unfinished(PathBuf);

impl Unfinished {
    /// For a file that is about to be begun.
    pub fn new(path: &Path) -> Unfinished {
        FILES.lock().unwrap_or_else(PoisonError::into_inner).push(path.to_path_buf());
        Unfinished(path.to_path_buf())
    }

    /// The file is whole, and stays.
    pub fn finish(self) {
        FILES.lock().unwrap_or_else(PoisonError::into_inner).retain(|path| *path != self.0);
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        let mut files = FILES.lock().unwrap_or_else(PoisonError::into_inner);
        if files.contains(&self.0) {
            files.retain(|path| *path != self.0);
            let _ = std::fs::remove_file(&self.0);
        }
    }
}

/// From now on, Ctrl-C and a request to end (SIGTERM) take away what is not whole before the program ends.
///
/// # Errors
/// When the system does not let it.
pub fn end_on_request() -> Result<(), Report> {
    ctrlc::set_handler(|| {
        for path in FILES.lock().unwrap_or_else(PoisonError::into_inner).iter() {
            let _ = std::fs::remove_file(path);
        }
        std::process::exit(STOPPED.into());
    })
    .into_diagnostic()
}
