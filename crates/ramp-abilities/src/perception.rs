//! Images with labels for perception research, and a judge of any detector on them.
//!
//! A view is an image of the start layout or of the built goal from a place drawn from the seed, through a
//! camera with its own error of calibration. Labels say where each part is in the camera's optical frame C,
//! so that errors are those of perception alone. [`bop`] has the same of parts without tags.

pub mod bop;
pub mod coco;
pub mod judge;
pub mod labels;
pub mod photograph;

pub use coco::{Area, areas, coco};
pub use judge::{Line, Verdict, judge};
pub use labels::{Estimate, Labels, PartLabel, PoseLabel, SCHEMA, TagLabel, ViewLabel};
pub use photograph::{Photographer, View};
