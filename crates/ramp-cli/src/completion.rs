//! Completion of names in a shell: goals, worlds, starts, faults, skills and actions, besides commands,
//! options and files. The script of `ramp completions` asks this program for every word.

use std::ffi::OsStr;

use clap::{Arg, Command};
use clap_complete::engine::{ArgValueCompleter, CompletionCandidate, PathCompleter, ValueCompleter};
use clap_complete::env::CompleteEnv;
use ramp_assembly::Class;
use ramp_data::Data;
use ramp_gym::SKILLS;
use ramp_twin::FaultKind;
use ramp_world::{Start, World};

/// Environment variable with which the script asks.
pub const VARIABLE: &str = "RAMP_COMPLETE";

/// Answers the script of a shell and ends the program, if it asks.
pub fn answer() {
    CompleteEnv::with_factory(|| with_names(crate::arguments(), "")).var(VARIABLE).complete();
}

/// The command with names for the values of its arguments. `path` is the way to it, such as `world`.
fn with_names(command: Command, path: &str) -> Command {
    let path = path.to_string();
    let here = path.clone();
    command.mut_args(move |arg| with_values(arg, &here)).mut_subcommands(move |inner| {
        let path = format!("{path} {}", inner.get_name());
        with_names(inner, path.trim())
    })
}

/// The argument of a command with names for its values.
fn with_values(arg: Arg, path: &str) -> Arg {
    let value = arg.get_value_names().and_then(|names| names.first()).map(ToString::to_string);
    let kind = match (value.as_deref(), arg.get_long()) {
        (Some("GOAL"), _) => Names::Goals,
        (Some("CLASS|GOAL"), _) => Names::GoalsAndClasses,
        (Some("KIND[@N]"), _) => Names::Faults,
        (Some("SKILL"), _) => Names::Skills,
        (Some("SKILL|GOAL"), _) => Names::SkillsAndGoals,
        (Some("ACTION|GOAL"), _) => Names::ActionsAndGoals,
        (Some("ACTION=FILE|URL"), _) => Names::Actions,
        (Some("NAME|FILE"), Some("world")) => Names::Worlds,
        (Some("NAME|FILE"), Some("start")) => Names::Starts,
        (Some("NAME"), None) if path == "world show" => Names::Worlds,
        (Some("NAME"), None) if path == "start show" => Names::Starts,
        _ => return arg,
    };
    arg.add(ArgValueCompleter::new(kind))
}

/// Kind of names.
#[derive(Clone, Copy)]
enum Names {
    Goals,
    GoalsAndClasses,
    Worlds,
    Starts,
    Faults,
    Skills,
    SkillsAndGoals,
    ActionsAndGoals,
    /// Actions, each with `=` and a file.
    Actions,
}

impl Names {
    /// All names.
    fn all(self) -> Vec<String> {
        let goals = || data().and_then(|data| data.goal_names().ok()).unwrap_or_default();
        match self {
            Names::Goals => goals(),
            Names::GoalsAndClasses => {
                let sets = data().and_then(|data| data.open_sets().ok()).unwrap_or_default();
                let sets = sets.into_iter().map(Class::name);
                ["easy", "medium", "hard", "all"]
                    .map(String::from)
                    .into_iter()
                    .chain(sets)
                    .chain(goals())
                    .collect()
            }
            Names::Worlds => World::names().map(String::from).collect(),
            Names::Starts => Start::names().map(String::from).collect(),
            Names::Faults => FaultKind::ALL.map(|kind| kind.name().to_string()).to_vec(),
            Names::Skills => SKILLS.map(String::from).to_vec(),
            Names::SkillsAndGoals => SKILLS.map(String::from).into_iter().chain(goals()).collect(),
            Names::ActionsAndGoals => actions().chain(goals()).collect(),
            Names::Actions => actions().map(|action| format!("{action}=")).collect(),
        }
    }

    /// Whether a file can take the place of a name.
    fn or_file(self) -> bool {
        match self {
            Names::Goals | Names::GoalsAndClasses | Names::SkillsAndGoals | Names::ActionsAndGoals => true,
            Names::Worlds | Names::Starts => true,
            Names::Faults | Names::Skills | Names::Actions => false,
        }
    }
}

impl ValueCompleter for Names {
    fn complete(&self, current: &OsStr) -> Vec<CompletionCandidate> {
        let begin = current.to_string_lossy();
        if let (Names::Actions, Some((action, file))) = (self, begin.split_once('=')) {
            let files = PathCompleter::file().complete(OsStr::new(file));
            return files.into_iter().map(|it| it.add_prefix(format!("{action}="))).collect();
        }
        let names = self.all().into_iter().filter(|name| name.starts_with(&*begin));
        let names = names.map(CompletionCandidate::new);
        let files = self.or_file().then(|| PathCompleter::file().complete(current));
        names.chain(files.into_iter().flatten()).collect()
    }
}

/// The actions that a skill of one's own can carry out.
fn actions() -> impl Iterator<Item = String> {
    ramp_gym::own::kinds().map(|kind| kind.name().replace('_', "-"))
}

/// The data that `RAMP_DATA` names, or the built-in ones.
fn data() -> Option<Data> {
    match std::env::var_os("RAMP_DATA") {
        Some(folder) => Data::folder(folder.as_ref()).ok(),
        None => Some(Data::built_in()),
    }
}
