//! `ramp goals commit` and `ramp goals verify`: an organiser's held-out goals.

use std::path::PathBuf;

use miette::{Report, miette};
use ramp_data::Data;
use ramp_report::held_out::{Commitments, Reveal, SALT, promise, verify};

use crate::output::{print, read_json, refuse_existing, write_json};
use crate::status::{DONE, INCOMPLETE};

/// File that is published in advance.
const COMMITMENTS: &str = "commitments.json";
/// File that is kept secret until later.
const REVEAL: &str = "reveal.json";
/// Command that writes both files.
const WRITER: &str = "ramp goals commit";

#[derive(clap::Args)]
pub struct CommitArguments {
    /// Goal files
    #[arg(required = true, value_name = "FILE")]
    goals: Vec<String>,
    /// Folder for commitments.json, to be published now, and reveal.json, to be kept back; made if it is not
    /// there
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

#[derive(clap::Args)]
pub struct VerifyArguments {
    /// The commitments, as published before
    commitments: PathBuf,
    /// The file that was published later
    reveal: PathBuf,
}

pub fn commit(data: &Data, arguments: &CommitArguments) -> Result<u8, Report> {
    let mut goals: Vec<(String, [u8; SALT], String)> = Vec::new();
    for file in &arguments.goals {
        // Do not commit to a goal that cannot be read or built.
        let (goal, texts) = data.goal_with_texts(file)?;
        if goals.iter().any(|(name, _, _)| *name == goal.name) {
            return Err(miette!(help = "rename one of the files", "two goals are called `{}`", goal.name));
        }
        let mut salt = [0; SALT];
        getrandom::fill(&mut salt).map_err(|error| miette!("the system gives no random numbers: {error}"))?;
        goals.push((goal.name.clone(), salt, texts.sources().goal.to_string()));
    }
    let [commitments, reveal] = [COMMITMENTS, REVEAL].map(|name| arguments.output.join(name));
    refuse_existing([&commitments, &reveal])?;
    let (promised, revealed) = promise(&goals);
    write_json(&reveal, &revealed)?;
    write_json(&commitments, &promised)?;
    let mut text = String::new();
    for it in &promised.commitments {
        text.push_str(&format!("{}  {}\n", it.commitment, it.goal));
    }
    text.push_str(&format!("publish {}; keep {} back\n", commitments.display(), reveal.display()));
    print(&text)?;
    Ok(DONE)
}

pub fn check(arguments: &VerifyArguments) -> Result<u8, Report> {
    let promised: Commitments = read_json(&arguments.commitments, WRITER)?;
    let revealed: Reveal = read_json(&arguments.reveal, WRITER)?;
    match verify(&promised, &revealed) {
        Ok(()) => {
            let count = promised.commitments.len();
            let goals = if count == 1 { "goal is the one that was" } else { "goals are those that were" };
            print(&format!("{count} {goals} promised, for the rules {}\n", promised.rules))?;
            Ok(DONE)
        }
        Err(error) => {
            print(&format!("{error}\n"))?;
            Ok(INCOMPLETE)
        }
    }
}
