//! `ramp show`: a goal as a picture.

use std::path::PathBuf;

use miette::{IntoDiagnostic, Report, miette};

use crate::DONE;
use crate::data::{Data, check_writable, print};

/// Width of a PNG, pixels.
const WIDTH: u32 = 1600;

#[derive(clap::Args)]
pub struct Arguments {
    /// Name of a goal, or a goal file
    goal: String,
    /// File to write, .svg or .png; without it SVG goes to standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let kit = data.kit()?;
    let goal = data.goal(&arguments.goal, &kit)?;
    let Some(path) = &arguments.output else {
        print(&ramp_assembly::draw_svg(&goal))?;
        return Ok(DONE);
    };
    check_writable(path)?;
    let bytes = match path.extension().and_then(|ending| ending.to_str()) {
        Some("svg") => ramp_assembly::draw_svg(&goal).into_bytes(),
        Some("png") => ramp_assembly::draw::draw_png(&goal, WIDTH).into_diagnostic()?,
        _ => {
            return Err(miette!(
                help = "end the file's name in .svg or .png",
                "{} is neither an SVG nor a PNG file",
                path.display()
            ));
        }
    };
    std::fs::write(path, bytes).into_diagnostic()?;
    eprintln!("{}: {}", goal.name, path.display());
    Ok(DONE)
}
