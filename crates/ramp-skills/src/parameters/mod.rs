//! The parameters of the skills: meaning, unit and limits of each. Their values are in one file.

#[macro_use]
pub mod group;
pub mod all;
pub mod belief;
pub mod contact;
pub mod hand;
pub mod insertions;
pub mod motion;
pub mod read;
pub mod skills;

pub use all::Parameters;
pub use group::{Field, Group};
pub use read::{ParameterFault, ParameterProblem};
