//! Action execution (section IV-B of the paper): the baseline agent and its skills.
//!
//! Data flows one way. The [`agent`] asks the planner for a plan and executes it action by action. For
//! each fine action a [`table`] names the [`skill`] that carries it out. Skills are made of
//! [`primitive`]s, which move the [`hand`]; only the hand talks to the robot. A skill knows the parts
//! only through a [`belief`], which detections correct. [`piece`] is the same agent on a single piece of
//! a plan, in an assembly begun by another agent. [`rehearsal`] simulates a plan without moving anything,
//! and [`reference_times`](mod@reference_times) gives reference values for its robot time.
//! [`survey`](mod@survey) measures what stands afterwards. [`replaced`](mod@replaced) names an agent
//! whose parts are not all the baseline's.

pub mod agent;
pub mod belief;
pub mod cell;
pub mod change;
pub mod clear;
pub mod fault;
pub mod grasp;
pub mod hand;
pub mod history;
pub mod insertion_path;
pub mod parameters;
pub mod piece;
pub mod pose;
pub mod primitive;
pub mod recognition;
pub mod recovery;
pub mod reference_times;
pub mod rehearsal;
pub mod replaced;
pub mod skill;
pub mod survey;
pub mod table;
pub mod way;

pub use agent::{Baseline, OwnPlanner};
pub use belief::OwnFinder;
pub use fault::{Fault, SkillError};
pub use parameters::Parameters;
pub use piece::Piece;
pub use pose::Pose;
pub use reference_times::{ReferenceTimes, reference_times, reference_times_of_goal};
pub use replaced::Replaced;
pub use survey::survey;
pub use table::SkillTable;
