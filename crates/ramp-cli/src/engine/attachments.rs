//! Files that travel to the workers.

use std::collections::BTreeMap;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use miette::{Report, miette};
use serde::Serialize;

/// Largest size of all files together, bytes. The engine holds them in memory on each node.
pub const LARGEST: usize = 512 << 20;
/// Deepest nesting of a folder.
const DEEPEST: usize = 16;

/// The files and folders that the options of some jobs name.
#[derive(Default)]
pub struct Attachments(BTreeMap<PathBuf, String>);

/// A file, as the worker finds it.
#[derive(Serialize)]
pub struct Packed {
    /// Its path in the worker's folder.
    pub name: String,
    /// Its length, bytes.
    pub size: usize,
    pub executable: bool,
}

impl Attachments {
    /// Adds a file or a folder. Returns its path in the worker's folder, which is the same for every job.
    pub fn pack(&mut self, path: &Path) -> String {
        let index = self.0.len();
        // Each has a folder of its own, so that its name stays and no other file is beside it.
        let place = self.0.entry(path.to_path_buf()).or_insert_with(|| {
            let name = path.file_name().unwrap_or("folder".as_ref());
            format!("{index}/{}", name.to_string_lossy())
        });
        place.clone()
    }

    /// The content of all files, read now.
    ///
    /// # Errors
    /// If a file cannot be read, has a name that cannot be told, or all are too large.
    pub fn read(&self) -> Result<Vec<(Packed, Vec<u8>)>, Report> {
        let mut files = Vec::new();
        for (path, name) in &self.0 {
            read_into(&mut files, path, name, 0)?;
        }
        Ok(files)
    }
}

/// Reads a file, or all files of a folder.
fn read_into(
    files: &mut Vec<(Packed, Vec<u8>)>,
    path: &Path,
    name: &str,
    depth: usize,
) -> Result<(), Report> {
    let fail = |error: std::io::Error| miette!("{} cannot be read: {error}", path.display());
    if name.contains(char::REPLACEMENT_CHARACTER) {
        return Err(miette!("{} cannot travel to another machine: its name is no UTF-8", path.display()));
    }
    if path.is_dir() {
        if depth == DEEPEST {
            return Err(miette!("{} is nested more than {DEEPEST} folders deep", path.display()));
        }
        let mut inside =
            std::fs::read_dir(path).and_then(Iterator::collect::<Result<Vec<_>, _>>).map_err(fail)?;
        inside.sort_by_key(std::fs::DirEntry::file_name);
        for entry in inside {
            let its = entry.file_name();
            read_into(files, &entry.path(), &format!("{name}/{}", its.to_string_lossy()), depth + 1)?;
        }
        return Ok(());
    }
    let meta = path.metadata().map_err(fail)?;
    let before: usize = files.iter().map(|(_, bytes)| bytes.len()).sum();
    if usize::try_from(meta.len()).unwrap_or(usize::MAX) > LARGEST - before.min(LARGEST) {
        return Err(miette!(
            help = "name a folder that has only what the episodes need",
            "with {}, the files that travel to other machines are larger than {} MiB",
            path.display(),
            LARGEST >> 20
        ));
    }
    let bytes = std::fs::read(path).map_err(fail)?;
    let executable = meta.permissions().mode() & 0o111 != 0;
    files.push((Packed { name: name.to_string(), size: bytes.len(), executable }, bytes));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_travels_with_all_in_it_and_equal_names_stay_apart() {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in [("a/world.toml", "one"), ("b/world.toml", "two"), ("b/deep/goal.xml", "three")] {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        let mut attachments = Attachments::default();
        let first = attachments.pack(&folder.path().join("a/world.toml"));
        let second = attachments.pack(&folder.path().join("b"));
        assert_eq!(attachments.pack(&folder.path().join("a/world.toml")), first);
        assert_eq!((first, second), ("0/world.toml".to_string(), "1/b".to_string()));
        let files = attachments.read().unwrap();
        let found: Vec<(&str, &[u8])> =
            files.iter().map(|(packed, bytes)| (packed.name.as_str(), bytes.as_slice())).collect();
        let expected: [(&str, &[u8]); 3] =
            [("0/world.toml", b"one"), ("1/b/deep/goal.xml", b"three"), ("1/b/world.toml", b"two")];
        assert_eq!(found, expected);
        // A circle of links ends.
        std::os::unix::fs::symlink(folder.path(), folder.path().join("b/up")).unwrap();
        assert!(attachments.read().err().unwrap().to_string().contains("nested"));
    }
}
