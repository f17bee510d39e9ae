//! The task planner (section IV-A of the paper): an [`Assembly`](ramp_assembly::Assembly) and a [`State`] go in, a
//! [`Plan`] at two resolutions comes out. The rules are two domains in the action [`language`] and
//! a program for the order, all in `data/domains`. clingo solves them inside the process (`solver`).
//!
//! Data passes one way, through the three rule files of [`Domains`]:
//!
//! 1. `order.lp` says in which order the beams are placed, and whether that order can be carried out;
//! 2. `coarse.al` turns the order, task by task, into the fewest coarse actions;
//! 3. `fine.al` looks at one coarse action at a time and finds the fine actions for it: places, grasp, joints.
//!
//! [`plan()`] tells each level what it must know as ground facts (`facts`, from the assembly's `geometry`) and
//! carries its answer on to the next. A level that finds no answer asks the one above for another decision.

mod answer;
mod diagnosis;
mod disassemble;
mod domains;
mod error;
mod explain;
mod facts;
mod geometry;
mod limits;
mod motion;
mod pddl;
mod pegs;
pub mod plan;
mod plan_file;
mod planner;
mod quicker;
mod replay;
mod solver;
mod state;

pub use diagnosis::{Diagnosis, History, Record, Unexpected, diagnose};
pub use disassemble::{Disassembly, FineRemoval, Removal, RemovalStep, disassemble};
pub use domains::{DomainError, Domains};
pub use error::{PlanError, Refused};
pub use explain::{Explanation, Reason, why};
pub use limits::{Exceeded, Limit, Limits, Watch};
pub use motion::{End, Impossible, InTheWay, MotionFact};
pub use pddl::{pddl, pddl_plan};
pub use plan::{
    Area, CoarseAction, CoarseStep, Entry, FineAction, Grasp, Item, Place, Plan, State, Statistics, Target,
};
pub use plan_file::{PlanFileError, read_plan};
pub use planner::{Options, asp, plan, plan_with};
pub use quicker::quicker;
pub use ramp_action_language as language;
pub use ramp_action_language::Pddl;
pub use replay::Replayer;
pub use solver::OrderProblem;
