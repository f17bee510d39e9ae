//! Perception: from an image to where the parts are, with how sure that is.
//!
//! Data passes one way: [`image`] checks an image and turns it into linear light; [`detect`] finds tags in it
//! with the reference detector; [`edges`] measures the edges of their black squares to hundredths of a pixel;
//! [`fit`] moves a part until the edges of all its tags lie on those; [`find`] does this for every part in
//! view, rejects implausible poses, and reports unexpected findings. [`mod@calibrate`] estimates the true
//! pose of a camera from tags with known poses.
//!
//! ```no_run
//! # use ramp_robot::Robot;
//! # type Outcome = Result<(), Box<dyn std::error::Error>>;
//! # fn show(kit: &ramp_kit::Kit, robot: &mut dyn Robot) -> Outcome {
//! use ramp_robot::Camera;
//! use ramp_vision::{Lying, PartFinder};
//!
//! let mut finder = PartFinder::new(kit)?;
//! let image = robot.look(Camera::Wrist)?;
//! // Priors of the parts that lie at their places on the sheet, as long as nothing has touched them.
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

mod blobs;
pub mod calibrate;
pub mod detect;
pub mod edges;
pub mod find;
pub mod fit;
pub mod image;
pub mod regions;
pub mod untagged;

pub use calibrate::Calibration;
pub use find::{Lying, Oddity, PartFinder, SeenPart, Sighting};
pub use image::SightError;
