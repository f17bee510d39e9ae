//! Judges plans without clingo: states, conditions and effects by the definition of the language,
//! insertion paths by the shapes of the assembly.
//!
//! `table` holds the state after some actions, `terms` translates the actions of a plan into terms
//! of the rules, and `judge` executes them.

mod judge;
mod table;
mod terms;

pub use table::Replayer;
