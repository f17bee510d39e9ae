//! Parts in an image: all tags of a part together, what is believed, and what was odd.
//!
//! `finder` takes an image apart, `part` finds one part of it, with what is known of it (`lying`) and the points of its
//! `tags`; `sighting` is what comes out.

mod finder;
mod lying;
mod part;
mod sighting;
mod tags;

pub use finder::PartFinder;
pub use lying::Lying;
pub use sighting::{Oddity, SHEET, SeenPart, Sighting};
pub use tags::corner_points;
