//! Selection of the goals of many episodes: by name, by class, or all.

use std::path::Path;

use miette::{Diagnostic, Report, miette};
use ramp_assembly::Class;
use ramp_data::Data;
use ramp_kit::source::{nearest, shorten};
use ramp_result::resume::Foreign;

use crate::options::is_file;

/// The name that stands for every goal.
const ALL: &str = "all";

/// Ending of a goal file.
const GOAL_ENDING: &str = ".xml";

/// Errors before any episode starts.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum BatchError {
    #[error("there is no goal and no class `{name}`")]
    Unknown {
        name: String,
        #[help]
        help: String,
    },
    #[error("{first} and {second} are two goals of the name `{name}`")]
    #[diagnostic(help("rename one of the files: results are identified by the goal's name"))]
    SameName { name: String, first: String, second: String },
    #[error("none of {place} is of the class `{class}`")]
    EmptyClass { class: String, place: String },
    #[error("there is no goal file in {folder}")]
    NoGoals { folder: String },
    #[error("a state is one of a single goal, and there are {count}")]
    #[diagnostic(help("name one goal with --state"))]
    StateOfMany { count: usize },
    #[error("the seeds go past the largest number there is")]
    #[diagnostic(help("take a smaller --first-seed or fewer {repeats}"))]
    Seeds { repeats: &'static str },
    #[error("{file} was made by {theirs}, and this is {ours}")]
    #[diagnostic(help(
        "results of different versions are not added up: name another folder with -o, or move these away"
    ))]
    OtherVersion { file: String, theirs: String, ours: String },
    #[error("{file} is of the agent {theirs}, and the folder would become one of two agents")]
    #[diagnostic(help(
        "a class is run with one unchanged agent: name another folder with -o, or move these away"
    ))]
    OtherAgent { file: String, theirs: String },
    #[error("{file} is of another secret, or of none")]
    #[diagnostic(help("a folder is of one secret: name another folder with -o, or give the same --secret"))]
    OtherSecret { file: String },
    #[error("{file} is of the arm {theirs}, and not of this one")]
    #[diagnostic(help("a folder is of one arm: name another folder with -o, or give the same --arm"))]
    OtherArm { file: String, theirs: String },
    #[error("{file} is of the world {theirs}, and not of this one")]
    #[diagnostic(help("a folder is of one world: name another folder with -o, or give the same --world"))]
    OtherWorld { file: String, theirs: String },
    #[error("{file} is of the start {theirs}, and not of this one")]
    #[diagnostic(help("a folder is of one start: name another folder with -o, or give the same --start"))]
    OtherStart { file: String, theirs: String },
    #[error("{file} is of an episode that began in another state, or in none")]
    #[diagnostic(help("a folder is of one task: name another folder with -o, or move the file away"))]
    OtherState { file: String },
    #[error("another bench is at work in {folder}{who}")]
    #[diagnostic(help("wait for it, or name another folder with -o"))]
    Busy { folder: String, who: String },
}

impl BatchError {
    /// The file of a result that does not belong in its folder.
    pub fn foreign(path: &Path, foreign: Foreign) -> BatchError {
        let file = path.display().to_string();
        match foreign {
            Foreign::Version { theirs, ours } => BatchError::OtherVersion { file, theirs, ours },
            Foreign::Arm { theirs } => BatchError::OtherArm { file, theirs },
            Foreign::World { theirs } => BatchError::OtherWorld { file, theirs },
            Foreign::Start { theirs } => BatchError::OtherStart { file, theirs },
            Foreign::State => BatchError::OtherState { file },
            Foreign::Secret => BatchError::OtherSecret { file },
            Foreign::Agent { theirs } => BatchError::OtherAgent { file, theirs },
        }
    }
}

/// A goal to be run.
pub struct BatchGoal {
    pub name: String,
    /// The argument for `ramp run`.
    pub argument: String,
    /// True if that is a file.
    pub is_file: bool,
    pub class: Option<Class>,
    /// Pegs, or parts that are to be put back.
    pub count: usize,
    /// The hash of the state in which the frame begins, if not with nothing built.
    pub state: Option<String>,
}

/// Whether a word names a folder: it has a `/` in it, so that no class is taken for one.
fn is_folder(word: &str) -> bool {
    word.contains('/') && Path::new(word).is_dir()
}

/// The goal files in a folder.
fn files_in(folder: &str) -> Result<Vec<String>, Report> {
    let names = ramp_assembly::goal_names(Path::new(folder))
        .map_err(|error| miette!("the folder {folder} cannot be read: {error}"))?;
    let file = |name: String| Path::new(folder).join(name + GOAL_ENDING).display().to_string();
    Ok(names.into_iter().map(file).collect())
}

/// The selected goals, without duplicates, in the order of the arguments.
pub fn find(data: &Data, words: &[String]) -> Result<Vec<BatchGoal>, Report> {
    let names = data.goal_names()?;
    let mut goals: Vec<BatchGoal> = Vec::new();
    for word in words {
        let class = Class::of_name(word);
        let is_folder = is_folder(word);
        let is_file = is_folder || is_file(word.as_ref(), GOAL_ENDING);
        let meant: Vec<String> = if let Some(set) = class.filter(|class| class.is_open()) {
            data.open_goal_names(set)?
        } else if class.is_some() || word == ALL {
            names.clone()
        } else if is_folder {
            files_in(word)?
        } else if is_file || names.contains(word) || Class::of_open_goal(word).is_some() {
            vec![word.clone()]
        } else {
            let mut known: Vec<&str> = names.iter().map(String::as_str).collect();
            let classes = Class::ALL.map(Class::name);
            known.extend(classes.iter().map(String::as_str));
            known.push(ALL);
            let near = nearest(word, known);
            let help = near.map_or_else(
                || {
                    format!(
                        "the goals are {}; the classes easy, medium, hard, open-2026 and all",
                        names.join(", ")
                    )
                },
                |near| format!("did you mean `{near}`?"),
            );
            return Err(BatchError::Unknown { name: shorten(word), help }.into());
        };
        let mut found = false;
        for argument in meant {
            let assembly = data.goal(&argument)?;
            if class.is_some() && assembly.class != class {
                continue;
            }
            found = true;
            match goals.iter().find(|goal| goal.name == assembly.name) {
                None => goals.push(BatchGoal {
                    name: assembly.name.clone(),
                    argument,
                    is_file,
                    class: assembly.class,
                    count: assembly.connections.len(),
                    state: None,
                }),
                Some(known) if known.argument == argument => {}
                Some(known) => {
                    return Err(BatchError::SameName {
                        name: assembly.name.clone(),
                        first: known.argument.clone(),
                        second: argument,
                    }
                    .into());
                }
            }
        }
        if !found {
            if is_folder {
                return Err(BatchError::NoGoals { folder: word.clone() }.into());
            }
            return Err(BatchError::EmptyClass { class: word.clone(), place: data.goals() }.into());
        }
    }
    Ok(goals)
}
