//! `ramp start`: lists the starts, and prints one.

use std::fmt::Write;

use miette::{IntoDiagnostic, Report};
use ramp_data::Data;
use ramp_result::sha256;
use ramp_world::Start;
use serde_json::{Value, json};

use crate::output::print;
use crate::status::DONE;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    /// List the starts that are part of the program
    List,
    /// Print the quantities of a start
    Show {
        /// Name of a start, or a start file
        #[arg(default_value = "moved")]
        name: String,
        /// Print the file, to change it into your own
        #[arg(long, conflicts_with = "json")]
        file: bool,
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let text = match &arguments.command {
        Command::List => list(),
        Command::Show { name, file, json } => {
            let start = data.start(name)?;
            match (*json, *file) {
                (true, _) => serde_json::to_string_pretty(&as_json(&start)).into_diagnostic()? + "\n",
                (_, true) => start.text.clone(),
                _ => as_text(&start),
            }
        }
    };
    print(&text)?;
    Ok(DONE)
}

fn list() -> String {
    let mut text = String::new();
    for start in Start::names().filter_map(Start::shipped) {
        let _ = writeln!(text, "{:<9}  {}", start.name, start.about);
    }
    text
}

fn as_text(start: &Start) -> String {
    let mut text = format!("{}  {}\n\n", start.name, start.about);
    for (field, quantity) in start.quantities() {
        let Some(quantity) = quantity else { continue };
        let round = |value: &f64| format!("{value:.4e}").parse().unwrap_or(*value).to_string();
        let numbers: Vec<String> = quantity.value.iter().map(round).collect();
        let value = format!("{} {}", numbers.join(" to "), field.unit);
        let _ = writeln!(text, "  {:<10}  {}", field.name, value.trim_end());
        let _ = writeln!(text, "  {:<10}    {}", "", field.meaning.trim());
        let _ = writeln!(text, "  {:<10}    Source: {}.", "", quantity.source.trim_end_matches('.'));
    }
    text
}

fn as_json(start: &Start) -> Value {
    let quantities: Vec<Value> = start
        .quantities()
        .filter_map(|(field, quantity)| {
            let quantity = quantity?;
            let value = match quantity.value[..] {
                [value] => json!(value),
                ref numbers => json!(numbers),
            };
            Some(json!({
                "name": field.name,
                "unit": field.unit,
                "meaning": field.meaning.trim(),
                "least": field.least,
                "most": field.most,
                "value": value,
                "source": quantity.source,
            }))
        })
        .collect();
    json!({
        "name": start.name,
        "about": start.about,
        "sha256": sha256(start.text.as_bytes()),
        "quantities": quantities,
    })
}
