//! Checks a plan from a file by the rules.

use std::fmt::Write;
use std::path::Path;

use miette::{IntoDiagnostic, Report, WrapErr, miette};
use ramp_assembly::Assembly;
use ramp_data::Data;
use ramp_kit::source::{MAX_SENTENCE, plain, read_text, to_name};
use ramp_planner::{CoarseStep, PlanError, Replayer, read_plan};
use ramp_result::planning::{self, PlanVerdict};
use ramp_skills::rehearsal::check_for_arm;
use serde_json::json;

use super::problem::{Arguments, LARGEST, Problem};
use super::text::{json, write_steps};
use crate::output::{check_place, print, write_file};
use crate::software::software;
use crate::status::{DONE, INCOMPLETE};

/// The verdict on a plan.
struct Verdict {
    /// Number of coarse actions.
    coarse: usize,
    /// Time that the planner took, s, if the file has it.
    seconds: Option<f64>,
    /// The refused step with its reason.
    refused: Option<String>,
}

/// Checks the plan in a file, and writes the verdict.
pub(super) fn run(data: &Data, problem: &Problem, path: &Path, arguments: &Arguments) -> Result<u8, Report> {
    let text = read_text(path, LARGEST)?;
    let is_json = text.trim_start().starts_with('{');
    let (mut verdict, found) = match is_json {
        true => (judge_json(problem, path, &text)?, None),
        false => judge_pddl(problem, path, &text)?,
    };
    if arguments.check_motion && arguments.state.is_some() {
        return Err(miette!(
            "--check-motion checks plans that start from the empty table: leave --state out"
        ));
    }
    if arguments.check_motion && verdict.refused.is_none() {
        let plan = read_plan(&text, &problem.goal, &problem.domains).into_diagnostic()?;
        let checked = check_for_arm(&problem.goal, &data.arm()?, &problem.state, &plan);
        verdict.refused = checked.err().map(|stuck| format!("{stuck} ({})", stuck.remedy()));
    }
    write_verdict(arguments, &problem.goal, path, &verdict)?;
    let name = path.display();
    if let Some(refused) = &verdict.refused {
        print(&format!("{name}: refused at {refused}\n"))?;
        return Ok(INCOMPLETE);
    }
    let mut text = String::new();
    match found {
        Some(steps) if arguments.json => {
            text = json(&json!({ "goal": problem.goal.name, "plan": { "steps": steps } }))?;
            print(&text)?;
            return Ok(DONE);
        }
        Some(steps) => write_steps(&mut text, &steps),
        None => {}
    }
    let _ = writeln!(text, "{name}: {} coarse actions, accepted", verdict.coarse);
    print(&text)?;
    Ok(DONE)
}

/// Checks the output of `ramp plan GOAL --json`.
fn judge_json(problem: &Problem, path: &Path, text: &str) -> Result<Verdict, Report> {
    let file = serde_json::from_str::<serde_json::Value>(text);
    let seconds = file.as_ref().ok().and_then(|value| value["seconds"].as_f64());
    let steps = file
        .and_then(|mut value| serde_json::from_value::<Vec<CoarseStep>>(value["plan"]["steps"].take()))
        .map_err(|error| {
            let name = path.display();
            miette!(help = "expected what `ramp plan GOAL --json` prints", "{name} is not a plan: {error}")
        })?;
    let mut table = Replayer::new(&problem.goal, &problem.domains, &problem.state).into_diagnostic()?;
    let refused = table.run(&steps).err().map(|refused| refused.to_string());
    Ok(Verdict { coarse: steps.len(), seconds, refused })
}

/// Checks another planner's plan for the PDDL files; an accepted plan comes back with its fine actions.
fn judge_pddl(
    problem: &Problem,
    path: &Path,
    text: &str,
) -> Result<(Verdict, Option<Vec<CoarseStep>>), Report> {
    let steps = ramp_planner::pddl_plan(&problem.goal, &problem.state, &problem.domains, text);
    match steps {
        Ok(steps) => {
            let verdict = Verdict { coarse: steps.len(), seconds: None, refused: None };
            Ok((verdict, Some(steps)))
        }
        Err(PlanError::Outside(refused)) => {
            let refused = Some(refused.to_string());
            Ok((Verdict { coarse: text.lines().count(), seconds: None, refused }, None))
        }
        Err(error) => Err(error).into_diagnostic().wrap_err_with(|| path.display().to_string()),
    }
}

/// Writes the verdict to the file of `--output`, if one is given. The planner's name is that of its plan's
/// file.
fn write_verdict(
    arguments: &Arguments,
    goal: &Assembly,
    plan: &Path,
    verdict: &Verdict,
) -> Result<(), Report> {
    let Some(path) = &arguments.output else { return Ok(()) };
    check_place(path)?;
    let result = PlanVerdict {
        schema: planning::SCHEMA.to_string(),
        goal: goal.name.clone(),
        class: goal.class.map(|class| class.name()),
        planner: to_name(&plan.file_stem().unwrap_or_default().to_string_lossy()),
        software: software(),
        accepted: verdict.refused.is_none(),
        refused: verdict.refused.as_ref().map(|why| plain(why, MAX_SENTENCE - 1)),
        coarse: verdict.coarse,
        seconds: verdict.seconds,
    };
    write_file(path, &json(&result)?)
}
