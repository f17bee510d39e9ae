//! `ramp data export`: the built-in kit, goals, domains and arms as files.

use std::path::PathBuf;

use miette::{Report, miette};
use ramp_data::built_in;
use ramp_kit::source::read_text;

use crate::output::{print, write_file};
use crate::status::DONE;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Write the files to a folder, which `--data` or RAMP_DATA then names
    Export {
        /// Folder to write to
        folder: PathBuf,
        /// Overwrite existing files that differ
        #[arg(long)]
        force: bool,
    },
}

pub fn run(arguments: &Arguments) -> Result<u8, Report> {
    let Command::Export { folder, force } = &arguments.command;
    let files = || built_in().iter().map(|(name, text)| (folder.join(name), *text));
    // Check for existing files first, so that either all files are written or none.
    let differs = |(file, text): &(PathBuf, &str)| {
        file.exists() && read_text(file, text.len()).ok().as_deref() != Some(*text)
    };
    if let Some((file, _)) = files().find(|it| !force && differs(it)) {
        return Err(miette!(help = "--force overwrites it", "{} is another file", file.display()));
    }
    let mut list = String::new();
    for (file, text) in files() {
        write_file(&file, text)?;
        list.push_str(&format!("{}\n", file.display()));
    }
    print(&list)?;
    Ok(DONE)
}
