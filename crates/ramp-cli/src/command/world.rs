//! `ramp world`: lists the worlds and the values that an episode draws.

use std::fmt::Write;

use miette::{IntoDiagnostic, Report};
use ramp_data::Data;
use ramp_result::sha256;
use ramp_world::groups::GROUPS;
use ramp_world::{Field, Form, Quantity, Spread, World};
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
    /// List the worlds that are part of the program
    List,
    /// Print the quantities of a world, or the values that an episode draws
    Show {
        /// Name of a world, or a world file
        #[arg(default_value = "real")]
        name: String,
        /// Print the values that the episode with this seed draws
        #[arg(long)]
        seed: Option<u64>,
        /// Print the world as a file with all quantities, as a start for your own
        #[arg(long, conflicts_with_all = ["seed", "json"])]
        file: bool,
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let text = match &arguments.command {
        Command::List => list(),
        Command::Show { name, seed, file, json } => {
            let world = data.world(name)?;
            match (*json, *file) {
                (true, _) => serde_json::to_string_pretty(&as_json(&world, *seed)).into_diagnostic()? + "\n",
                (_, true) => world.to_toml(),
                _ => as_text(&world, *seed),
            }
        }
    };
    print(&text)?;
    Ok(DONE)
}

fn list() -> String {
    let mut text = String::new();
    for world in World::names().filter_map(World::shipped) {
        let _ = writeln!(text, "{:<11}  {}", world.name, world.about);
    }
    text
}

/// Formats numbers as text; equal numbers as one.
fn numbers(values: &[f64]) -> String {
    let one = |value: &f64| {
        let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(*value);
        rounded.to_string()
    };
    match values {
        [first, rest @ ..] if rest.iter().all(|it| it == first) => one(first),
        values => format!("[{}]", values.iter().map(one).collect::<Vec<_>>().join(", ")),
    }
}

/// Describes the distribution of a quantity as text.
fn said(field: &Field, quantity: &Quantity) -> String {
    let spread = match quantity.spread {
        Spread::Fixed => String::new(),
        Spread::Within(half) => format!(" ± {}", numbers(&[half])),
        Spread::Share(share) => format!(" ± {} %", numbers(&[100.0 * share])),
        Spread::Sigma(sigma) => format!(" (1 σ {})", numbers(&[sigma])),
    };
    format!("{}{spread} {}", numbers(&quantity.value), field.unit).trim_end().to_string()
}

fn as_text(world: &World, seed: Option<u64>) -> String {
    let mut text = format!("{}  {}\n", world.name, world.about);
    let drawn = seed.map(|seed| world.numbers(seed));
    let mut last = "";
    for (index, (group, field, quantity)) in world.quantities().enumerate() {
        if group != last {
            let about = GROUPS.iter().find(|(name, _, _)| *name == group).map_or("", |(_, about, _)| about);
            let _ = writeln!(text, "\n[{group}]  {}", about.trim());
            last = group;
        }
        match drawn.as_ref().and_then(|drawn| drawn.get(index)) {
            Some((_, _, values)) => {
                let value = format!("{} {}", numbers(values), field.unit);
                let _ = writeln!(text, "  {:<18}  {}", field.name, value.trim_end());
            }
            None => {
                let _ = writeln!(text, "  {:<18}  {}", field.name, said(field, quantity));
                let _ = writeln!(text, "  {:<18}    {}", "", field.meaning.trim());
                let _ = writeln!(text, "  {:<18}    Source: {}.", "", quantity.source.trim_end_matches('.'));
            }
        }
    }
    text
}

/// The length of a list of this form; `None` of a single number.
fn length(form: Form) -> Option<usize> {
    match form {
        Form::Number => None,
        Form::List(length) => Some(length),
        Form::Range => Some(2),
    }
}

fn as_json(world: &World, seed: Option<u64>) -> Value {
    let quantities: Vec<Value> = world
        .quantities()
        .map(|(group, field, quantity)| {
            let (kind, size) = match quantity.spread {
                Spread::Fixed => ("fixed", None),
                Spread::Within(size) => ("within", Some(size)),
                Spread::Share(size) => ("share", Some(size)),
                Spread::Sigma(size) => ("sigma", Some(size)),
            };
            json!({
                "name": format!("{group}.{}", field.name),
                "unit": field.unit,
                "meaning": field.meaning.trim(),
                "length": length(field.form),
                "least": field.least,
                "most": field.most,
                "value": quantity.value,
                "spread": {"kind": kind, "size": size},
                "source": quantity.source,
            })
        })
        .collect();
    let drawn = seed.map(|seed| {
        let numbers = world.numbers(seed).into_iter();
        numbers
            .map(|(group, field, values)| (format!("{group}.{field}"), json!(values)))
            .collect::<serde_json::Map<_, _>>()
    });
    json!({
        "name": world.name,
        "about": world.about,
        "sha256": sha256(world.text.as_bytes()),
        "quantities": quantities,
        "seed": seed,
        "drawn": drawn,
    })
}
