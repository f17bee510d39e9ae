//! `ramp plan`: coarse and fine actions.

use std::fmt::Write;
use std::time::Instant;

use miette::{IntoDiagnostic, Report};
use ramp_planner::State;
use serde_json::json;

use crate::DONE;
use crate::data::{Data, print};

#[derive(clap::Args)]
pub struct Arguments {
    /// Name of a goal, or a goal file
    goal: String,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let kit = data.kit()?;
    let goal = data.goal(&arguments.goal, &kit)?;
    let domains = data.domains()?;
    let begin = Instant::now();
    let plan = ramp_planner::plan(&goal, &kit, &State::default(), &domains).into_diagnostic()?;
    let seconds = begin.elapsed().as_secs_f64();
    let mut text = String::new();
    if arguments.json {
        let value = json!({ "goal": goal.name, "seconds": seconds, "plan": plan });
        text = serde_json::to_string_pretty(&value).into_diagnostic()?;
        text.push('\n');
    } else {
        for (number, step) in plan.steps.iter().enumerate() {
            let _ = writeln!(text, "{:>3}  {}", number + 1, step.coarse);
            for action in &step.fine {
                let _ = writeln!(text, "       {action}");
            }
        }
        let fine: usize = plan.steps.iter().map(|step| step.fine.len()).sum();
        let _ = writeln!(text, "{} coarse and {fine} fine actions in {seconds:.3} s", plan.steps.len());
    }
    print(&text)?;
    Ok(DONE)
}
