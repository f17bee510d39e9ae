//! The Python behind `python3`, and its packages.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Prints the program, then the folders of its library and packages, one a line.
const ASK: &str = "import sys, site, os
print(os.path.realpath(sys.executable) if sys.prefix == sys.base_prefix else sys.executable)
for path in [sys.prefix, sys.base_prefix, sys.exec_prefix, *site.getsitepackages(), site.getusersitepackages()]:
    print(path)";

/// The program and the folders that it reads.
///
/// # Errors
/// The reason, in words.
pub fn find() -> Result<(OsString, Vec<PathBuf>), String> {
    let output = Command::new("python3")
        .args(["-c", ASK])
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .output()
        .map_err(|error| error.to_string())?;
    let text = String::from_utf8(output.stdout).map_err(|_| "a path that is no text".to_string())?;
    let mut lines = text.lines();
    match lines.next() {
        Some(program) if output.status.success() => Ok((program.into(), lines.map(PathBuf::from).collect())),
        _ => Err(format!("it ended with {}", output.status)),
    }
}
