//! Worlds: the physics of an episode, beside its parts and its goal.
//!
//! A world is a file: the friction of the arm's joints, its delays, its sensors and their errors, the
//! tolerances of the parts. [`World`] reads it: each number with its unit, its distribution and its source.
//! [`World::draw`] gives the numbers of one episode, a [`Physics`], from the episode's seed. [`groups`]
//! declares the quantities of a world.

#[macro_use]
mod quantity;
pub mod groups;
pub mod read;
pub mod world;

pub use groups::Physics;
pub use quantity::{Field, Form, Quantity, Spread};
pub use read::{WorldFault, WorldProblem};
pub use world::World;
