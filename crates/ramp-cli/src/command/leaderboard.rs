//! `ramp leaderboard`: results of many as a static site, each run again from its log before it goes on it.

use std::path::{Path, PathBuf};

use indicatif::ProgressBar;
use miette::{IntoDiagnostic, Report as Failure, miette};
use ramp_log::{ENDING, Log};
use ramp_report::leaderboard::{Goal, Terms, agent_page, check_log, check_whole, front};
use ramp_report::{Report, page};
use ramp_result::collection::{Collection, ResultFile, collect};
use ramp_result::write_whole;
use ramp_twin::Disturbance;

use crate::data::Data;
use crate::output::print;
use crate::status::{DONE, INCOMPLETE};

#[derive(clap::Args)]
pub struct Arguments {
    /// Folder of results, or of folders of results, each with its log beside it
    folder: PathBuf,
    /// Folder for the site; made if it is not there
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Failure> {
    let folders = folders(&arguments.folder)?;
    let terms = terms(data)?;
    let mut admitted: Vec<PathBuf> = Vec::new();
    let mut refused = String::new();
    let mut count = 0;
    let bar = ProgressBar::new(0);
    for folder in folders {
        match admit(&admitted, &folder, &terms, &bar) {
            Ok(episodes) => {
                count += episodes;
                admitted.push(folder);
            }
            // One entry that is wrong is left out, and the others go on the board all the same.
            Err(why) => {
                let why = bar.suspend(|| format!("{why:?}"));
                refused.push_str(&format!("refused {}: {}\n", folder.display(), why.trim()));
            }
        }
    }
    bar.finish_and_clear();
    print(&refused)?;
    if admitted.is_empty() {
        return Ok(INCOMPLETE);
    }
    let agents = write_site(collect(&admitted)?, &arguments.output)?;
    print(&format!(
        "{count} episodes run again, equal to the last bit; {agents} {}: {}\n",
        if agents == 1 { "agent" } else { "agents" },
        arguments.output.join("index.html").display()
    ))?;
    Ok(if refused.is_empty() { DONE } else { INCOMPLETE })
}

/// May a folder go on the board beside those that are on it? Runs each of its episodes again. How many they are.
fn admit(admitted: &[PathBuf], folder: &Path, terms: &Terms, bar: &ProgressBar) -> Result<usize, Failure> {
    let own = collect(&[folder.to_path_buf()])?;
    check_whole(&own, terms).into_diagnostic()?;
    let files: Vec<&ResultFile> = own
        .entrants
        .iter()
        .flat_map(|entrant| &entrant.files)
        .filter(|file| file.result.real.is_none())
        .collect();
    bar.inc_length(files.len() as u64);
    for file in &files {
        let log = log_of(file)?;
        check_log(file, &log, terms).into_diagnostic()?;
        let replayed = ramp_episode::replay(&log)
            .map_err(|error| miette!("{} cannot be run again: {error}", file.path.display()))?;
        if let Some(first) = replayed.differences.first() {
            return Err(miette!(
                "{} does not replay: at {:.3} s, {} is {} in the log and {} in the replay",
                file.path.display(),
                first.time,
                first.what,
                first.logged,
                first.replayed
            ));
        }
        bar.inc(1);
    }
    // The same goal and seed of an agent may not come twice.
    collect(&admitted.iter().cloned().chain([folder.to_path_buf()]).collect::<Vec<_>>())?;
    Ok(files.len())
}

/// The folder itself where it holds results, and those in it that do.
fn folders(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let entries =
        std::fs::read_dir(folder).map_err(|error| miette!("{} cannot be read: {error}", folder.display()))?;
    let has_json = |folder: &Path| {
        std::fs::read_dir(folder).is_ok_and(|entries| {
            entries.flatten().any(|entry| entry.path().extension().is_some_and(|ending| ending == "json"))
        })
    };
    let mut inner: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    inner.retain(|path| path.is_dir() && has_json(path));
    inner.sort();
    if has_json(folder) || inner.is_empty() {
        inner.insert(0, folder.to_path_buf());
    }
    Ok(inner)
}

fn terms(data: &Data) -> Result<Terms, Failure> {
    let kit = data.kit()?;
    let mut goals = Vec::new();
    let mut files = None;
    for name in data.goal_names()? {
        let goal = data.goal(&name, &kit)?;
        let texts = data.texts(&name)?;
        let sources = texts.sources();
        files = Some((sources.kit.to_string(), sources.arm.to_string()));
        let class = goal.class.map(|class| class.name().to_string());
        goals.push(Goal { name: goal.name, class, xml: sources.goal.to_string() });
    }
    let Some((kit, arm)) = files else {
        return Err(miette!("there is no goal in {}", data.goals()));
    };
    let Disturbance { position, angle } = Disturbance::default();
    Ok(Terms { goals, kit, arm, disturbance: [position, angle] })
}

fn log_of(file: &ResultFile) -> Result<Log, Failure> {
    let path = file.path.with_extension(ENDING);
    if !path.exists() {
        return Err(miette!(
            help = "a result goes on the board only if it can be run again: put its log beside it",
            "{} has no log {}",
            file.path.display(),
            path.display()
        ));
    }
    Log::read(&path).into_diagnostic()
}

/// Writes the site; how many agents are on it.
fn write_site(collection: Collection, folder: &Path) -> Result<usize, Failure> {
    std::fs::create_dir_all(folder)
        .map_err(|error| miette!("cannot make the folder {}: {error}", folder.display()))?;
    let write =
        |name: &str, text: &str| write_whole(&folder.join(name), text).map_err(|error| miette!("{error}"));
    let agents = collection.entrants.len();
    for index in 0..agents {
        let entrants = vec![collection.entrants[index].clone()];
        let one = Collection {
            entrants,
            published: Vec::new(),
            plans: Vec::new(),
            perception: Vec::new(),
            trials: Vec::new(),
            notes: Vec::new(),
            ..collection.clone()
        };
        write(&agent_page(index), &page::html(&Report::new(one)))?;
    }
    // Last: who sees the front page finds what it leads to.
    write("index.html", &front(&Report::new(collection)))?;
    Ok(agents)
}
