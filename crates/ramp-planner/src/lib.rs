//! The task planner (section IV-A of the paper): an [`Assembly`](ramp_assembly::Assembly) and a [`State`] go in, a
//! [`Plan`] at two resolutions comes out. Rules are Answer Set Programs in `data/domains`, solved by clingo inside
//! the process.

pub mod plan;

pub use plan::{Area, CoarseAction, CoarseStep, FineAction, Grasp, Item, Place, Plan, State, Statistics};
