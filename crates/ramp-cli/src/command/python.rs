//! Modules of the Python package that a command starts.

use std::ffi::{OsStr, OsString};
use std::process::Command;

use miette::{Report, miette};
use ramp_data::Data;
use ramp_kit::source::plain;

use crate::status::{BAD_INPUT, STOPPED_BY};

/// Environment variable that names the Python with the package. The `ramp` command of the package sets it.
const PYTHON: &str = "RAMP_PYTHON";

/// The longest text of a version in a message, characters.
const LONGEST_VERSION: usize = 40;

/// Runs a module of the package, which needs these extras of it, with these arguments; its exit status.
///
/// # Errors
/// If there is no Python, or no package of this version in it.
pub fn run(data: &Data, module: &str, extras: &str, arguments: &[OsString]) -> Result<u8, Report> {
    let python = std::env::var_os(PYTHON).unwrap_or_else(|| "python3".into());
    let missing = |why: &str| missing(&python, extras, why);
    check(&python, module, missing)?;
    let mut command = Command::new(&python);
    command.arg("-m").arg(module).args(arguments);
    let words = data.arguments();
    for pair in words.chunks(2) {
        match pair {
            [option, folder] if option == "--data" => drop(command.env("RAMP_DATA", folder)),
            _ => return Err(miette!("`--kit` has no effect on the Python package; use `--data`")),
        }
    }
    let status = command.status().map_err(|error| missing(&error.to_string()))?;
    Ok(status.code().map_or_else(|| stopped(status), |code| u8::try_from(code).unwrap_or(BAD_INPUT)))
}

/// The exit status for a program that a signal has stopped.
fn stopped(status: std::process::ExitStatus) -> u8 {
    use std::os::unix::process::ExitStatusExt;
    STOPPED_BY + status.signal().and_then(|signal| u8::try_from(signal).ok()).unwrap_or_default()
}

/// Checks that the package is there, in this version.
fn check(python: &OsStr, module: &str, missing: impl Fn(&str) -> Report) -> Result<(), Report> {
    let tell = format!("import ramp, {module}; print(ramp.__version__)");
    let found = Command::new(python).args(["-c", &tell]).output();
    let output = found.map_err(|error| missing(&error.to_string()))?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr);
        return Err(missing(text.lines().last().unwrap_or_default()));
    }
    let theirs = String::from_utf8_lossy(&output.stdout);
    let (theirs, ours) = (theirs.trim(), env!("CARGO_PKG_VERSION"));
    if theirs == ours {
        return Ok(());
    }
    Err(miette!(
        help = "install the package of this version, or let RAMP_PYTHON name a Python that has it",
        "the Python package of {} is of version {}, and this program is {ours}",
        python.display(),
        plain(theirs, LONGEST_VERSION)
    ))
}

fn missing(python: &OsStr, extras: &str, why: &str) -> Report {
    miette!(
        help =
            format!("install it: pip install 'ramp-benchmark[{extras}]'; RAMP_PYTHON names another Python"),
        "this command needs the Python package of RAMP, and {} does not have it: {why}",
        python.display()
    )
}
