//! Explanation of an action's place in a plan: all reasons against it at earlier steps.

use crate::domains::Domains;
use crate::error::PlanError;
use crate::plan::State;
use crate::planner::{Options, Planner};
use crate::state::look_up;
use ramp_assembly::Assembly;
use ramp_source::nearest;
use serde::Serialize;

/// Explanation of an action's place.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Explanation {
    /// The action, in the syntax of the rules.
    pub action: String,
    /// Its step in the plan, counted from 1.
    pub step: usize,
    /// All reasons against it at earlier steps, sorted by their end.
    pub reasons: Vec<Reason>,
}

/// A law that forbade the action for some steps.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Reason {
    /// First step before which it was impossible.
    pub from: usize,
    /// Last such step.
    pub to: usize,
    /// The law, as in the domain.
    pub law: String,
    /// Its line in the file.
    pub line: usize,
    /// Its conditions, with their values.
    pub because: Vec<String>,
}

/// Explains the place of a coarse action, such as `assemble(b9)`, in the plan for a goal.
///
/// # Errors
/// When there is no plan, or the plan has no such action.
///
/// ```
/// use ramp_planner::{Domains, State, why};
///
/// let kit = ramp_kit::read_kit("../../data/kit.xml".as_ref())?;
/// let assembly = ramp_assembly::read_goal("../../data/goals/easy-3.xml".as_ref(), &kit)?;
/// let domains = Domains::read("../../data/domains".as_ref())?;
/// let explanation = why(&assembly, &State::default(), &domains, "push(b4)")?;
/// assert!(explanation.reasons.iter().any(|reason| reason.law == "impossible push(B) if -in_assembly(B)"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn why(
    assembly: &Assembly,
    state: &State,
    domains: &Domains,
    action: &str,
) -> Result<Explanation, PlanError> {
    let known = look_up(assembly, state)?;
    let mut planner = Planner::new(assembly, domains, Options::default(), known.motion.clone());
    let transitions = planner.transitions(&known)?;
    let plain = |text: &str| text.chars().filter(|c| !c.is_whitespace() && *c != '"').collect::<String>();
    let wanted = plain(action);
    let names: Vec<String> =
        transitions.iter().map(|transition| plain(&transition.action.to_string())).collect();
    let Some(index) = names.iter().position(|name| *name == wanted) else {
        return Err(PlanError::UnknownAction {
            name: wanted.clone(),
            nearest: nearest(&wanted, names.iter().map(String::as_str)).map(str::to_string),
        });
    };
    let target = &transitions[index].action;
    let mut reasons: Vec<Reason> = Vec::new();
    for (step, transition) in transitions[..index].iter().enumerate() {
        let found = planner.model.why_not(&transition.before, target);
        for reason in found.map_err(|refusal| planner.refused(refusal, action))? {
            let open = reasons.iter_mut().find(|last| {
                last.to == step && last.line == reason.line && last.because == reason.conditions
            });
            match open {
                Some(last) => last.to = step + 1,
                None => reasons.push(Reason {
                    from: step + 1,
                    to: step + 1,
                    law: reason.law,
                    line: reason.line,
                    because: reason.conditions,
                }),
            }
        }
    }
    reasons.sort_by(|a, b| (a.to, a.from, a.line, &a.because).cmp(&(b.to, b.from, b.line, &b.because)));
    Ok(Explanation { action: target.to_string(), step: index + 1, reasons })
}
