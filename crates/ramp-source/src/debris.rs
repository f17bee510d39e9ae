//! Files that an operating system leaves beside those of a person.

use std::path::Path;

/// Whether a file or folder of this name is left by a file manager or an archiver: `._NAME` beside NAME,
/// `__MACOSX` and `.DS_Store` by macOS, `Thumbs.db` and `desktop.ini` by Windows. They say nothing about the
/// files beside them and are ignored wherever a folder is read.
///
/// ```
/// # use ramp_source::is_debris;
/// assert!(is_debris("results/._easy-1.json".as_ref()) && is_debris("__MACOSX".as_ref()));
/// assert!(!is_debris("_.json".as_ref()) && !is_debris("._/easy-1.json".as_ref()));
/// ```
pub fn is_debris(path: &Path) -> bool {
    let Some(name) = path.file_name() else { return false };
    name.as_encoded_bytes().starts_with(b"._")
        || ["__MACOSX", ".DS_Store", "Thumbs.db", "desktop.ini"].iter().any(|known| name == *known)
}

/// The sentence about `count` such files in a place; `None` if there is none.
pub fn describe_debris(count: usize, place: &str) -> Option<String> {
    let files = match count {
        0 => return None,
        1 => "1 file".to_string(),
        count => format!("{count} files"),
    };
    Some(format!("{place}: {files} of a file manager (such as `._NAME` and `.DS_Store`) ignored"))
}
