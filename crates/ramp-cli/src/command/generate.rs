//! `ramp goals generate`: generates new goals and checks each.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use miette::{Report, miette};
use ramp_assembly::{Generated, Request, generate_many};
use ramp_data::Data;
use ramp_kit::source::read_text;

use crate::output::{print, write_file};
use crate::status::DONE;

#[derive(clap::Args)]
pub struct Arguments {
    /// Beams in each goal, with the clamped one; if the kit has fewer, the goal is a frame with a kit of its
    /// own
    #[arg(long, default_value_t = 5, value_name = "N")]
    beams: usize,
    /// Seed of the first goal; the next goals have the next seeds
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Generate goals of this class only
    #[arg(long)]
    class: Option<Class>,
    /// Number of goals, all different
    #[arg(long, default_value_t = 1, value_name = "N")]
    count: usize,
    /// Folder to write the files to; without it a single goal goes to standard output
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Overwrite existing files
    #[arg(long)]
    force: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum Class {
    Easy,
    Medium,
    Hard,
}

impl From<Class> for ramp_assembly::Class {
    fn from(class: Class) -> Self {
        match class {
            Class::Easy => ramp_assembly::Class::Easy,
            Class::Medium => ramp_assembly::Class::Medium,
            Class::Hard => ramp_assembly::Class::Hard,
        }
    }
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let kit = data.kit()?;
    let request = Request {
        beams: arguments.beams,
        seed: arguments.seed,
        class: arguments.class.map(ramp_assembly::Class::from),
    };
    let made = generate_many(kit, request, arguments.count)?;
    let Some(folder) = &arguments.output else {
        let [goal] = made.as_slice() else {
            return Err(miette!(help = "name a folder with -o", "more than one goal needs a folder"));
        };
        if goal.kit.is_some() {
            return Err(miette!(
                help = "name a folder for both with -o",
                "a goal of {} beams comes with a kit file of its own",
                arguments.beams
            ));
        }
        print(&goal.goal)?;
        return Ok(DONE);
    };
    let files: Vec<(PathBuf, &str)> = made.iter().flat_map(|goal| files(folder, goal)).collect();
    // Check for existing files first, so that either all files are written or none.
    if let Some((file, _)) = files.iter().find(|(file, text)| !arguments.force && differs(file, text)) {
        return Err(miette!(
            help = "--force overwrites it",
            "{} is there already, and is another file",
            file.display()
        ));
    }
    let mut list = String::new();
    for (file, text) in files {
        write_file(&file, text)?;
        list.push_str(&format!("{}\n", file.display()));
    }
    print(&list)?;
    Ok(DONE)
}

fn files<'a>(folder: &Path, made: &'a Generated) -> Vec<(PathBuf, &'a str)> {
    let goal = (folder.join(format!("{}.xml", made.name)), made.goal.as_str());
    let kit = made.kit.as_ref().map(|kit| (folder.join(format!("{}-kit.xml", made.name)), kit.as_str()));
    std::iter::once(goal).chain(kit).collect()
}

/// Returns true if the file exists with other content.
fn differs(file: &Path, text: &str) -> bool {
    file.exists() && read_text(file, text.len()).ok().as_deref() != Some(text)
}
