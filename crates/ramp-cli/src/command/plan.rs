//! `ramp plan`: coarse and fine actions, why they come in this order, and the rules behind them.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use miette::{IntoDiagnostic, Report, WrapErr, miette};
use ramp_assembly::Assembly;
use ramp_kit::source::{MAX_SENTENCE, plain, read_text, to_name};
use ramp_planner::{CoarseStep, Diagnosis, History, Options, PlanError, Replayer, State};
use ramp_result::planning::{self, PlanVerdict};
use serde_json::json;

use crate::data::Data;
use crate::output::{check_place, print, write_file};
use crate::software::software;
use crate::status::{DONE, INCOMPLETE};

#[derive(clap::Args)]
pub struct Arguments {
    /// Name of a goal, or a goal file
    goal: String,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Prove that no plan has fewer coarse actions; takes much longer
    #[arg(long)]
    optimal: bool,
    /// Coarse actions only
    #[arg(long)]
    coarse: bool,
    /// Say what forbade a coarse action before its place in the plan
    #[arg(long, value_name = "ACTION", conflicts_with_all = ["emit_asp", "from"])]
    why: Option<String>,
    /// Use this file in place of the one of its kind: a coarse or fine domain (.al), or rules for the order (.lp)
    #[arg(long, value_name = "FILE")]
    domain: Option<PathBuf>,
    /// Judge the plan in this file instead of making one: JSON as printed by --json, or another planner's plan for
    /// what --pddl wrote, which also gets its fine actions
    #[arg(long, value_name = "FILE", conflicts_with = "emit_asp")]
    from: Option<PathBuf>,
    /// With --from: also write the verdict as a result file, for `ramp report`
    #[arg(short, long, value_name = "FILE", requires = "from")]
    output: Option<PathBuf>,
    /// Print a domain with this goal as an Answer Set Program for clingo's incremental mode
    #[arg(long, value_name = "LEVEL", num_args = 0..=1, default_missing_value = "coarse")]
    emit_asp: Option<Level>,
    /// Write the coarse domain and this goal as domain.pddl and problem.pddl to a folder, for other planners
    #[arg(long, value_name = "DIR", conflicts_with_all = ["emit_asp", "from", "why", "history", "disassemble"])]
    pddl: Option<PathBuf>,
    /// Plan from the state in this file (JSON) instead of from nothing
    #[arg(long, value_name = "FILE", conflicts_with = "emit_asp")]
    state: Option<PathBuf>,
    /// Explain the actions and observations in this file (JSON), and plan from what is believed then
    #[arg(long, value_name = "FILE", conflicts_with_all = ["emit_asp", "from", "why", "state"])]
    history: Option<PathBuf>,
    /// Go through the plan with the arm's model, and plan around what the arm cannot do
    #[arg(long, conflicts_with_all = ["emit_asp", "from", "pddl", "disassemble"])]
    check_motion: bool,
    /// What the plan is to have least of. With time, pegs and fastenings are exchanged with each other until the ways of
    /// the arm take least, by its motion planner
    #[arg(long, value_name = "WHAT", value_enum, default_value_t = Least::Actions,
        conflicts_with_all = ["emit_asp", "from", "pddl", "why", "coarse", "disassemble"])]
    least: Least,
    /// Also print what robot times are to be compared with: a bound that no arm can beat, and a reference
    #[arg(long, conflicts_with_all = ["emit_asp", "from", "pddl", "why", "disassemble"])]
    bound: bool,
    /// Take the built goal apart: the same rules, run backwards
    #[arg(long, conflicts_with_all = ["emit_asp", "from", "why", "state", "history", "optimal"])]
    disassemble: bool,
}

/// The largest plan, state or history, bytes.
const LARGEST: usize = 16 << 20;

/// The two resolutions.
#[derive(Clone, Copy, clap::ValueEnum)]
enum Level {
    Coarse,
    Fine,
}

/// What a plan has least of.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Least {
    Actions,
    Time,
}

/// Reads a JSON file; `expected` says what of.
fn read_json<T: serde::de::DeserializeOwned>(path: &Path, expected: &'static str) -> Result<T, Report> {
    let name = path.display();
    let text = read_text(path, LARGEST)?;
    serde_json::from_str(&text).map_err(|error| {
        let place = format!("{name}:{}:{}", error.line(), error.column());
        miette!(help = expected, "{place}: {}", plain(&error.to_string(), MAX_SENTENCE))
    })
}

/// Writes what came of judging a plan, and how many coarse actions it has, where a file is asked for. The planner is
/// called as its plan's file is.
fn write_verdict(
    arguments: &Arguments,
    goal: &Assembly,
    plan: &Path,
    (verdict, coarse): &(Result<(), String>, usize),
    seconds: Option<f64>,
) -> Result<(), Report> {
    let Some(path) = &arguments.output else { return Ok(()) };
    check_place(path)?;
    let result = PlanVerdict {
        schema: planning::SCHEMA.to_string(),
        goal: goal.name.clone(),
        class: goal.class.map(|class| class.name().to_string()),
        planner: to_name(&plan.file_stem().unwrap_or_default().to_string_lossy()),
        software: software(),
        accepted: verdict.is_ok(),
        refused: verdict.as_ref().err().map(|why| plain(why, MAX_SENTENCE - 1)),
        coarse: *coarse,
        seconds,
    };
    let text = serde_json::to_string_pretty(&result).into_diagnostic()? + "\n";
    write_file(path, &text)
}

fn write_steps(text: &mut String, steps: &[CoarseStep]) {
    for (number, step) in steps.iter().enumerate() {
        let _ = writeln!(text, "{:>3}  {}", number + 1, step.coarse);
        for action in &step.fine {
            let _ = writeln!(text, "       {action}");
        }
    }
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let kit = data.kit()?;
    let goal = data.goal(&arguments.goal, &kit)?;
    let domains = data.domains(arguments.domain.as_deref())?;
    let mut state = match &arguments.state {
        Some(file) => read_json(
            file,
            "expected a state, such as {\"in_assembly\": [\"b4\"], \"fastened\": [[\"C1\", \"p1\"]]}",
        )?,
        None => State::default(),
    };
    if let Some(level) = arguments.emit_asp {
        let fine = matches!(level, Level::Fine);
        print(&ramp_planner::asp(&goal, &domains, fine))?;
        return Ok(DONE);
    }
    if let Some(folder) = &arguments.pddl {
        let written = ramp_planner::pddl(&goal, &state, &domains).into_diagnostic()?;
        let mut text = String::new();
        for (name, content) in [("domain.pddl", &written.domain), ("problem.pddl", &written.problem)] {
            let path = folder.join(name);
            write_file(&path, content)?;
            let _ = writeln!(text, "{}", path.display());
        }
        print(&text)?;
        return Ok(DONE);
    }
    let mut diagnoses: Option<Vec<Diagnosis>> = None;
    if let Some(file) = &arguments.history {
        let history: History = read_json(
            file,
            "expected {\"records\": [{\"did\": {\"action\": \"move\", \"to\": \"input\"}}, {\"saw\": \"at(input)\"}]}",
        )?;
        let found = ramp_planner::diagnose(&goal, &domains, &history).into_diagnostic()?;
        let Some(first) = found.first() else {
            print("nothing that the domain knows of explains this\n")?;
            return Ok(INCOMPLETE);
        };
        state = first.state.clone();
        diagnoses = Some(found);
    }
    let begin = Instant::now();
    if arguments.check_motion || arguments.least == Least::Time {
        let rehearsed = ramp_skills::rehearsal::plan_for_arm(&goal, &data.arm()?, &state, &domains);
        state.motion = rehearsed.into_diagnostic()?.facts;
    }
    if let Some(path) = &arguments.from {
        let name = path.display();
        let text = read_text(path, LARGEST)?;
        if !text.trim_start().starts_with('{') {
            let steps = ramp_planner::pddl_plan(&goal, &state, &domains, &text);
            let steps = match steps {
                Ok(steps) => steps,
                Err(PlanError::Outside(refused)) => {
                    let verdict = (Err(refused.to_string()), text.lines().count());
                    write_verdict(arguments, &goal, path, &verdict, None)?;
                    print(&format!("{name}: refused at {refused}\n"))?;
                    return Ok(INCOMPLETE);
                }
                Err(error) => return Err(error).into_diagnostic().wrap_err_with(|| format!("{name}")),
            };
            write_verdict(arguments, &goal, path, &(Ok(()), steps.len()), None)?;
            let mut text = String::new();
            if arguments.json {
                let value = json!({ "goal": goal.name, "plan": { "steps": steps } });
                text = serde_json::to_string_pretty(&value).into_diagnostic()?;
                text.push('\n');
            } else {
                write_steps(&mut text, &steps);
                let _ = writeln!(text, "{name}: {} coarse actions, accepted", steps.len());
            }
            print(&text)?;
            return Ok(DONE);
        }
        let file = serde_json::from_str::<serde_json::Value>(&text);
        let seconds = file.as_ref().ok().and_then(|value| value["seconds"].as_f64());
        let steps = file
            .and_then(|mut value| serde_json::from_value::<Vec<CoarseStep>>(value["plan"]["steps"].take()))
            .map_err(|error| {
                miette!(
                    help = "expected what `ramp plan GOAL --json` prints",
                    "{name} is not a plan: {error}"
                )
            })?;
        let mut table = Replayer::new(&goal, &domains, &state).into_diagnostic()?;
        let verdict = table.run(&steps);
        let words = match &verdict {
            Ok(()) => Ok(()),
            Err(refused) => Err(refused.to_string()),
        };
        write_verdict(arguments, &goal, path, &(words, steps.len()), seconds)?;
        return match verdict {
            Ok(()) => {
                print(&format!("{name}: {} coarse actions, accepted\n", steps.len()))?;
                Ok(DONE)
            }
            Err(refused) => {
                print(&format!("{name}: refused at {refused}\n"))?;
                Ok(INCOMPLETE)
            }
        };
    }
    if let Some(action) = &arguments.why {
        let explanation = ramp_planner::why(&goal, &state, &domains, action).into_diagnostic()?;
        let mut text = String::new();
        if arguments.json {
            text = serde_json::to_string_pretty(&explanation).into_diagnostic()?;
            text.push('\n');
        } else {
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
        }
        print(&text)?;
        return Ok(DONE);
    }
    let options = Options { optimal: arguments.optimal, fine: !arguments.coarse, ..Options::default() };
    if arguments.disassemble {
        let plan = ramp_planner::disassemble(&goal, &domains).into_diagnostic()?;
        let mut text = String::new();
        if arguments.json {
            text = serde_json::to_string_pretty(&json!({ "goal": goal.name, "disassembly": plan }))
                .into_diagnostic()?;
            text.push('\n');
        } else {
            for (number, step) in plan.steps.iter().enumerate() {
                let _ = writeln!(text, "{:>3}  {}", number + 1, step.coarse);
                for action in step.fine.iter().filter(|_| !arguments.coarse) {
                    let _ = writeln!(text, "       {action}");
                }
            }
        }
        print(&text)?;
        return Ok(DONE);
    }
    let mut plan = ramp_planner::plan_with(&goal, &state, &domains, options).into_diagnostic()?;
    let mut times = None;
    if arguments.least == Least::Time {
        let arm = data.arm()?;
        let found = ramp_skills::rehearsal::quicker_for_arm(&goal, &arm, &state, &domains, &plan);
        let found = found.into_diagnostic()?;
        times = Some((found.seconds, found.before));
        plan = found.plan;
    }
    let seconds = begin.elapsed().as_secs_f64();
    let mut reference = None;
    if arguments.bound {
        let times = ramp_skills::reference_times(&goal, &data.arm()?, &state, &plan);
        reference = Some(times.into_diagnostic()?);
    }
    let mut text = String::new();
    if arguments.json {
        let mut value = json!({ "goal": goal.name, "seconds": seconds, "plan": plan });
        if let Some(times) = reference {
            value["robot_time"] = json!({ "bound": times.bound, "reference": times.reference });
        }
        if !state.motion.is_empty() {
            value["motion"] = json!(state.motion);
        }
        if let Some((seconds, before)) = times {
            value["motions"] = json!({ "seconds": seconds, "before": before });
        }
        if let Some(diagnoses) = &diagnoses {
            value["diagnoses"] = json!(diagnoses);
        }
        text = serde_json::to_string_pretty(&value).into_diagnostic()?;
        text.push('\n');
    } else {
        for (number, diagnosis) in diagnoses.iter().flatten().enumerate() {
            let events =
                diagnosis.events.iter().map(|event| event.event.as_str()).collect::<Vec<_>>().join(", ");
            let events = if events.is_empty() { "all went as it should".to_string() } else { events };
            let _ = writeln!(text, "{}{events}", if number == 0 { "believed: " } else { "      or: " });
        }
        for fact in &state.motion {
            let _ = writeln!(text, "{fact}");
        }
        write_steps(&mut text, &plan.steps);
        let fine: usize = plan.steps.iter().map(|step| step.fine.len()).sum();
        let and_fine = if arguments.coarse { String::new() } else { format!(" and {fine} fine") };
        let _ = writeln!(text, "{} coarse{and_fine} actions in {seconds:.3} s", plan.steps.len());
        if let Some((seconds, before)) = times {
            let _ = writeln!(text, "its motions take {seconds:.1} s, instead of {before:.1} s");
        }
        if let Some(times) = reference {
            let _ = writeln!(
                text,
                "no arm with these limits takes less than {:.1} s of robot time; the reference takes {:.1} s",
                times.bound, times.reference
            );
        }
        let _ = match (plan.statistics.optimal, plan.statistics.lower_bound) {
            (true, _) => writeln!(text, "no plan has fewer coarse actions"),
            (false, 0) => Ok(()),
            (false, bound) => writeln!(text, "no plan has fewer than {bound} coarse actions"),
        };
    }
    print(&text)?;
    Ok(DONE)
}
