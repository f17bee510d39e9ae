//! `ramp check`: checks structure, geometry and buildability.

use std::fmt::Write;

use miette::{IntoDiagnostic, Report};
use ramp_data::Data;
use serde_json::json;

use crate::output::print;
use crate::status::{DONE, INCOMPLETE};

#[derive(clap::Args)]
pub struct Arguments {
    /// Name of a goal, or a goal file
    goal: String,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let goal = data.goal(&arguments.goal)?;
    let report = ramp_assembly::report(&goal);
    let beam = |index: usize| goal.beams[index].beam.name.as_str();
    let good = report.overlaps.is_empty() && report.insertions.is_some();
    let insertions = report.insertions.as_deref().unwrap_or(&[]);
    let mut text = String::new();
    if arguments.json {
        let value = json!({
            "goal": goal.name,
            "good": good,
            "connections": goal.connections.iter().zip(&report.fits).map(|(connection, fit)| json!({
                "connection": connection.name,
                "female": goal.joint_name(connection.female),
                "male": goal.joint_name(connection.male),
                "residual": fit.residual,
                "gap": fit.gap,
            })).collect::<Vec<_>>(),
            "smallest_gap": report.smallest_gap.map(|gap| gap.width),
            "overlaps": report.overlaps.iter().map(|overlap| json!({
                "beams": [beam(overlap.first), beam(overlap.second)], "depth": overlap.depth,
            })).collect::<Vec<_>>(),
            "insertions": insertions.iter().map(|insertion| json!({
                "beam": beam(insertion.beam),
                "direction": insertion.direction.as_slice(),
                "distance": insertion.distance,
            })).collect::<Vec<_>>(),
        });
        text = serde_json::to_string_pretty(&value).into_diagnostic()?;
        text.push('\n');
    } else {
        let _ = writeln!(text, "{}: {} beams, {} pegs", goal.name, goal.beams.len(), goal.connections.len());
        for (connection, fit) in goal.connections.iter().zip(&report.fits) {
            let _ = writeln!(
                text,
                "  {:<4} {} in {}: holes {:.4} mm apart, gap {:.3} mm",
                connection.name,
                goal.joint_name(connection.male),
                goal.joint_name(connection.female),
                fit.residual * 1e3,
                fit.gap * 1e3
            );
        }
        for overlap in &report.overlaps {
            let (a, b) = (beam(overlap.first), beam(overlap.second));
            let _ = writeln!(text, "  {a} and {b} overlap by {:.3} mm", overlap.depth * 1e3);
        }
        for (number, insertion) in insertions.iter().enumerate() {
            let d = insertion.direction;
            let _ = writeln!(
                text,
                "  {}. {} along ({:+.2}, {:+.2}, {:+.2}), {:.0} mm",
                number + 1,
                beam(insertion.beam),
                d.x,
                d.y,
                d.z,
                insertion.distance * 1e3
            );
        }
        text.push_str(if good { "  it can be built\n" } else { "  it cannot be built\n" });
    }
    print(&text)?;
    Ok(if good { DONE } else { INCOMPLETE })
}
