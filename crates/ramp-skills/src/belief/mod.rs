//! The agent's belief about the parts, and the cameras that correct it.

pub mod estimate;
pub mod eye;
pub mod eyes;
mod in_frame;
mod names;
pub mod obstacles;
pub mod outlines;
pub mod own_finder;
pub mod part;
pub mod parts;
mod places;
mod poses;
mod repeats;
mod strewn;
pub mod surroundings;

pub use own_finder::OwnFinder;
pub use parts::Belief;
pub use strewn::{beside, is_clearly_better};
