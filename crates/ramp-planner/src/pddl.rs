//! The coarse level for other planners: domain and problem in PDDL, and reading of their plans.

use crate::domains::Domains;
use crate::error::{PlanError, Refused};
use crate::plan::{CoarseStep, State};
use crate::planner::{Options, Planner};
use crate::replay::Replayer;
use crate::state;
use ramp_action_language::{Pddl, Strips};
use ramp_assembly::Assembly;

/// Writes the coarse domain and a goal in PDDL.
///
/// # Errors
/// When the state contradicts itself, or PDDL cannot express a law of the domain.
///
/// ```
/// use ramp_planner::{Domains, State, pddl};
///
/// let kit = ramp_kit::read_kit("../../data/kit.xml".as_ref())?;
/// let assembly = ramp_assembly::read_goal("../../data/goals/easy-1.xml".as_ref(), &kit)?;
/// let domains = Domains::read("../../data/domains".as_ref())?;
/// let written = pddl(&assembly, &State::default(), &domains)?;
/// assert!(written.domain.contains("(:action fasten"));
/// assert!(written.problem.contains("(joins c1 b4 b7)"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn pddl(assembly: &Assembly, state: &State, domains: &Domains) -> Result<Pddl, PlanError> {
    let known = state::look_up(assembly, state)?;
    let planner = Planner::new(assembly, domains, Options::default(), known.motion.clone());
    let start = planner.fluents(&known)?;
    let file = domains.coarse().file().name();
    let mut written = Pddl::new(&planner.model, &planner.facts.all, &start, "ramp", &assembly.name)?;
    written.domain.insert_str(0, &format!("; Written from {file} by ramp plan --pddl.\n"));
    written.problem.insert_str(0, &format!("; The goal {}.\n", assembly.name));
    Ok(written)
}

/// Writes the same problem in STRIPS, for planners that read neither derived predicates nor conditional
/// effects.
///
/// # Errors
/// As [`pddl`].
///
/// ```
/// use ramp_planner::{Domains, State, strips};
///
/// let kit = ramp_kit::read_kit("../../data/kit.xml".as_ref())?;
/// let assembly = ramp_assembly::read_goal("../../data/goals/easy-1.xml".as_ref(), &kit)?;
/// let domains = Domains::read("../../data/domains".as_ref())?;
/// let written = strips(&assembly, &State::default(), &domains)?;
/// assert!(written.domain.contains("(:requirements :strips)"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn strips(assembly: &Assembly, state: &State, domains: &Domains) -> Result<Strips, PlanError> {
    let known = state::look_up(assembly, state)?;
    let planner = Planner::new(assembly, domains, Options::default(), known.motion.clone());
    let start = planner.fluents(&known)?;
    let file = domains.coarse().file().name();
    let mut written = Strips::new(&planner.model, &start, "ramp", &assembly.name)?;
    written.domain.insert_str(0, &format!("; Written from {file} by ramp plan --pddl.\n"));
    written.problem.insert_str(0, &format!("; The goal {}.\n", assembly.name));
    Ok(written)
}

/// Completes another planner's plan for the files of [`pddl`] or of [`strips`]: it is judged, gets
/// pegs of the kit, and fine actions under every coarse one.
///
/// # Errors
/// When a line is not an action, an action is impossible, the goal is not reached, or the fine
/// domain cannot carry an action out.
pub fn pddl_plan(
    assembly: &Assembly,
    state: &State,
    domains: &Domains,
    text: &str,
) -> Result<Vec<CoarseStep>, PlanError> {
    let written = pddl(assembly, state, domains)?;
    let actions = match written.read_plan(domains.coarse(), text) {
        Ok(actions) => actions,
        // A plan for the other files names none of these actions.
        Err(error) => {
            let other = strips(assembly, state, domains).ok().and_then(|strips| strips.read_plan(text));
            other.unwrap_or(Err(error))?
        }
    };
    let known = state::look_up(assembly, state)?;
    let mut planner = Planner::new(assembly, domains, Options::default(), known.motion.clone());
    let mut now = planner.fluents(&known)?;
    let mut transitions = Vec::new();
    for (index, action) in actions.iter().enumerate() {
        let walked = planner.walk(&now, std::slice::from_ref(action)).map_err(|error| Refused {
            step: index + 1,
            action: action.to_string(),
            why: error.to_string(),
        })?;
        if let Some(last) = walked.last() {
            now = last.after.clone();
        }
        transitions.extend(walked);
    }
    let steps = planner.steps(&transitions, &known)?;
    Replayer::new(assembly, domains, state)?.run(&steps)?;
    Ok(steps)
}
