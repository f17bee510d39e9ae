//! A domain and a problem in PDDL for planners that read PDDL, and their plans back.
//!
//! Sorts become types, statics and fluents predicates, defined fluents derived predicates; what forbids an action
//! becomes its precondition, and what follows from an effect by a state constraint becomes part of that effect. PDDL
//! has no terms with arguments, so `beam("b4")` and `peg("C1")` become the objects `b4` and `c1`.
//! The language is PDDL 2.2 without numbers (S. Edelkamp, J. Hoffmann, *PDDL2.2: The Language for the Classical Part
//! of the 4th International Planning Competition*, 2004), with conditional effects and derived predicates.
//!
//! `writer` keeps the names and writes terms and declarations, `laws` writes actions and derived predicates, `files`
//! puts both files together, and `plan` reads what a planner answers.

mod error;
mod files;
mod laws;
mod plan;
mod text;
mod writer;

pub use error::PddlError;
pub use files::Pddl;
