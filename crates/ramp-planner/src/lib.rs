//! The task planner (section IV-A of the paper): an [`Assembly`](ramp_assembly::Assembly) and a [`State`] go in, a
//! [`Plan`] at two resolutions comes out. Rules are Answer Set Programs in `data/domains`, solved by clingo inside
//! the process.
//!
//! Data passes one way, through the three rule files of [`Domains`]:
//!
//! 1. `order.lp` says in which order the beams are placed, and whether that order can be carried out;
//! 2. `coarse.lp` turns the order into tasks and each task into the fewest coarse actions;
//! 3. `fine.lp` looks at one coarse action at a time and finds the fine actions for it: places, grasp, joints.
//!
//! [`plan()`] tells each level what it must know as ground facts and carries its answer on to the next.

mod domains;
mod error;
mod facts;
pub mod plan;
mod planner;
mod shape;
mod solver;
mod state;
mod term;

pub use domains::{DomainError, DomainProblem, Domains};
pub use error::PlanError;
pub use plan::{
    Area, CoarseAction, CoarseStep, FineAction, Grasp, Item, Place, Plan, State, Statistics, Target,
};
pub use planner::plan;
