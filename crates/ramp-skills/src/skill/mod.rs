//! The skills, one file each, named by the action.

pub mod assemble;
pub mod cap;
pub mod contract;
pub mod fasten;
pub mod insertion;
pub mod lay_down;
pub mod move_to;
pub mod pick_up;
pub mod pull_out;
pub mod push;
pub mod put_down;
pub mod regrasp;
pub mod slide;
pub mod slide_back;
pub mod take_out;

pub use contract::{ActionKind, Call, Effect, Need, Skill};
