//! `ramp goals commit` and `ramp goals verify`: goals that an organiser keeps back.

use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, Report, miette};
use ramp_kit::source::{MAX_SENTENCE, plain, read_text};
use ramp_report::held_out::{Commitments, Reveal, SALT, promise, verify};
use ramp_result::write_whole;

use crate::data::Data;
use crate::output::print;
use crate::status::{DONE, INCOMPLETE};

/// Published before.
const COMMITMENTS: &str = "commitments.json";
/// Kept back until after.
const REVEAL: &str = "reveal.json";
/// The largest of both, bytes.
const LARGEST: usize = 16 << 20;

#[derive(clap::Args)]
pub struct CommitArguments {
    /// Goal files
    #[arg(required = true, value_name = "FILE")]
    goals: Vec<String>,
    /// Folder for commitments.json, to be published now, and reveal.json, to be kept back; made if it is not there
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

#[derive(clap::Args)]
pub struct VerifyArguments {
    /// What was published before
    commitments: PathBuf,
    /// What was published after
    reveal: PathBuf,
}

pub fn commit(data: &Data, arguments: &CommitArguments) -> Result<u8, Report> {
    let kit = data.kit()?;
    let mut goals: Vec<(String, [u8; SALT], String)> = Vec::new();
    for file in &arguments.goals {
        // A goal that nobody can read or build must not be promised.
        let goal = data.goal(file, &kit)?;
        if goals.iter().any(|(name, _, _)| *name == goal.name) {
            return Err(miette!(help = "rename one of the files", "two goals are called `{}`", goal.name));
        }
        let mut salt = [0; SALT];
        getrandom::fill(&mut salt).map_err(|error| miette!("the system gives no random numbers: {error}"))?;
        goals.push((goal.name.clone(), salt, data.texts(file)?.sources().goal.to_string()));
    }
    let folder = &arguments.output;
    for name in [COMMITMENTS, REVEAL] {
        if folder.join(name).exists() {
            return Err(miette!(
                help = "name another folder: what was promised must not be lost",
                "{} is there already",
                folder.join(name).display()
            ));
        }
    }
    std::fs::create_dir_all(folder)
        .map_err(|error| miette!("cannot make the folder {}: {error}", folder.display()))?;
    let (promised, revealed) = promise(&goals);
    write(&folder.join(REVEAL), &revealed)?;
    write(&folder.join(COMMITMENTS), &promised)?;
    let mut text = String::new();
    for it in &promised.commitments {
        text.push_str(&format!("{}  {}\n", it.commitment, it.goal));
    }
    text.push_str(&format!(
        "publish {}; keep {} back\n",
        folder.join(COMMITMENTS).display(),
        folder.join(REVEAL).display()
    ));
    print(&text)?;
    Ok(DONE)
}

pub fn check(arguments: &VerifyArguments) -> Result<u8, Report> {
    let promised: Commitments = read(&arguments.commitments)?;
    let revealed: Reveal = read(&arguments.reveal)?;
    match verify(&promised, &revealed) {
        Ok(()) => {
            let count = promised.commitments.len();
            let goals = if count == 1 { "goal is the one" } else { "goals are those" };
            print(&format!("{count} {goals} that was promised, for the rules {}\n", promised.rules))?;
            Ok(DONE)
        }
        Err(error) => {
            print(&format!("{error}\n"))?;
            Ok(INCOMPLETE)
        }
    }
}

fn write<T: serde::Serialize>(path: &Path, value: &T) -> Result<(), Report> {
    let text = serde_json::to_string_pretty(value).into_diagnostic()?;
    Ok(write_whole(path, text + "\n")?)
}

fn read<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, Report> {
    let name = path.display();
    let text = read_text(path, LARGEST)?;
    serde_json::from_str(&text).map_err(|error| {
        miette!(
            help = "expected a file that `ramp goals commit` wrote",
            "{name}:{}:{}: {}",
            error.line(),
            error.column(),
            plain(&error.to_string(), MAX_SENTENCE)
        )
    })
}
