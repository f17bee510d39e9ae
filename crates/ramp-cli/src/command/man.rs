//! `ramp man`: writes the manual pages, one for each command.

use std::path::PathBuf;

use miette::{Report, miette};

use crate::output::print;
use crate::status::DONE;

#[derive(clap::Args)]
pub struct Arguments {
    /// Folder to write them to, such as ~/.local/share/man/man1; made if it is not there
    folder: PathBuf,
}

pub fn run(arguments: &Arguments, program: clap::Command) -> Result<u8, Report> {
    let folder = &arguments.folder;
    let fail = |error: std::io::Error| miette!("cannot write to {}: {error}", folder.display());
    std::fs::create_dir_all(folder).map_err(fail)?;
    clap_mangen::generate_to(program, folder).map_err(fail)?;
    print(&format!("manual pages: {}\n", folder.display()))?;
    Ok(DONE)
}
