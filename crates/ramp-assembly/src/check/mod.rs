//! What can be proved about an assembly: how well the holes meet, where the beams are closest or overlap, and an
//! order of straight insertions that builds it.
//!
//! `solids` compares beams at their places; `order` searches the order of the insertions; `report` says both.

mod order;
mod report;
mod set;
mod solids;

pub(crate) use order::find_order;
pub use report::{Fit, Report, report};
pub use set::MAX_BEAMS;
pub(crate) use solids::Solids;
pub use solids::{Gap, Overlap};
