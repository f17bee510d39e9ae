//! Builds in the data folder.

use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Writes `built_in.rs`: the path and the text of every file of the data folder.
fn main() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let mut files = Vec::new();
    list(&data, &mut files);
    files.sort();
    let mut text = "const BUILT_IN: &[(&str, &str)] = &[\n".to_string();
    for file in &files {
        let name = file.strip_prefix(&data).unwrap_or(file).display().to_string();
        let _ = writeln!(text, "    ({name:?}, include_str!({:?})),", file.display().to_string());
    }
    text.push_str("];\n");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").unwrap_or_default()).join("built_in.rs");
    if let Err(error) = std::fs::write(&out, text) {
        println!("cargo::error={} cannot be written: {error}", out.display());
    }
}

/// Adds the files of a folder and those in it.
fn list(folder: &Path, files: &mut Vec<PathBuf>) {
    println!("cargo::rerun-if-changed={}", folder.display());
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            list(&path, files);
        } else {
            files.push(path);
        }
    }
}
