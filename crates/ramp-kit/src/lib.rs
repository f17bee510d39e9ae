//! The base parts (section III-A of the paper): beams, pegs, holders and the sheet, read from one
//! file that people may edit.
//!
//! Data passes one way: [`read`] turns `data/kit.xml` into a [`Kit`]; [`dimensions`] and [`joint`]
//! hold the measures of its printed parts; [`shape`] turns a [`Beam`] or a peg into boxes, plates
//! and noses. The twin takes its collision geometry from them, `ramp check` its overlaps and the
//! planner its clearances.
//!
//! With the feature `export`, [`export()`](export::export) writes all files for making the parts:
//! [`solid`] as STL ([`stl`]) and 3MF ([`threemf`]), [`sheet`], [`guide`], tag sheets and the
//! calibration sheet ([`board`]) as drawings ([`mod@drawing`]) in SVG and PDF, and the [`bill`] of parts.
//!
//! [`source`] is the crate [`ramp_source`], which points errors at their place in a file.
//!
//! Lengths are metres in the structs and millimetres in the file, as everywhere in the project.

pub mod beam;
#[cfg(feature = "export")]
pub mod bill;
pub mod board;
mod cuboid;
pub mod dimensions;
#[cfg(feature = "export")]
pub mod drawing;
#[cfg(feature = "export")]
pub mod export;
pub mod footprint;
#[cfg(feature = "export")]
pub mod guide;
pub mod joint;
pub mod lookalike;
mod pose;
pub mod read;
pub mod shape;
#[cfg(feature = "export")]
pub mod sheet;
#[cfg(feature = "export")]
pub mod solid;
#[cfg(feature = "export")]
pub mod stl;
pub mod strokes;
pub mod tags;
#[cfg(feature = "export")]
pub mod threemf;
#[cfg(feature = "export")]
pub mod tiles;
#[cfg(feature = "export")]
mod view;
pub mod write;

pub use beam::{Beam, Holder, Joint, Kit, Link, Peg, Sheet, StartPose};
pub use dimensions::Dimensions;
pub use footprint::Footprint;
pub use joint::{JointForm, JointType, Side};
pub use pose::Pose;
pub use ramp_source as source;
pub use read::{KitError, KitProblem, read_kit, read_kit_str};
pub use write::kit_xml;
