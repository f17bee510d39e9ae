//! Plans from a file: read, checked by the rules, and completed with the insertion paths that the skills
//! need.

use ramp_assembly::Assembly;
use ramp_source::plain;
use serde::Deserialize;

use crate::domains::Domains;
use crate::error::{PlanError, Refused};
use crate::pddl::pddl_plan;
use crate::plan::{CoarseStep, Entry, Plan, State, Statistics};
use crate::planner::plan;
use crate::replay::Replayer;

/// The longest reason in a message, characters.
const LONGEST: usize = 300;

/// Why a plan file is not accepted.
#[derive(Debug, thiserror::Error)]
pub enum PlanFileError {
    /// The text is neither the output of `ramp plan GOAL --json` nor another planner's plan.
    #[error(
        "{line}:{column}: {what}; expected the output of `ramp plan GOAL --json`, or another planner's plan for the \
         files of `ramp plan GOAL --pddl DIR`"
    )]
    Form {
        /// From 1.
        line: usize,
        /// From 1.
        column: usize,
        /// The problem.
        what: String,
    },
    /// The rules refuse a step.
    #[error("refused at {0}")]
    Refused(#[from] Refused),
    /// A step that the PDDL files do not have, or a goal without a plan.
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

/// Reads a plan that starts from nothing, as [`read_plan_from`].
///
/// # Errors
/// As [`read_plan_from`].
pub fn read_plan(text: &str, assembly: &Assembly, domains: &Domains) -> Result<Plan, PlanFileError> {
    read_plan_from(text, assembly, &State::default(), domains)
}

/// Reads a plan that starts from a state: the output of `ramp plan GOAL --json`, or the plan of a PDDL
/// planner.
///
/// Each step, coarse and fine, must be possible by the rules, and the last must leave the goal built.
/// Insertion paths that the file lacks are taken from the planner's own plan; the goal is planned only then.
///
/// # Errors
/// If the text is not a plan, or the rules refuse a step.
pub fn read_plan_from(
    text: &str,
    assembly: &Assembly,
    state: &State,
    domains: &Domains,
) -> Result<Plan, PlanFileError> {
    let Steps { steps, mut entries } = if text.trim_start().starts_with('{') {
        let file: Result<File, _> = serde_json::from_str(text);
        file.map_err(|error| PlanFileError::Form {
            line: error.line(),
            column: error.column(),
            what: plain(&error.to_string(), LONGEST),
        })?
        .plan
    } else {
        Steps { steps: pddl_plan(assembly, state, domains, text)?, entries: Vec::new() }
    };
    Replayer::new(assembly, domains, state)?.run(&steps)?;
    let has = |entries: &[Entry], beam: &str| entries.iter().any(|entry| entry.beam == beam);
    let base = &assembly.beams[assembly.base].beam.name;
    let missing = |name: &&String| *name != base && !state.in_assembly.contains(name);
    let names = assembly.beams.iter().map(|placed| &placed.beam.name).filter(missing);
    if !names.clone().all(|name| has(&entries, name)) {
        let own = plan(assembly, state, domains)?;
        let (lacking, _): (Vec<Entry>, Vec<Entry>) =
            own.entries.into_iter().partition(|entry| !has(&entries, &entry.beam));
        entries.extend(lacking);
    }
    Ok(Plan { steps, entries, statistics: Statistics::default() })
}
