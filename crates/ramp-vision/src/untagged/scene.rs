//! What goes into a look and what comes out of it: the scene as it is believed, and the parts that were
//! found.

use std::collections::BTreeMap;

use nalgebra::{Matrix6, Point3};
use ramp_kit::Sheet;
use ramp_robot::Pose;

use super::solids::Surface;
use crate::find::Lying;

/// Everything that can be drawn.
#[derive(Clone, Debug)]
pub struct Bodies {
    /// Surfaces by name.
    pub surfaces: BTreeMap<String, Surface>,
    /// The sheet on the table.
    pub sheet: Sheet,
    /// Distance along z from the hand's frame to the tip, m.
    pub tip: f64,
    /// Distance along z from the hand's frame to those of the fingers, m.
    pub finger: f64,
}

/// A part as it is believed to be.
#[derive(Clone, Debug)]
pub struct Believed {
    /// Its name.
    pub part: String,
    /// Its pose in the world at the time of the image.
    pub x_wp: Pose,
    /// Covariance of a shift (m) and turn (rad) about its origin, axes of the world.
    pub covariance: Matrix6<f64>,
    /// The knowledge of its height and tilt, if there is any.
    pub lying: Option<Lying>,
    /// True if it is between the fingers.
    pub held: bool,
}

/// Everything that may be in an image.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// The parts.
    pub parts: &'a [Believed],
    /// Poses of the holders in the world, by name.
    pub holders: &'a [(String, Pose)],
    /// Distance between the fingers, m.
    pub width: f64,
}

/// The content of an image.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// The parts that were found.
    pub found: Vec<Found>,
    /// Parts that are not where they are believed to be: depth shows what is behind them, or hardly any of
    /// their steps are in an image from near without depth.
    pub absent: Vec<String>,
}

/// A part that was found.
#[derive(Clone, Debug)]
pub struct Found {
    /// Its name.
    pub part: String,
    /// Its pose in the world, as far as the camera is where it is said to be.
    pub x_wp: Pose,
    /// Covariance of a shift (m) and turn (rad) about its origin, axes of the world, without the error of the
    /// camera's place.
    pub covariance: Matrix6<f64>,
    /// Some points of it that show, in its frame, m.
    pub points: Vec<Point3<f64>>,
    /// Share of the drawn steps that support the pose.
    pub share: f64,
    /// Number of steps that support it.
    pub agreeing: usize,
    /// Root of the mean square of how far off those are, pixels.
    pub pixels: f64,
}
