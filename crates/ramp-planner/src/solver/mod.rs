//! clingo, with four functions: check a rule file, find its best answer, find the shortest plan,
//! find explanations.
//!
//! Everything is deterministic: one thread, a fixed seed, and limits counted in conflicts instead
//! of seconds. `control` calls clingo; `scan` filters dangerous input; `search`, `explanations` and
//! `check` are the functions.

mod check;
mod control;
mod error;
mod explanations;
mod problem;
mod scan;
mod search;

pub(crate) use check::check;
pub(crate) use error::SolveError;
pub(crate) use explanations::Happening;
pub use problem::OrderProblem;
pub(crate) use search::Solver;
#[cfg(test)]
pub(crate) use search::shortest_by_clingo;
