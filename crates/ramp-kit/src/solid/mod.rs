//! The parts as solids: the printed parts, and the bought parts for use in a CAD program.
//!
//! Millimetres throughout this module, as in the exported files. A joint's frame: origin on the
//! axis of its peg hole at the underside of its body, y along the beam (an end joint's extrusion
//! comes from −y), z up. A joint that is open to one side is open to −x at an end of a beam and to
//! +x in its middle.
//!
//! `body` makes and cuts solids; `joint`, `beam`, `peg` and `station` build the parts from them.

mod beam;
mod body;
mod joint;
mod peg;
mod station;

pub use beam::{Piece, beam, extrusion, profile};
pub use body::{Mesh, Solid, SolidError};
pub use joint::joint;
pub use peg::{holder, peg};
pub use station::{clamp, fingertip};
