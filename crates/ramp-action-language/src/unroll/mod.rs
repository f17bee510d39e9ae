//! The domain unrolled over time: a ground program for clingo, one step after another.
//!
//! What clingo's own grounder would write of a domain's translation, but less of it: the state at the beginning is
//! known, so at every time the fluents fall into those that must be true, those that cannot be, and those that a
//! plan can decide. Only the last become atoms, only actions that nothing certain forbids become choices, and what no
//! step can touch keeps its atom from one time to the next. A goal that cannot be true yet needs no search.
//!
//! The rules are those of the translation (`Domain::to_asp`); a test of `ramp-planner` solves both and compares.
//!
//! `step` makes choices of the candidates, `follow` adds what they bring about within the bounds of `relax`, and
//! `goal` says what a goal needs.

mod candidate;
mod follow;
mod goal;
mod program;
mod relax;
mod step;
mod unrolled;

pub use program::{GroundRule, Literal, Prospect};
pub use unrolled::Unrolled;
