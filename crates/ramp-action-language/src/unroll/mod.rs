//! The domain unrolled over time: a ground program for clingo, extended step by step.
//!
//! It is a subset of what clingo's own grounder would write for a domain's translation. The initial
//! state is known, so at every time the fluents are partitioned into those that must be true, those
//! that cannot be true, and those that a plan can decide. Only the last get atoms, only actions
//! that nothing certain forbids become choices, and a fluent that no step can change keeps its
//! atom. A goal that cannot be true yet needs no search.
//!
//! The rules are those of the translation (`Domain::to_asp`); a test of `ramp-planner` solves both
//! and compares.
//!
//! `step` makes choices of the candidates, `follow` adds their consequences within the bounds of
//! `relax`, and `goal` evaluates goals.

mod candidate;
mod follow;
mod goal;
mod program;
mod relax;
mod step;
mod unrolled;

pub(crate) use candidate::Candidate;
pub use program::{GroundRule, Literal, Prospect};
pub use unrolled::Unrolled;
