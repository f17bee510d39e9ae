//! Shared by the build scripts of programs that write results: the commit from which they are built.

use std::path::Path;
use std::process::Command;

/// Parts of each crate that are built in, if they exist.
const OF_A_CRATE: [&str; 3] = ["src", "Cargo.toml", "build.rs"];
/// Further paths that are built in.
const BUILT_IN: [&str; 5] = ["data", "tools/commit.rs", "Cargo.toml", "Cargo.lock", ".cargo"];

/// Sets `RAMP_COMMIT`: the commit, followed by `-dirty` if these files were modified, or `unknown`.
pub fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let crates = std::fs::read_dir(root.join("crates")).into_iter().flatten().flatten();
    let parts =
        crates.flat_map(|it| OF_A_CRATE.map(|part| format!("crates/{}/{part}", it.file_name().display())));
    let parts = parts.filter(|path| root.join(path).exists());
    let built_in: Vec<String> = parts.chain(BUILT_IN.map(String::from)).collect();
    for path in built_in.iter().map(String::as_str).chain([".git/logs/HEAD"]) {
        println!("cargo::rerun-if-changed=../../{path}");
    }
    let git = |arguments: &[&str], paths: &[String]| {
        let output = Command::new("git").current_dir(&root).args(arguments).args(paths).output().ok()?;
        let text = String::from_utf8(output.stdout).ok().filter(|_| output.status.success())?;
        Some(text.trim().to_string())
    };
    let mut commit = git(&["rev-parse", "--short=12", "HEAD"], &[]).unwrap_or_else(|| "unknown".into());
    if git(&["--no-optional-locks", "status", "--porcelain", "--"], &built_in)
        .is_some_and(|changed| !changed.is_empty())
    {
        commit.push_str("-dirty");
    }
    println!("cargo::rustc-env=RAMP_COMMIT={commit}");
}
