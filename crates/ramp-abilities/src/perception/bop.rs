//! Images of parts without tags in the form of the BOP benchmark for poses of objects
//! (<https://bop.felk.cvut.cz>), so that its tools and detectors made for it can be used as they are.
//!
//! [`objects`] gives each shape of a part a number, its mesh and its symmetries; [`records`] writes down one
//! image; [`figures`] compares poses with the truth as BOP does. Lengths are millimetres there.

pub mod figures;
pub mod objects;
pub mod records;

pub use figures::{Pair, Tally};
pub use objects::{Object, Objects};
pub use records::{Instance, Record};
