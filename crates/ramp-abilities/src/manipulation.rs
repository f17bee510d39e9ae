//! The track of manipulation alone: one contact skill at a time, from starts that are drawn at random.
//!
//! A [`task::Task`] is a step of a plan: what stands before it, and what it is to bring about. [`start`]
//! prepares the twin as it would be before that step, [`trial`] lets an agent do it, and [`judge`] compares
//! the truth ([`world`]) with the aim; [`distance`] says how far it is from it. What comes out is a
//! [`Trial`](ramp_result::manipulation::Trial), one JSON file, which [`ramp_result::manipulation`] reads and
//! adds up.

pub mod distance;
pub mod judge;
pub mod start;
pub mod task;
pub mod trial;
pub mod world;

pub use distance::{Progress, progress};
pub use judge::missing;
pub use start::{Cast, Start, StartError, draw};
pub use task::{Aim, Build, Task};
pub use trial::run_trial;
