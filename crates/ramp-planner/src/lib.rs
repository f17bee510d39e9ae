//! The task planner (section IV-A of the paper): an [`Assembly`](ramp_assembly::Assembly) and a
//! [`State`] go in, a [`Plan`] at two resolutions comes out. The rules are two domains in the
//! action [`language`] and a program for the order, all in `data/domains`. clingo solves them
//! inside the process (`solver`).
//!
//! Data passes one way, through the three rule files of [`Domains`]:
//!
//! 1. `order.lp` determines the order of the beams, and whether it can be carried out;
//! 2. `coarse.al` turns the order, task by task, into the fewest coarse actions;
//! 3. `fine.al` refines one coarse action at a time into fine actions: places, grasps, joints.
//!
//! [`plan()`] passes each level its input as ground facts (`facts`, from the assembly's `geometry`)
//! and its answer to the next level. A level without an answer asks the one above for another
//! decision.

mod answer;
mod diagnosis;
mod disassemble;
mod domains;
mod error;
mod explain;
mod facts;
mod fine_action;
mod geometry;
mod limits;
mod motion;
mod pddl;
mod pegs;
mod place;
pub mod plan;
mod plan_file;
mod planner;
mod quicker;
mod replay;
mod solver;
mod state;

pub use diagnosis::{Diagnosis, History, Record, Unexpected, diagnose};
pub use disassemble::{backwards, disassemble, left_of};
pub use domains::{DomainError, Domains};
pub use error::{PlanError, Refused};
pub use explain::{Explanation, Reason, why};
pub use limits::{Exceeded, Limit, Limits, Watch};
pub use motion::{End, Impossible, InTheWay, MotionFact};
pub use pddl::{pddl, pddl_plan, strips};
pub use plan::{
    ActionKind, Area, CoarseAction, CoarseStep, Entry, FineAction, Grasp, Item, Place, Plan, State,
    Statistics, Target,
};
pub use plan_file::{PlanFileError, read_plan, read_plan_from};
pub use planner::{Options, asp, plan, plan_with};
pub use quicker::quicker;
pub use ramp_action_language as language;
pub use ramp_action_language::Pddl;
pub use replay::Replayer;
pub use solver::OrderProblem;
