//! What the agent believes of the parts, and the eyes that correct it.

pub mod estimate;
pub mod eyes;
pub mod obstacles;
pub mod part;
pub mod parts;

pub use parts::Belief;
