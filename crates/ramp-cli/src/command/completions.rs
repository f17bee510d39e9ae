//! `ramp completions`: the script with which a shell completes commands, options and names. It asks
//! this program for each word.

use clap_complete::Shell;
use clap_complete::env::Shells;
use miette::{IntoDiagnostic, Report, miette};

use crate::completion::VARIABLE;
use crate::output::print;
use crate::status::DONE;

#[derive(clap::Args)]
pub struct Arguments {
    /// The shell
    shell: Shell,
}

pub fn run(arguments: &Arguments) -> Result<u8, Report> {
    let shell = arguments.shell.to_string();
    let shells = Shells::builtins();
    let script = shells.completer(&shell).ok_or_else(|| miette!("there is no script for {shell}"))?;
    let mut bytes = Vec::new();
    script.write_registration(VARIABLE, "ramp", "ramp", "ramp", &mut bytes).into_diagnostic()?;
    print(&String::from_utf8_lossy(&bytes))?;
    Ok(DONE)
}
