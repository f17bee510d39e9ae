//! The work cell that all skills share: the believed assembly with the geometry derived from it, the hand,
//! the journal.

pub mod alignment;
pub mod assembly_belief;
pub mod diagnosis;
pub mod droop;
pub mod footprints;
pub mod journal;
pub mod pegs;
pub mod sheet_place;
pub mod target;
pub mod workcell;

pub use crate::insertion_path::InsertionPath;
pub use assembly_belief::{AssemblyBelief, Point};
pub use journal::{Journal, Stand};
pub use workcell::Workcell;
