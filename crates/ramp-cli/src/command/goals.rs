//! `ramp goals`: lists the known goals and generates new ones.

use std::fmt::Write;

use miette::{IntoDiagnostic, Report};
use ramp_data::Data;
use serde_json::json;

use crate::output::print;
use crate::status::DONE;

#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Generate new goals, and check that each can be built; the same seed gives the same file
    Generate(super::generate::Arguments),
    /// Draw a set of the open class: 60 goals, 20 each of small, medium and large
    Open(super::open::Arguments),
    /// Commit to goals without showing them: one file to publish now, one with the goals to publish later
    Commit(super::held_out::CommitArguments),
    /// Check revealed goals against their commitments
    Verify(super::held_out::VerifyArguments),
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    match &arguments.command {
        Some(Command::Generate(arguments)) => return super::generate::run(data, arguments),
        Some(Command::Open(arguments)) => return super::open::run(data, arguments),
        Some(Command::Commit(arguments)) => return super::held_out::commit(data, arguments),
        Some(Command::Verify(arguments)) => return super::held_out::check(arguments),
        None => {}
    }
    // A faulty kit is reported before a missing folder of goals.
    data.kit()?;
    let mut rows = Vec::new();
    for name in data.goal_names()? {
        rows.push(data.goal(&name)?);
    }
    let mut text = String::new();
    if arguments.json {
        let list: Vec<_> = rows
            .iter()
            .map(|goal| {
                json!({
                    "name": goal.name,
                    "class": goal.class.map(ramp_assembly::Class::name),
                    "beams": goal.beams.iter().map(|placed| &placed.beam.name).collect::<Vec<_>>(),
                    "pegs": goal.connections.len(),
                })
            })
            .collect();
        text = serde_json::to_string_pretty(&list).into_diagnostic()?;
        text.push('\n');
    } else {
        let _ =
            writeln!(text, "{:<10} {:<7} {:>5} {:>5}  names of the beams", "goal", "class", "beams", "pegs");
        for goal in &rows {
            let names: Vec<&str> = goal.beams.iter().map(|placed| placed.beam.name.as_str()).collect();
            let class = goal.class.map_or("-".to_string(), ramp_assembly::Class::name);
            let _ = writeln!(
                text,
                "{:<10} {class:<7} {:>5} {:>5}  {}",
                goal.name,
                names.len(),
                goal.connections.len(),
                names.join(" ")
            );
        }
    }
    print(&text)?;
    Ok(DONE)
}
