//! The work cell: what all skills share, and what follows from it by geometry alone.

pub mod alignment;
pub mod diagnosis;
pub mod droop;
pub mod pegs;
pub mod target;
pub mod workcell;

pub use crate::insertion_path::InsertionPath;
pub use workcell::{Point, Stand, Workcell};
