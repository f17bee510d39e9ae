//! Calibration of a real cell from recordings: the cameras' lenses and poses, the table, the joints'
//! friction.
//!
//! Data passes one way. [`records`] reads images and tables of numbers from files. [`sights`] measures the
//! tags of a known target in an image; [`start`] makes a first estimate from a few of them, and [`adjust`]
//! moves all unknowns until the target would have been seen so. [`lens`], [`hand_eye`] and [`birds_eye`] do
//! this for the cameras, [`table`] and [`friction`] fit touched points and torques. Each returns its estimate
//! with a residual, standard errors and a [`Verdict`]; [`mod@file`] holds the estimates that passed.

pub mod adjust;
pub mod birds_eye;
mod error;
pub mod file;
pub mod friction;
pub mod hand_eye;
mod jackknife;
pub mod lens;
pub mod records;
pub mod sights;
pub mod start;
pub mod table;
mod verdict;

pub use error::CalibrationError;
pub use file::Calibration;
pub use verdict::{Measure, Verdict};
