//! Judges plans without clingo: states, conditions and effects by the definition of the language, insertion paths by the
//! shapes of the assembly.
//!
//! `table` is what stands after some actions, `terms` puts the actions of a plan into the words of the rules, and
//! `judge` carries them out.

mod judge;
mod table;
mod terms;

pub use table::Replayer;
