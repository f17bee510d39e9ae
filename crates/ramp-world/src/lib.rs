//! Worlds and starts: the physics of an episode, and where its parts lie at its begin.
//!
//! A world is a file: the friction of the arm's joints, its delays, its sensors and their errors, the
//! tolerances of the parts. [`World`] reads it: each number with its unit, its distribution and its source.
//! [`World::draw`] gives the numbers of one episode, a [`Physics`], from the episode's seed. [`groups`]
//! declares the quantities of a world. A [`Start`] is a file of the same form: the distances of the parts
//! from their outlines on the sheet, and whether they trade places; or the region of the table in which they
//! lie anywhere.

#[macro_use]
mod quantity;
pub mod groups;
pub mod read;
pub mod start;
pub mod world;

pub use groups::Physics;
pub use quantity::{Field, Form, Quantity, Range, Spread};
pub use read::{WorldFault, WorldProblem};
pub use start::Start;
pub use world::World;
