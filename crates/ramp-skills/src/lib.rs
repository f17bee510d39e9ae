//! Action execution (section IV-B of the paper): the baseline agent.
//!
//! Data passes one way: [`agent`] asks the planner for a plan and runs it action by action; each action is a skill
//! ([`transport`], [`insert`], [`slide`], [`fasten`], [`align`], [`regrasp`]); skills move the [`hand`], which is the
//! only one to talk to the robot. What a skill knows of the parts is a [`belief`], which what its [`eyes`] see corrects
//! ([`estimate`]) and which it improves by looking ([`look`]); from it follow where a beam is to stand ([`target`]) and
//! where a hand can grip ([`grasp`]). Beams that stall are felt in ([`feel`]). What goes wrong is put down to a cause in
//! [`diagnosis`]. [`piece`] is the same agent at a single piece of a plan, in a build that others have begun.

pub mod agent;
pub mod align;
pub mod belief;
pub mod diagnosis;
pub mod estimate;
pub mod eyes;
pub mod fasten;
pub mod fault;
pub mod feel;
pub mod grasp;
pub mod hand;
pub mod insert;
pub mod look;
pub mod piece;
pub mod regrasp;
pub mod slide;
pub mod target;
pub mod transport;

pub use agent::Baseline;
pub use fault::{Fault, SkillError};
pub use piece::Piece;

/// A rigid pose.
pub type Pose = nalgebra::Isometry3<f64>;
