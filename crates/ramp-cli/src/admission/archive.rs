//! Entries as one file: an archive (`.tar`) of the folder's files, side by side. An archive is untrusted: it
//! may hold ordinary files with plain names only, within the limits of an entry.

use std::fs::{File, OpenOptions};
use std::io::{BufReader, BufWriter, Read, Write};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{OpenOptionsExt, PermissionsExt};
use std::path::{Component, Path, PathBuf};

use ramp_kit::source::{plain, shorten};
use tar::{Archive, Builder, EntryType, Header};
use tempfile::TempDir;

use super::limits::EntryLimits;

/// File mode of an agent, and of every other file.
const MODES: [u32; 2] = [0o755, 0o644];

/// Reasons why an archive is no entry.
#[derive(Debug, thiserror::Error)]
pub enum ArchiveError {
    /// The system failed, or the archive is damaged.
    #[error("the archive cannot be read: {0}")]
    Read(String),
    /// A link, a folder, a device.
    #[error("{name} in the archive is no ordinary file")]
    NoFile {
        /// Its name.
        name: String,
    },
    /// A name that leads elsewhere.
    #[error("{name} in the archive is no plain name: an entry has its files side by side")]
    Name {
        /// Its name.
        name: String,
    },
    /// The same name twice.
    #[error("{name} is in the archive twice")]
    Twice {
        /// Its name.
        name: String,
    },
    /// Too many files.
    #[error("the archive has more than {most} files")]
    Many {
        /// The limit.
        most: usize,
    },
    /// Too large.
    #[error("the archive is larger than {most} MiB")]
    Large {
        /// The limit, MiB.
        most: u64,
    },
    /// The files cannot be unpacked.
    #[error("the archive cannot be unpacked: {0}")]
    Unpack(std::io::Error),
}

/// Whether a path has the name of an archive.
pub fn is_archive(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "tar")
}

/// Unpacks an archive to a temporary folder.
///
/// # Errors
/// The first file that no entry may have, or a limit. Then nothing is left of it.
pub fn unpack(path: &Path, limits: &EntryLimits) -> Result<TempDir, ArchiveError> {
    let read = |error: std::io::Error| ArchiveError::Read(plain(&error.to_string(), 200));
    let no_file = || ArchiveError::NoFile { name: "it".to_string() };
    // Opening a pipe may block for ever.
    if !std::fs::symlink_metadata(path).map_err(read)?.is_file() {
        return Err(no_file());
    }
    let large = ArchiveError::Large { most: limits.total >> 20 };
    let file = File::open(path).map_err(read)?;
    if file.metadata().map_err(read)?.len() > limits.total {
        return Err(large);
    }
    let folder = TempDir::new().map_err(ArchiveError::Unpack)?;
    let mut archive = Archive::new(BufReader::new(file));
    // Raw entries, so that no extension of the format replaces a name or a size.
    for (number, entry) in archive.entries().map_err(read)?.raw(true).enumerate() {
        let mut entry = entry.map_err(read)?;
        if number >= limits.files {
            return Err(ArchiveError::Many { most: limits.files });
        }
        let bytes = entry.header().path_bytes().into_owned();
        let name = shorten(&String::from_utf8_lossy(&bytes));
        if let Some(folder_of_macos) = debris_folder(&bytes) {
            // Its folder is made, so that the entry shows that something was left out.
            let _ = std::fs::create_dir(folder.path().join(folder_of_macos));
            continue;
        }
        // Sparse files, links and long names have types of their own.
        if entry.header().entry_type() != EntryType::Regular {
            return Err(ArchiveError::NoFile { name });
        }
        let plain = plain_name(&bytes).ok_or_else(|| ArchiveError::Name { name: name.clone() })?;
        if entry.size() > limits.total {
            return Err(large);
        }
        let mode = entry.header().mode().map_err(read)?;
        let mut out = OpenOptions::new()
            .write(true)
            .create_new(true)
            .mode(MODES[usize::from(mode & 0o100 == 0)])
            .open(folder.path().join(plain))
            .map_err(|error| match error.kind() {
                std::io::ErrorKind::AlreadyExists => ArchiveError::Twice { name },
                _ => ArchiveError::Unpack(error),
            })?;
        let size = entry.size();
        let copied = std::io::copy(&mut entry.by_ref().take(size), &mut out).map_err(ArchiveError::Unpack)?;
        if copied != size {
            return Err(ArchiveError::Read("it ends too early".to_string()));
        }
    }
    Ok(folder)
}

/// The folder beside the files in which an archiver put what is no part of the entry.
fn debris_folder(bytes: &[u8]) -> Option<PathBuf> {
    let path = Path::new(std::ffi::OsStr::from_bytes(bytes));
    let mut parts = path.components().filter(|part| *part != Component::CurDir);
    let first = PathBuf::from(parts.next()?.as_os_str());
    let inside = parts.all(|part| matches!(part, Component::Normal(_)));
    (first.as_os_str() == "__MACOSX" && inside).then_some(first)
}

/// The name of a file that lies beside the others.
fn plain_name(bytes: &[u8]) -> Option<PathBuf> {
    let path = Path::new(std::ffi::OsStr::from_bytes(bytes));
    let mut parts = path.components().filter(|part| *part != Component::CurDir);
    match (parts.next(), parts.next()) {
        (Some(Component::Normal(name)), None) if !bytes.ends_with(b"/") && !bytes.contains(&0) => {
            Some(PathBuf::from(name))
        }
        _ => None,
    }
}

/// Writes an archive of some files, each by its name, and nothing else of them: equal files give equal
/// archives.
///
/// # Errors
/// If a file cannot be read, or the archive cannot be written.
pub fn pack(files: &[PathBuf], out: &mut File) -> std::io::Result<()> {
    let mut builder = Builder::new(BufWriter::new(out));
    for path in files {
        let file = File::open(path)?;
        let meta = file.metadata()?;
        let executable = meta.permissions().mode() & 0o100 != 0;
        let mut header = Header::new_ustar();
        header.set_size(meta.len());
        header.set_mode(MODES[usize::from(!executable)]);
        header.set_mtime(0);
        header.set_path(path.file_name().unwrap_or_default())?;
        header.set_cksum();
        builder.append(&header, file.take(meta.len()))?;
    }
    builder.into_inner()?.flush()
}

#[cfg(test)]
mod tests {
    use std::fs::Permissions;

    use super::*;

    const LIMITS: EntryLimits = EntryLimits { files: 3, results: 1 << 20, total: 1 << 20 };

    /// An archive of these headers and contents.
    fn archive(files: &[(EntryType, &[u8], &[u8])]) -> tempfile::NamedTempFile {
        let mut builder = Builder::new(Vec::new());
        for (kind, name, content) in files {
            let mut header = Header::new_ustar();
            header.set_entry_type(*kind);
            header.set_size(content.len() as u64);
            header.set_mode(0o644);
            header.as_mut_bytes()[..name.len()].copy_from_slice(name);
            header.set_cksum();
            builder.append(&header, *content).unwrap();
        }
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), builder.into_inner().unwrap()).unwrap();
        file
    }

    fn refusal(files: &[(EntryType, &[u8], &[u8])]) -> String {
        unpack(archive(files).path(), &LIMITS).unwrap_err().to_string()
    }

    #[test]
    fn plain_files_are_unpacked_side_by_side() {
        let file = archive(&[
            (EntryType::Regular, b"a.json", b"{}"),
            (EntryType::Regular, b"./b.mcap", b"log"),
            (EntryType::Regular, b"empty", b""),
        ]);
        let folder = unpack(file.path(), &LIMITS).unwrap();
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
        assert_eq!([read("a.json"), read("b.mcap"), read("empty")], ["{}", "log", ""]);
    }

    #[test]
    fn what_an_archiver_of_macos_adds_is_left_out() {
        let file = archive(&[
            (EntryType::Directory, b"__MACOSX/", b""),
            (EntryType::Regular, b"__MACOSX/._a.json", b"x"),
            (EntryType::Regular, b"a.json", b"{}"),
        ]);
        let folder = unpack(file.path(), &LIMITS).unwrap();
        let names = |folder: &Path| -> Vec<String> {
            let files = std::fs::read_dir(folder).unwrap();
            files.map(|file| file.unwrap().file_name().to_string_lossy().into_owned()).collect()
        };
        let mut found = names(folder.path());
        found.sort();
        assert_eq!(found, ["__MACOSX", "a.json"]);
        assert!(names(&folder.path().join("__MACOSX")).is_empty());
        let why = refusal(&[(EntryType::Regular, b"__MACOSX/../../x", b"x")]);
        assert!(why.contains("no plain name"), "{why}");
    }

    #[test]
    fn no_file_leaves_the_folder() {
        for name in ["/etc/x", "../x", "a/b", "..", "a/", ".", "a/../../x", "./../x"] {
            let why = refusal(&[(EntryType::Regular, name.as_bytes(), b"x")]);
            assert!(why.contains("no plain name"), "{name}: {why}");
        }
        let kinds = [
            EntryType::Symlink,
            EntryType::Link,
            EntryType::Directory,
            EntryType::Fifo,
            EntryType::Char,
            EntryType::Block,
            EntryType::GNUSparse,
            EntryType::GNULongName,
            EntryType::GNULongLink,
            EntryType::XHeader,
            EntryType::XGlobalHeader,
        ];
        for kind in kinds {
            let why = refusal(&[(kind, b"a", b"")]);
            assert!(why.contains("a in the archive is no ordinary file"), "{kind:?}: {why}");
        }
        let twice = [(EntryType::Regular, &b"a"[..], &b"1"[..]), (EntryType::Regular, b"./a", b"2")];
        assert_eq!(refusal(&twice), "./a is in the archive twice");
    }

    #[test]
    fn an_archive_has_limits() {
        let file = (EntryType::Regular, &b"a"[..], &b"x"[..]);
        let names: [&[u8]; 4] = [b"a", b"b", b"c", b"d"];
        assert_eq!(refusal(&names.map(|name| (file.0, name, file.2))), "the archive has more than 3 files");
        assert_eq!(refusal(&[(file.0, file.1, &vec![0; 2 << 20])]), "the archive is larger than 1 MiB");
        // A size that the archive does not have, and a cut archive.
        for cut in [0, 1] {
            let whole = archive(&[file]);
            let mut bytes = std::fs::read(whole.path()).unwrap();
            if cut == 0 {
                let mut header = Header::new_ustar();
                header.set_size(1 << 19);
                header.set_mode(0o644);
                header.set_path("a").unwrap();
                header.set_cksum();
                bytes[..512].copy_from_slice(header.as_bytes());
            } else {
                bytes.truncate(512);
            }
            std::fs::write(whole.path(), bytes).unwrap();
            let why = unpack(whole.path(), &LIMITS).unwrap_err().to_string();
            assert!(why.contains("cannot be read") || why.contains("unpacked"), "{cut}: {why}");
        }
        let noise = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(noise.path(), [7; 1024]).unwrap();
        assert!(unpack(noise.path(), &LIMITS).unwrap_err().to_string().contains("cannot be read"));
    }

    #[test]
    fn what_is_packed_is_unpacked_and_packing_twice_gives_equal_bytes() {
        let folder = TempDir::new().unwrap();
        let paths = ["agent", "x.json"].map(|name| folder.path().join(name));
        paths.iter().for_each(|path| std::fs::write(path, path.display().to_string()).unwrap());
        std::fs::set_permissions(&paths[0], Permissions::from_mode(0o700)).unwrap();
        let packed = [0, 1].map(|_| {
            let mut file = tempfile::NamedTempFile::new().unwrap();
            pack(&paths, file.as_file_mut()).unwrap();
            file
        });
        let [one, two] = [0, 1].map(|index| std::fs::read(packed[index].path()).unwrap());
        assert_eq!(one, two);
        let unpacked = unpack(packed[0].path(), &LIMITS).unwrap();
        for path in &paths {
            let copy = unpacked.path().join(path.file_name().unwrap());
            assert_eq!(std::fs::read(&copy).unwrap(), std::fs::read(path).unwrap());
        }
        let mode = unpacked.path().join("agent").metadata().unwrap().permissions().mode();
        assert!(mode & 0o100 != 0, "an agent can be started");
    }
}
