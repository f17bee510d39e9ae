//! `ramp plan`: plans of coarse and fine actions, the reasons for their order, and the planning problem as
//! files.
//!
//! [`run`] reads the problem and hands it to one of the jobs: `make` a plan, `judge` one from a file,
//! `explain` an action, a history or the way back (taking the goal apart), or write the problem as `files`
//! for other solvers.

mod explain;
mod files;
mod judge;
mod make;
mod problem;
mod text;

use miette::Report;
use ramp_data::Data;

pub use self::problem::Arguments;
use self::problem::Problem;

/// Runs `ramp plan`.
///
/// # Errors
/// The first problem in the arguments or the files, or that the goal has no plan.
pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let problem = Problem::read(data, arguments)?;
    if let Some(level) = arguments.emit_asp {
        return files::asp(&problem, level);
    }
    if let Some(folder) = &arguments.pddl {
        return files::pddl(&problem, folder);
    }
    if let Some(path) = &arguments.from {
        return judge::run(data, &problem, path, arguments);
    }
    if arguments.disassemble {
        return explain::disassembly(&problem, arguments);
    }
    make::run(data, problem, arguments)
}
