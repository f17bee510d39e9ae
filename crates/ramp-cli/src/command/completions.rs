//! `ramp completions`: the script with which a shell completes commands and options.

use clap_complete::Shell;
use miette::Report;

use crate::output::print;
use crate::status::DONE;

#[derive(clap::Args)]
pub struct Arguments {
    /// The shell
    shell: Shell,
}

pub fn run(arguments: &Arguments, mut program: clap::Command) -> Result<u8, Report> {
    let mut bytes = Vec::new();
    clap_complete::generate(arguments.shell, &mut program, "ramp", &mut bytes);
    print(&String::from_utf8_lossy(&bytes))?;
    Ok(DONE)
}
