//! The tracks of a single ability, each judged without the others.
//!
//! [`perception`] makes images with labels, and judges any detector on them. [`manipulation`] prepares the
//! twin as it would be before one step of a plan, lets an agent do that step, and judges by the truth.
//! Planning alone needs no world: the planner's replayer judges a plan, and [`ramp_result::planning`] is its
//! verdict.

pub mod manipulation;
pub mod perception;
