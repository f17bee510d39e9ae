//! The agent's belief about the parts, and the cameras that correct it.

pub mod estimate;
pub mod eyes;
pub mod obstacles;
pub mod part;
pub mod parts;

pub use parts::Belief;
