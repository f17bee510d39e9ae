//! Properties proved about an assembly: the fit of the holes, gaps and overlaps of the beams, and
//! an order of straight insertions that builds it.
//!
//! `solids` compares beams in their goal poses, `order` searches an order of the insertions, and
//! `report` combines both.

mod order;
mod report;
mod set;
mod solids;

pub(crate) use order::find_order;
pub use report::{Fit, Report, report};
pub use set::MAX_BEAMS;
pub(crate) use solids::Solids;
pub use solids::{Gap, Overlap};
