//! A domain and a problem in PDDL for planners that read PDDL, and reading of their plans.
//!
//! Sorts become types, statics and fluents predicates, defined fluents derived predicates. The
//! negated conditions of `impossible` laws become preconditions, and the consequences of an effect
//! by state constraints become part of that effect. PDDL has no terms with arguments, so
//! `beam("b4")` and `peg("C1")` become the objects `b4` and `c1`. The language is PDDL 2.2 without
//! numbers (S. Edelkamp, J. Hoffmann, *PDDL2.2: The Language for the Classical Part of the 4th
//! International Planning Competition*, 2004), with conditional effects and derived predicates.
//!
//! `writer` manages names and writes terms and declarations, `laws` writes actions and derived
//! predicates, `files` combines both files, and `plan` reads the planner's plan.

mod error;
mod files;
mod laws;
mod plan;
mod text;
mod writer;

pub use error::PddlError;
pub use files::Pddl;
pub(crate) use plan::words_of_plan;
pub(crate) use text::plain;
