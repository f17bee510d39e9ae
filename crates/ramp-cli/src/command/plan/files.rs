//! The planning problem as files for other solvers: an answer set program, or PDDL.

use std::fmt::Write;
use std::path::Path;

use miette::{IntoDiagnostic, Report};

use super::problem::{Level, Problem};
use crate::output::{print, tell, write_file};
use crate::status::DONE;

/// Prints a domain with the goal as an answer set program.
pub(super) fn asp(problem: &Problem, level: Level) -> Result<u8, Report> {
    let fine = matches!(level, Level::Fine);
    print(&ramp_planner::asp(&problem.goal, &problem.domains, fine))?;
    Ok(DONE)
}

/// Writes the coarse domain and the goal as PDDL and in STRIPS, and prints the names of the files.
pub(super) fn pddl(problem: &Problem, folder: &Path) -> Result<u8, Report> {
    let written = ramp_planner::pddl(&problem.goal, &problem.state, &problem.domains).into_diagnostic()?;
    let mut text = String::new();
    let mut files = vec![("domain.pddl", written.domain.clone()), ("problem.pddl", written.problem.clone())];
    match ramp_planner::strips(&problem.goal, &problem.state, &problem.domains) {
        Ok(strips) => {
            files.extend([("strips-domain.pddl", strips.domain), ("strips-problem.pddl", strips.problem)]);
        }
        Err(why) => tell(&format!("no STRIPS files: {why}")),
    }
    for (name, content) in files {
        let path = folder.join(name);
        write_file(&path, content)?;
        let _ = writeln!(text, "{}", path.display());
    }
    print(&text)?;
    Ok(DONE)
}
