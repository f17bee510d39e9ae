//! `ramp goals open`: draws a set of the open class.

use std::fmt::Write;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};
use miette::{Report, miette};
use ramp_assembly::{Assembly, Class, Features, Generated, OpenGoal, OpenGoals, OpenSet, Size};
use ramp_data::Data;
use ramp_kit::source::read_text;
use ramp_planner::{Domains, State};
use ramp_result::secret::Secret;
use ramp_robot::arm::ArmModel;
use ramp_skills::rehearsal::plan_for_arm;

use super::seeds;
use crate::output::{print, write_file};
use crate::status::DONE;

/// Words that make the seed of a held-out set differ from all seeds of episodes, which name a goal and a
/// track.
const OF_A_SET: [&str; 2] = ["", "open"];

#[derive(clap::Args)]
pub struct Arguments {
    /// Seed of the set: 0 to 999 for training, 2000 to 2999 for tests; 2026 is the published test set
    #[arg(long, required_unless_present = "secret", conflicts_with = "secret")]
    seed: Option<u64>,
    /// Draw the held-out set of an organiser's secret instead, from `ramp seeds commit`
    #[arg(long, value_name = "FILE")]
    secret: Option<PathBuf>,
    /// Folder to write the goal files to
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Overwrite existing files
    #[arg(long)]
    force: bool,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let secret = arguments.secret.as_deref().map(seeds::read).transpose()?;
    let (set, seed) = match (&secret, arguments.seed) {
        (Some(secret), _) => held(secret),
        (None, seed) => {
            let seed = seed.unwrap_or_default();
            (OpenSet::Seed(seed), seed)
        }
    };
    let class = Class::Open(set);
    // A published set never changes, whatever the program draws.
    let is_published = secret.is_none() && !data.has_own_kit() && data.open_sets()?.contains(&class);
    let goals = if is_published { published(data, class)? } else { draw(data, class, seed)? };
    if let Some(folder) = &arguments.output {
        // Check for existing files first, so that either all files are written or none.
        for it in &goals {
            let file = file(folder, it);
            if !arguments.force
                && file.exists()
                && read_text(&file, it.goal.goal.len()).ok().as_ref() != Some(&it.goal.goal)
            {
                return Err(miette!(
                    help = "--force overwrites it",
                    "{} is there already, and is another file",
                    file.display()
                ));
            }
        }
        for it in &goals {
            write_file(&file(folder, it), &it.goal.goal)?;
        }
    }
    print(&table(&goals))?;
    Ok(DONE)
}

/// The held-out set of a secret, and its seed. The set is named by the secret's commitment, which is public.
fn held(secret: &Secret) -> (OpenSet, u64) {
    let begin = u32::from_str_radix(&secret.commitment()[..8], 16).unwrap_or_default();
    let [goal, track] = OF_A_SET;
    (OpenSet::Held(begin), secret.seed(goal, track, 0))
}

/// A set of the data.
fn published(data: &Data, set: Class) -> Result<Vec<OpenGoal>, Report> {
    let mut goals = Vec::new();
    for name in data.open_goal_names(set)? {
        let (assembly, texts) = data.goal_with_texts(&name)?;
        let size =
            Size::of_goal_name(&name).ok_or_else(|| miette!("the goal {name} has no size in its name"))?;
        let features = Features::of(&assembly);
        let goal = Generated { name, goal: texts.sources().goal.to_string(), kit: None, assembly };
        goals.push(OpenGoal { goal, size, features });
    }
    Ok(goals)
}

/// Draws a set with the kit of the data. The rules and the arm are the built-in ones, so that a set depends
/// on its seed and the kit only.
fn draw(data: &Data, set: Class, seed: u64) -> Result<Vec<OpenGoal>, Report> {
    let built_in = Data::built_in();
    let names = built_in.goal_names()?;
    let known = names.iter().map(|name| built_in.goal(name)).collect::<Result<Vec<Assembly>, _>>()?;
    let (domains, arm) = (built_in.domains(None, None)?, built_in.arm()?);
    let mut open = OpenGoals::new(data.kit()?, set, seed, &known)?;
    let bar = std::io::stderr().is_terminal().then(|| ProgressBar::new(OpenGoals::COUNT as u64));
    if let (Some(bar), Ok(style)) =
        (&bar, ProgressStyle::with_template("{bar:24} {pos}/{len} goals  {elapsed}"))
    {
        bar.set_style(style);
    }
    let mut goals = Vec::new();
    while let Some(goal) = open.next_goal(&mut |goal| can_be_built(goal, &domains, &arm))? {
        goals.push(goal);
        if let Some(bar) = &bar {
            bar.inc(1);
        }
    }
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    Ok(goals)
}

/// Whether a goal has a plan whose rehearsal the arm passes.
fn can_be_built(goal: &Assembly, domains: &Domains, arm: &ArmModel) -> bool {
    plan_for_arm(goal, arm, &State::default(), domains).is_ok()
}

fn file(folder: &Path, it: &OpenGoal) -> PathBuf {
    folder.join(format!("{}.xml", it.goal.name))
}

/// The features of each goal, and their means over each size.
fn table(goals: &[OpenGoal]) -> String {
    let width = goals.iter().map(|it| it.goal.name.len()).max().unwrap_or_default();
    let mut text = format!("{:<width$}", "goal");
    for name in COLUMNS {
        let _ = write!(text, "  {name}");
    }
    text.push('\n');
    for it in goals {
        let _ = write!(text, "{:<width$}", it.goal.name);
        for (name, number) in COLUMNS.iter().zip(numbers(&it.features)) {
            let width = name.len();
            let _ = write!(text, "  {number:>width$}");
        }
        text.push('\n');
    }
    for size in Size::ALL {
        let of_size: Vec<[usize; 8]> =
            goals.iter().filter(|it| it.size == size).map(|it| numbers(&it.features)).collect();
        let _ = write!(text, "{:<width$}", format!("mean of {}", size.name()));
        for (column, name) in COLUMNS.iter().enumerate() {
            let sum: usize = of_size.iter().map(|it| it[column]).sum();
            let mean = sum as f64 / of_size.len().max(1) as f64;
            let width = name.len();
            let _ = write!(text, "  {mean:>width$.1}");
        }
        text.push('\n');
    }
    text
}

/// The columns of the table.
const COLUMNS: [&str; 8] =
    ["beams", "pegs", "oblique", "through", "caps", "loops", "directions", "joint types"];

/// The features in the order of the columns.
fn numbers(it: &Features) -> [usize; 8] {
    [it.beams, it.pegs, it.oblique, it.through, it.caps, it.loops, it.directions, it.joint_types]
}
