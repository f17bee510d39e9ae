//! From a path to a [`SourceFile`]: UTF-8 text of a sensible size, or what is wrong with it.

use crate::fault::{Fault, Problem};
use crate::file::{MAX_FILE, SourceFile};
use crate::form::FormProblem;
use std::path::Path;

impl SourceFile {
    /// Reads a file, which must be UTF-8 and no larger than [`MAX_FILE`].
    ///
    /// # Errors
    /// When the system cannot read it, when it is too large, or at its first byte that is not UTF-8.
    pub fn read<P: Problem + From<FormProblem>>(path: &Path) -> Result<SourceFile, Fault<P>> {
        use std::io::Read;
        let name = path.display().to_string();
        let unreadable = |why: String| {
            let file = SourceFile::unreadable(&name);
            Fault::new(FormProblem::Unreadable { file: name.clone(), why }.into(), file.place(0..0))
        };
        let mut bytes = Vec::new();
        // One byte more than allowed tells a file that is too large from one that just fits.
        let limit = MAX_FILE as u64 + 1;
        std::fs::File::open(path)
            .and_then(|file| file.take(limit).read_to_end(&mut bytes))
            .map_err(|error| unreadable(describe_io(&error)))?;
        if bytes.len() > MAX_FILE {
            return Err(unreadable(FormProblem::TooLarge.to_string()));
        }
        match String::from_utf8(bytes) {
            Ok(text) => Ok(SourceFile::new(&name, &text)),
            Err(error) => {
                let valid = error.utf8_error().valid_up_to();
                let file = SourceFile::new(&name, &String::from_utf8_lossy(error.as_bytes()));
                // What stands in front is valid, so the offset is the same in the lossy text.
                let byte = error.as_bytes()[valid];
                Err(Fault::new(FormProblem::NotUtf8 { byte }.into(), file.place(valid..valid)))
            }
        }
    }
}

/// Why the system could not read a file, in plain words.
fn describe_io(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "there is no such file".to_string(),
        std::io::ErrorKind::PermissionDenied => "its permissions forbid it".to_string(),
        std::io::ErrorKind::IsADirectory => "it is a folder".to_string(),
        _ => error.to_string(),
    }
}
