//! A task planner of one's own: a program that makes the baseline's plans.

use std::ffi::OsString;
use std::time::Duration;

use miette::Report;
use ramp_data::Texts;
use ramp_external_agent::{AgentFile, GoalMessage, Patience, Sandbox, ask_planner};
use ramp_planner::{Domains, Plan, State, read_plan_from};
use ramp_robot::Event;
use ramp_skills::OwnPlanner;
use ramp_twin::Setup;
use serde_json::{Value, json};

use crate::command::program::command_of;

/// The version of the message to planners.
const VERSION: u32 = 1;

/// The planner in a file, for an episode. `limit` is the time, s, that it has for a plan.
///
/// # Errors
/// If this program does not know its own file.
pub fn planner<'a>(
    setup: &Setup<'a>,
    texts: &Texts,
    file: &AgentFile,
    domains: &'a Domains,
    limit: f64,
    sandbox: Option<Sandbox>,
) -> Result<OwnPlanner<'a>, Report> {
    let Setup { assembly, arm, track, start, .. } = *setup;
    let goal = GoalMessage::new(assembly, arm, track, start, texts.sources()).to_planner_json();
    let command: Vec<OsString> = command_of(file, sandbox.as_ref())?;
    let patience = Patience { answer: Duration::from_secs_f64(limit), end: None };
    Ok(Box::new(move |state: &State, events: &[Event]| -> Result<Plan, String> {
        let problem = json!({"planner": VERSION, "goal": goal, "state": state, "history": events});
        let pddl = || pddl(assembly, state, domains);
        let text = ask_planner(&command, patience, sandbox.as_ref(), &problem, pddl)
            .map_err(|error| error.to_string())?;
        read_plan_from(&text, assembly, state, domains)
            .map_err(|error| format!("the planner's plan: {error}"))
    }))
}

/// The problem in PDDL: the texts that `ramp plan --pddl` writes to files, and null for those that cannot be.
fn pddl(assembly: &ramp_assembly::Assembly, state: &State, domains: &Domains) -> Value {
    let full = ramp_planner::pddl(assembly, state, domains).ok();
    let strips = ramp_planner::strips(assembly, state, domains).ok();
    json!({
        "domain": full.as_ref().map(|it| &it.domain),
        "problem": full.as_ref().map(|it| &it.problem),
        "strips_domain": strips.as_ref().map(|it| &it.domain),
        "strips_problem": strips.as_ref().map(|it| &it.problem),
    })
}
