//! Plans as text and as JSON.

use std::fmt::Write;

use miette::{IntoDiagnostic, Report};
use ramp_planner::CoarseStep;

/// A value as indented JSON with a newline at its end.
pub(super) fn json(value: &impl serde::Serialize) -> Result<String, Report> {
    Ok(serde_json::to_string_pretty(value).into_diagnostic()? + "\n")
}

/// Numbered coarse actions, each with its fine actions below it.
pub(super) fn write_steps(text: &mut String, steps: &[CoarseStep]) {
    for (number, step) in steps.iter().enumerate() {
        let _ = writeln!(text, "{:>3}  {}", number + 1, step.coarse);
        for action in &step.fine {
            let _ = writeln!(text, "       {action}");
        }
    }
}
