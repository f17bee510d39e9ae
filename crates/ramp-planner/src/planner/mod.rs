//! From an assembly and a state to a plan: the order of the beams, then coarse actions, then fine ones.
//!
//! The rule files define the possible actions. This module passes their answers from level to
//! level: `order`, `coarse` (one of the `tasks` at a time) and `fine`; `search` iterates over them.
//! A level without an answer asks the level above for another decision. Problems are kept small
//! (`fact_index`) and solved once per `shape` (`memo`); `proof` gives lower bounds.

mod coarse;
mod core;
mod fact_index;
mod fine;
mod memo;
mod options;
mod order;
mod proof;
mod search;
mod shape;
mod tasks;

pub(crate) use self::core::Planner;
pub use options::Options;

use crate::domains::Domains;
use crate::error::PlanError;
use crate::facts;
use crate::motion::Motion;
use crate::plan::{Plan, State};
use crate::state;
use ramp_assembly::Assembly;

/// Plans the remaining steps to build an assembly.
///
/// The same input always gives the same plan.
///
/// # Errors
/// When the state contradicts itself, when the rules forbid the goal, when the pegs do not suffice,
/// or when a rule file gives an invalid answer.
///
/// ```
/// use ramp_planner::{CoarseAction, Domains, State, plan};
///
/// let kit = ramp_kit::read_kit("../../data/kit.xml".as_ref())?;
/// let assembly = ramp_assembly::read_goal("../../data/goals/easy-3.xml".as_ref(), &kit)?;
/// let domains = Domains::read("../../data/domains".as_ref())?;
/// let plan = plan(&assembly, &State::default(), &domains)?;
/// assert!(matches!(&plan.steps[3].coarse, CoarseAction::Assemble { beam } if beam == "b4"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn plan(assembly: &Assembly, state: &State, domains: &Domains) -> Result<Plan, PlanError> {
    plan_with(assembly, state, domains, Options::default())
}

/// Plans with other [`Options`].
///
/// # Errors
/// As [`plan`].
pub fn plan_with(
    assembly: &Assembly,
    state: &State,
    domains: &Domains,
    options: Options,
) -> Result<Plan, PlanError> {
    let known = state::look_up(assembly, state)?;
    let needed = known.pinned.iter().filter(|pinned| pinned.is_none()).count();
    if needed > known.pegs.len() {
        return Err(PlanError::Pegs { goal: assembly.name.clone(), needed, left: known.pegs.len() });
    }
    if let Some(connection) = known.unreachable() {
        return Err(PlanError::Motion {
            goal: assembly.name.clone(),
            why: format!("{} cannot be fastened", assembly.connections[connection].name),
            reasons: known.motion.reasons(),
        });
    }
    let mut planner = Planner::new(assembly, domains, options, known.motion.clone());
    let plan = planner.plan(&known);
    plan.map_err(|error| because_of_motion(error, &assembly.name, &known.motion))
}

/// If motion facts are known, they are the reason for a missing plan.
fn because_of_motion(error: PlanError, goal: &str, motion: &Motion) -> PlanError {
    let why = match &error {
        _ if motion.facts.is_empty() => return error,
        PlanError::Illegal { why, .. } => why.clone(),
        PlanError::NoOrder { .. } => "no order of its beams can be carried out".to_string(),
        PlanError::NoPlan { task, .. } => format!("the rules do not allow `{task}`"),
        _ => return error,
    };
    PlanError::Motion { goal: goal.to_string(), why, reasons: motion.reasons() }
}

/// A domain with a goal as a program for clingo's incremental mode: `ramp plan GOAL --emit-asp > goal.lp`,
/// then `clingo goal.lp`. The fine domain is emitted for the state at the beginning and with no goals of its
/// own.
pub fn asp(assembly: &Assembly, domains: &Domains, fine: bool) -> String {
    let planner = Planner::new(assembly, domains, Options::default(), Motion::default());
    let mut facts = planner.facts.all;
    let domain = match fine {
        false => domains.coarse(),
        true => {
            let beams: Vec<usize> = (0..assembly.beams.len()).collect();
            let stands: Vec<bool> = beams.iter().map(|&beam| beam == assembly.base).collect();
            let pinned = vec![false; assembly.connections.len()];
            facts.extend(facts::fine(assembly, &planner.geometry, &beams, &|_| true, &stands, &pinned));
            domains.fine()
        }
    };
    let facts: String = facts.iter().map(|fact| format!("{fact}.\n")).collect();
    format!(
        "{}\n% ---- {} ----\n#include <incmode>.\n#program base.\ngoal(F) :- final(F).\navoid(F) :- final_not(F).\n{facts}",
        domain.to_asp(),
        assembly.name
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::CoarseAction;
    use crate::solver::shortest_by_clingo;
    use ramp_kit::Kit;
    use std::path::Path;

    fn data() -> (Kit, Domains) {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
        (ramp_kit::read_kit(&data.join("kit.xml")).unwrap(), Domains::read(&data.join("domains")).unwrap())
    }

    fn goal(name: &str, kit: &Kit) -> Assembly {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../data/goals/{name}.xml"));
        ramp_assembly::read_goal(&file, kit).unwrap()
    }

    /// The solved program is equivalent to the readable one.
    #[test]
    fn unrolling_agrees_with_clingos_own_grounder() {
        let (kit, domains) = data();
        let mut compared = 0;
        for name in ["easy-3", "medium-3", "hard-3"] {
            let assembly = goal(name, &kit);
            let known = state::look_up(&assembly, &State::default()).unwrap();
            let mut planner = Planner::new(&assembly, &domains, Options::default(), Motion::default());
            planner.plan(&known).unwrap();
            for (answers, domain) in
                [(&planner.coarse_answers, domains.coarse()), (&planner.fine_answers, domains.fine())]
            {
                let program = domain.to_asp();
                for (problem, found) in &answers.0 {
                    let problem: String = problem.iter().map(|fact| format!("{fact}.\n")).collect();
                    let steps =
                        shortest_by_clingo(&format!("{program}#program base.\nresumed.\n{problem}"), 14);
                    let expected = found.as_ref().map(|found| found.actions.len());
                    assert_eq!(steps, expected, "{name}:\n{problem}");
                    compared += 1;
                }
            }
        }
        assert!(compared > 50, "only {compared} problems were compared");
    }

    #[test]
    fn looking_at_everything_gives_no_shorter_plan() {
        let (kit, domains) = data();
        for name in
            ["easy-1", "easy-2", "easy-3", "medium-1", "medium-2", "medium-3", "hard-1", "hard-2", "hard-3"]
        {
            let assembly = goal(name, &kit);
            let plan = |zoom| {
                let options = Options { zoom, ..Options::default() };
                plan_with(&assembly, &State::default(), &domains, options).unwrap()
            };
            let (zoomed, whole) = (plan(true), plan(false));
            assert_eq!(zoomed.steps.len(), whole.steps.len(), "{name}");
            assert_eq!(zoomed.fine().count(), whole.fine().count(), "{name}");
            assert!(whole.steps.iter().any(|step| matches!(step.coarse, CoarseAction::Fasten { .. })));
        }
    }
}
