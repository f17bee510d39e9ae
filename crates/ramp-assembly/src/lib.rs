//! The tasks (section III-B of the paper): a goal file and the kit become an [`Assembly`].
//!
//! Data passes one way. [`read`] turns `goal.xml` into beams and connections, with positions so that every
//! error can point at its place. `pose` places every beam, starting from the clamped one. [`check`] proves
//! that holes meet, that no beams overlap and that an order of straight insertions builds it. [`paths`]
//! decides which beams block which, with the boxes of [`block`] and the swept-box test of [`sweep`]. [`draw`]
//! draws it from above. [`catalogue`] finds goals by name, and [`generate()`] makes new ones. [`Task`] says
//! whether it is built or taken apart. [`truth`] holds the true poses of the parts in a world.
//!
//! Frames: A is the assembly frame (origin at table level under the clamped beam's j1 hole, X along
//! that beam, Y away from the robot, Z up), B a beam's own frame (see [`ramp_kit::Beam`]).

pub mod assembly;
pub mod block;
pub mod catalogue;
pub mod check;
mod class;
pub mod draw;
mod excerpt;
pub mod generate;
pub mod paths;
mod placed;
mod pose;
pub mod read;
pub mod sweep;
mod task;
pub mod truth;

pub use assembly::{Assembly, Class, Connection, Insertion, JointRef, OpenSet, PlacedBeam, Size};
pub use catalogue::{UnknownGoal, check_known, goal_names, in_order};
pub use check::{Fit, Gap, Overlap, Report, report};
pub use draw::{draw_all_svg, draw_svg};
pub use generate::open::{Features, OpenGoal, OpenGoals};
pub use generate::{Generated, Request, generate, generate_many};
pub use ramp_kit::Pose;
pub use read::{GoalError, GoalProblem, read_goal, read_goal_file, read_goal_str};
pub use task::Task;
pub use truth::{Penetration, Truth};
