//! `ramp show`: draws one goal or all goals.

use std::io::IsTerminal;
use std::path::PathBuf;

use miette::{IntoDiagnostic, Report, miette};
use ramp_assembly::Class;
use ramp_data::Data;

use crate::output::{check_place, print, tell, write_file};
use crate::status::DONE;

/// Width of a PNG, pixels.
const WIDTH: u32 = 1600;

#[derive(clap::Args)]
pub struct Arguments {
    /// Name of a goal, a goal file, or a set of the open class such as open-2026
    #[arg(required_unless_present = "all")]
    goal: Option<String>,
    /// All goals of the data folder on one sheet
    #[arg(long, conflicts_with = "goal")]
    all: bool,
    /// File to write, .svg or .png [default: SVG to standard output, unless that is a terminal]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let names = match &arguments.goal {
        Some(goal) => match Class::of_name(goal).filter(|class| class.is_open()) {
            Some(set) => data.open_goal_names(set)?,
            None => vec![goal.clone()],
        },
        None => data.goal_names()?,
    };
    let goals = names.iter().map(|name| data.goal(name)).collect::<Result<Vec<_>, _>>()?;
    let svg = match goals.as_slice() {
        [goal] if !arguments.all => ramp_assembly::draw_svg(goal),
        goals => ramp_assembly::draw_all_svg(goals),
    };
    let Some(path) = &arguments.output else {
        if std::io::stdout().is_terminal() {
            return Err(miette!(
                help = "name a file with -o FILE.svg or -o FILE.png, or send standard output to a file",
                "an SVG is not for a terminal"
            ));
        }
        print(&svg)?;
        return Ok(DONE);
    };
    check_place(path)?;
    let bytes = match path.extension().and_then(|ending| ending.to_str()) {
        Some("svg") => svg.into_bytes(),
        Some("png") => match goals.as_slice() {
            [goal] if !arguments.all => ramp_assembly::draw::draw_png(goal, WIDTH).into_diagnostic()?,
            goals => ramp_assembly::draw::draw_all_png(goals, 2 * WIDTH).into_diagnostic()?,
        },
        _ => {
            return Err(miette!(
                help = "end the file's name in .svg or .png",
                "{} is neither an SVG nor a PNG file",
                path.display()
            ));
        }
    };
    write_file(path, bytes)?;
    tell(&format!("{}: {}", names.join(", "), path.display()));
    Ok(DONE)
}
