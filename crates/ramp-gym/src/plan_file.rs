//! Plans of somebody else: read, checked by the rules, and given what the skills need to carry them out.

use ramp_assembly::Assembly;
use ramp_kit::source::plain;
use ramp_planner::{CoarseStep, Domains, Entry, Plan, PlanError, Refused, Replayer, State, Statistics};
use serde::Deserialize;

/// The longest reason, characters.
const LONGEST: usize = 300;

/// What is wrong with a plan.
#[derive(Debug, thiserror::Error)]
pub enum PlanFileError {
    /// It is neither what `ramp plan GOAL --json` prints nor another planner's plan.
    #[error(
        "{line}:{column}: {what}; expected what `ramp plan GOAL --json` prints, or another planner's plan for what --pddl wrote"
    )]
    Form {
        /// From 1.
        line: usize,
        /// From 1.
        column: usize,
        /// What was found.
        what: String,
    },
    /// The rules refuse a step.
    #[error("refused at {0}")]
    Refused(#[from] Refused),
    /// There is no such plan, or the goal has none.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

#[derive(Deserialize)]
struct File {
    plan: Steps,
}

#[derive(Deserialize)]
struct Steps {
    steps: Vec<CoarseStep>,
    #[serde(default)]
    entries: Vec<Entry>,
}

/// A plan for a goal from nothing: as `ramp plan GOAL --json` prints it, or in the form that planners for PDDL write. Each
/// step, coarse and fine, must be possible by the rules, and the last must leave the goal built. Where the file does not
/// say how a beam gets to its place, it goes as in the planner's own plan.
///
/// # Errors
/// When the text is no plan, or a step of it is not possible.
pub fn read_plan(text: &str, assembly: &Assembly, domains: &Domains) -> Result<Plan, PlanFileError> {
    let state = State::default();
    let Steps { steps, mut entries } = if text.trim_start().starts_with('{') {
        let file: Result<File, _> = serde_json::from_str(text);
        file.map_err(|error| PlanFileError::Form {
            line: error.line(),
            column: error.column(),
            what: plain(&error.to_string(), LONGEST),
        })?
        .plan
    } else {
        Steps { steps: ramp_planner::pddl_plan(assembly, &state, domains, text)?, entries: Vec::new() }
    };
    Replayer::new(assembly, domains, &state)?.run(&steps)?;
    let told = |entries: &[Entry], beam: &str| entries.iter().any(|entry| entry.beam == beam);
    let base = &assembly.beams[assembly.base].beam.name;
    let names = assembly.beams.iter().map(|placed| &placed.beam.name).filter(|name| *name != base);
    if !names.clone().all(|name| told(&entries, name)) {
        let own = ramp_planner::plan(assembly, &state, domains)?;
        let (lacking, _): (Vec<Entry>, Vec<Entry>) =
            own.entries.into_iter().partition(|entry| !told(&entries, &entry.beam));
        entries.extend(lacking);
    }
    Ok(Plan { steps, entries, statistics: Statistics::default() })
}
