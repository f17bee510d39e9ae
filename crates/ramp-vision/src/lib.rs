//! Perception: from an image to where the parts are, with how sure that is.
//!
//! Data passes one way: [`image`] checks an image and turns it into linear light; [`detect`] finds tags in it with the
//! reference detector; [`edges`] measures the edges of their black squares to hundredths of a pixel; [`fit`] moves a
//! part until the edges of all its tags lie on those; [`find`] does this for every part in view, decides what it
//! believes, and says what was odd. [`mod@calibrate`] finds out where a camera really is from tags whose places are
//! known.
//!
//! ```no_run
//! # fn show(kit: &ramp_kit::Kit, robot: &mut dyn ramp_robot::Robot) -> Result<(), Box<dyn std::error::Error>> {
//! use ramp_robot::Camera;
//! use ramp_vision::{Lying, PartFinder};
//!
//! let mut finder = PartFinder::new(kit)?;
//! let image = robot.look(Camera::Wrist)?;
//! // What is known to lie as the sheet has it: only while nothing has touched it.
//! let lying = Lying::at_start(kit);
//! let sighting = finder.find(&image, &robot.camera(Camera::Wrist), &lying)?;
//! for part in &sighting.parts {
//!     println!("{} at {}, from tags {:?}", part.part, part.x_wp, part.tags);
//! }
//! for oddity in &sighting.oddities {
//!     println!("{oddity}");
//! }
//! # Ok(())
//! # }
//! ```

pub mod calibrate;
pub mod detect;
pub mod edges;
pub mod find;
pub mod fit;
pub mod image;

pub use calibrate::Calibration;
pub use find::{Lying, Oddity, PartFinder, SeenPart, Sighting};
pub use image::SightError;
