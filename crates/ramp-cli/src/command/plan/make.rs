//! Makes a plan and prints it.

use std::fmt::Write;
use std::time::Instant;

use miette::{IntoDiagnostic, Report};
use ramp_data::Data;
use ramp_planner::{Diagnosis, Options, Plan, State};
use ramp_skills::ReferenceTimes;
use ramp_skills::rehearsal::{plan_for_arm, quicker_for_arm};
use serde_json::json;

use super::explain;
use super::problem::{Arguments, Least, Problem};
use super::text::{json, write_steps};
use crate::output::print;
use crate::status::{DONE, INCOMPLETE};

/// A plan with all that is printed about it.
struct Made {
    goal: String,
    plan: Plan,
    /// The state that it starts from, with the motions that the arm cannot do.
    state: State,
    /// Explanations of the history that it continues, the most likely one first.
    diagnoses: Option<Vec<Diagnosis>>,
    /// Time that planning took, s.
    seconds: f64,
    /// Duration of its motions and of those of the plan with the fewest actions, s.
    motions: Option<(f64, f64)>,
    /// Bound and reference of the robot time.
    reference: Option<ReferenceTimes>,
}

/// Makes a plan as the arguments ask, or explains an action of it.
pub(super) fn run(data: &Data, mut problem: Problem, arguments: &Arguments) -> Result<u8, Report> {
    let mut diagnoses = None;
    if let Some(file) = &arguments.history {
        let found = explain::diagnoses(&problem, file)?;
        let Some(first) = found.first() else {
            print("nothing that the domain knows of explains this\n")?;
            return Ok(INCOMPLETE);
        };
        problem.state = first.state.clone();
        diagnoses = Some(found);
    }
    let begin = Instant::now();
    if arguments.check_motion || arguments.least == Least::Time {
        let Problem { goal, domains, state } = &problem;
        problem.state.motion = plan_for_arm(goal, &data.arm()?, state, domains).into_diagnostic()?.facts;
    }
    if let Some(action) = &arguments.why {
        return explain::why(&problem, &problem.state, action, arguments.json);
    }
    let made = make(data, problem, arguments, diagnoses, begin)?;
    print(&if arguments.json { as_json(&made)? } else { as_text(&made, arguments.coarse) })?;
    Ok(DONE)
}

fn make(
    data: &Data,
    problem: Problem,
    arguments: &Arguments,
    diagnoses: Option<Vec<Diagnosis>>,
    begin: Instant,
) -> Result<Made, Report> {
    let Problem { goal, domains, state } = problem;
    let options = Options { optimal: arguments.optimal, fine: !arguments.coarse, ..Options::default() };
    let mut plan = ramp_planner::plan_with(&goal, &state, &domains, options).into_diagnostic()?;
    let mut motions = None;
    if arguments.least == Least::Time {
        let found = quicker_for_arm(&goal, &data.arm()?, &state, &domains, &plan).into_diagnostic()?;
        motions = Some((found.seconds, found.before));
        plan = found.plan;
    }
    let seconds = begin.elapsed().as_secs_f64();
    let mut reference = None;
    if arguments.bound {
        let times = ramp_skills::reference_times(&goal, &data.arm()?, &state, &plan);
        reference = Some(times.into_diagnostic()?);
    }
    Ok(Made { goal: goal.name, plan, state, diagnoses, seconds, motions, reference })
}

fn as_json(made: &Made) -> Result<String, Report> {
    let mut value = json!({ "goal": made.goal, "seconds": made.seconds, "plan": made.plan });
    if let Some(times) = &made.reference {
        value["robot_time"] = json!({ "bound": times.bound, "reference": times.reference });
    }
    if !made.state.motion.is_empty() {
        value["motion"] = json!(made.state.motion);
    }
    if let Some((seconds, before)) = made.motions {
        value["motions"] = json!({ "seconds": seconds, "before": before });
    }
    if let Some(diagnoses) = &made.diagnoses {
        value["diagnoses"] = json!(diagnoses);
    }
    json(&value)
}

fn as_text(made: &Made, coarse: bool) -> String {
    let mut text = String::new();
    for (number, diagnosis) in made.diagnoses.iter().flatten().enumerate() {
        let events = diagnosis.events.iter().map(|event| event.event.as_str()).collect::<Vec<_>>().join(", ");
        let events = if events.is_empty() { "all went as it should".to_string() } else { events };
        let _ = writeln!(text, "{}{events}", if number == 0 { "believed: " } else { "      or: " });
    }
    for fact in &made.state.motion {
        let _ = writeln!(text, "{fact}");
    }
    let steps = &made.plan.steps;
    write_steps(&mut text, steps);
    let fine: usize = steps.iter().map(|step| step.fine.len()).sum();
    let and_fine = if coarse { String::new() } else { format!(" and {fine} fine") };
    let _ = writeln!(text, "{} coarse{and_fine} actions in {:.3} s", steps.len(), made.seconds);
    if let Some((seconds, before)) = made.motions {
        let _ = writeln!(text, "its motions take {seconds:.1} s, instead of {before:.1} s");
    }
    if let Some(times) = &made.reference {
        let _ = writeln!(
            text,
            "no arm with these limits takes less than {:.1} s of robot time; the reference takes {:.1} s",
            times.bound, times.reference
        );
    }
    let _ = match (made.plan.statistics.optimal, made.plan.statistics.lower_bound) {
        (true, _) => writeln!(text, "no plan has fewer coarse actions"),
        (false, 0) => Ok(()),
        (false, bound) => writeln!(text, "no plan has fewer than {bound} coarse actions"),
    };
    text
}
