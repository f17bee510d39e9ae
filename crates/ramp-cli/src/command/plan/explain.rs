//! Explanations: the position of an action in the plan, the events of a history, and the disassembly of the
//! goal.

use std::fmt::Write;
use std::path::Path;

use miette::{IntoDiagnostic, Report};
use ramp_planner::{Diagnosis, History, State};
use serde_json::json;

use super::problem::{Arguments, Problem, read_json};
use super::text::json;
use crate::output::print;
use crate::status::DONE;

/// Prints the reasons why a coarse action cannot come earlier.
pub(super) fn why(problem: &Problem, state: &State, action: &str, as_json: bool) -> Result<u8, Report> {
    let Problem { goal, domains, .. } = problem;
    let explanation = ramp_planner::why(goal, state, domains, action).into_diagnostic()?;
    if as_json {
        print(&json(&explanation)?)?;
        return Ok(DONE);
    }
    let mut text = String::new();
    let _ = writeln!(text, "{} is step {}.", explanation.action, explanation.step);
    for reason in &explanation.reasons {
        let steps = match reason.from == reason.to {
            true => format!("Before step {}", reason.from),
            false => format!("Before steps {} to {}", reason.from, reason.to),
        };
        let because = reason.because.join(", ");
        let because = if because.is_empty() { String::new() } else { format!(", and {because}") };
        let file = domains.coarse().file().name();
        let _ = writeln!(text, "{steps}: {}{because} ({file}:{})", reason.law, reason.line);
    }
    print(&text)?;
    Ok(DONE)
}

/// The explanations of a history, the most likely one first; empty if the domain has none.
pub(super) fn diagnoses(problem: &Problem, file: &Path) -> Result<Vec<Diagnosis>, Report> {
    let history: History = read_json(
        file,
        "expected {\"records\": [{\"did\": {\"action\": \"move\", \"to\": \"input\"}}, {\"saw\": \"at(input)\"}]}",
    )?;
    ramp_planner::diagnose(&problem.goal, &problem.domains, &history).into_diagnostic()
}

/// Prints the disassembly plan of the finished goal.
pub(super) fn disassembly(problem: &Problem, arguments: &Arguments) -> Result<u8, Report> {
    let plan = ramp_planner::disassemble(&problem.goal, &problem.domains).into_diagnostic()?;
    if arguments.json {
        print(&json(&json!({ "goal": problem.goal.name, "disassembly": plan }))?)?;
        return Ok(DONE);
    }
    let mut text = String::new();
    for (number, step) in plan.steps.iter().enumerate() {
        let _ = writeln!(text, "{:>3}  {}", number + 1, step.coarse);
        for action in step.fine.iter().filter(|_| !arguments.coarse) {
            let _ = writeln!(text, "       {action}");
        }
    }
    print(&text)?;
    Ok(DONE)
}
