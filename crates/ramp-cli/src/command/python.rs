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

/// A module of the package.
pub struct Module {
    /// Its name.
    pub name: &'static str,
    /// Modules that it needs, of which other packages consist, separated by commas.
    pub needs: &'static str,
    /// The extras of the package that install those.
    pub extra: &'static str,
}

/// Makes and plays data sets. It says itself what a format needs.
pub const DEMOS: Module = Module { name: "ramp.demos", needs: "ramp", extra: "data" };

/// Lets a person drive the arm. It says itself what a window needs.
pub const TELEOP: Module = Module { name: "ramp.teleop", needs: "ramp", extra: "data,teleop" };

/// Runs this program on a cluster.
pub const RAY: Module = Module { name: "ramp.ray", needs: "ray", extra: "ray" };

/// Runs a module with these arguments; its exit status.
///
/// # Errors
/// If there is no Python, or no package of this version in it.
pub fn run(data: &Data, module: &Module, arguments: &[OsString]) -> Result<u8, Report> {
    let mut command = command(module)?;
    command.args(arguments);
    let words = data.arguments();
    for pair in words.chunks(2) {
        match pair {
            [option, folder] if option == "--data" => drop(command.env("RAMP_DATA", folder)),
            _ => return Err(miette!("`--kit` has no effect on the Python package; use `--data`")),
        }
    }
    let status = command.status().map_err(|error| missing(module, &python(), &error.to_string()))?;
    Ok(status.code().map_or_else(|| stopped(status), |code| u8::try_from(code).unwrap_or(BAD_INPUT)))
}

/// The command that runs a module.
///
/// # Errors
/// If there is no Python, or no package of this version in it, or the extra is missing.
pub fn command(module: &Module) -> Result<Command, Report> {
    let python = python();
    check(module, &python)?;
    let mut command = Command::new(&python);
    command.arg("-m").arg(module.name);
    Ok(command)
}

/// The Python that has the package.
fn python() -> OsString {
    std::env::var_os(PYTHON).unwrap_or_else(|| "python3".into())
}

/// The exit status for a program that a signal has stopped.
fn stopped(status: std::process::ExitStatus) -> u8 {
    use std::os::unix::process::ExitStatusExt;
    STOPPED_BY + status.signal().and_then(|signal| u8::try_from(signal).ok()).unwrap_or_default()
}

/// Checks that the package is there, in this version.
fn check(module: &Module, python: &OsStr) -> Result<(), Report> {
    let tell = format!("import ramp, {}, {}; print(ramp.__version__)", module.name, module.needs);
    let found = Command::new(python).args(["-c", &tell]).output();
    let output = found.map_err(|error| missing(module, python, &error.to_string()))?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr);
        return Err(missing(module, python, text.lines().last().unwrap_or_default()));
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

fn missing(module: &Module, python: &OsStr, why: &str) -> Report {
    miette!(
        help = format!(
            "install it: pip install 'ramp-benchmark[{}]'; RAMP_PYTHON names another Python",
            module.extra
        ),
        "this command needs the Python package of RAMP, and {} does not have it: {why}",
        python.display()
    )
}
