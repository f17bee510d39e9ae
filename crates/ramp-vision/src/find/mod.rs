//! Parts in an image: detection from all tags of a part together, and unexpected findings.
//!
//! `finder` groups the tags of an image by part, `part` estimates the pose of one part from its prior
//! (`lying`) and the points of its `tags`, and `sighting` is the result.

mod finder;
mod lying;
mod part;
mod sighting;
mod tags;

pub use finder::PartFinder;
pub use lying::Lying;
pub use sighting::{Oddity, SHEET, SeenPart, Sighting};
pub use tags::corner_points;
