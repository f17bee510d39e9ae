//! `ramp kit export`: the files with which a lab makes the parts.

use std::path::PathBuf;

use miette::Report;
use ramp_data::Data;

use crate::output::print;
use crate::status::{BAD_INPUT, DONE};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Write STL, 3MF, plates, bill of parts, start sheet, tags and assembly guide
    Export {
        /// Folder to write to
        #[arg(required_unless_present = "output", value_name = "DIR")]
        folder: Option<PathBuf>,
        /// The same, as an option
        #[arg(short, long, value_name = "DIR", conflicts_with = "folder")]
        output: Option<PathBuf>,
        /// Overwrite files that an export did not write, or that were changed since
        #[arg(long)]
        force: bool,
    },
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let Command::Export { folder, output, force } = &arguments.command;
    let Some(folder) = folder.as_ref().or(output.as_ref()) else { return Ok(BAD_INPUT) };
    let written = ramp_kit::export::export(data.kit()?, folder, *force)?;
    let list: String = written.iter().map(|file| format!("{}\n", file.display())).collect();
    print(&list)?;
    Ok(DONE)
}
