//! Measurements of a target's tags in an image.
//!
//! A target is a set of tags with known places in one frame B: the calibration sheet, or the start sheet with
//! the clamped beam.

use nalgebra::Point3;
use ramp_kit::tags::TagPlace;
use ramp_robot::camera::Mount;
use ramp_robot::{CameraModel, Image, Pose};
use ramp_vision::detect::{Detection, TagFinder};
use ramp_vision::edges;
use ramp_vision::find::corner_points;
use ramp_vision::fit::{CORNER_ERROR, EDGE_ERROR};
use ramp_vision::image::{Grey, SightError};

/// Narrowest tag whose edges are measured, pixels: cells of smaller ones blur into each other. As in
/// perception.
const EDGES_FROM: f64 = 14.0;
/// Least share of the places on the edges of a tag that must be measurable.
const MEASURED: f64 = 0.5;
/// Narrowest tag that is used, pixels.
const SMALLEST: f64 = 8.0;

/// A known point that was seen on a line of the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// The point in the target's frame, m.
    pub p_b: Point3<f64>,
    /// Direction in the image in which its place was measured, of length 1.
    pub normal: [f64; 2],
    /// Measured `normal · pixel`, pixels.
    pub along: f64,
    /// Usual error, pixels.
    pub sigma: f64,
}

/// The tags of a target that an image shows.
pub struct Seen {
    grey: Grey,
    tags: Vec<(TagPlace, Detection)>,
}

/// A camera without a pose or distortion that has images of this size.
pub(crate) fn bare(width: usize, height: usize, focal: f64) -> CameraModel {
    CameraModel {
        width,
        height,
        focal: [focal; 2],
        centre: [width as f64 / 2.0, height as f64 / 2.0],
        distortion: [0.0; 5],
        mount: Mount::World(Pose::identity()),
    }
}

impl Seen {
    /// Finds the tags of a target. An id that is in the image twice is left out.
    ///
    /// # Errors
    /// An image that is black or saturated.
    pub fn find(finder: &mut TagFinder, image: &Image, places: &[TagPlace]) -> Result<Seen, SightError> {
        let grey = Grey::new(image, &bare(image.width, image.height, 1.0))?;
        let found = finder.find(&grey)?;
        let count = |id: u32| found.iter().filter(|detection| detection.id == id).count();
        let place = |id: u32| places.iter().find(|place| place.id == id);
        let tags = found
            .iter()
            .filter(|detection| count(detection.id) == 1 && detection.width() >= SMALLEST)
            .filter_map(|detection| Some((place(detection.id)?.clone(), detection.clone())))
            .collect();
        Ok(Seen { grey, tags })
    }

    /// The tags: their places on the target, and where they are in the image.
    pub fn tags(&self) -> &[(TagPlace, Detection)] {
        &self.tags
    }

    /// The corners, with what perception knows of their errors.
    pub fn corners(&self) -> Vec<Sight> {
        self.tags.iter().flat_map(|(place, detection)| corner_sights(place, detection)).collect()
    }

    /// The edges of tags that are large enough, and the corners of the others. `x_cb` is the pose of the
    /// target in the optical frame, which with `camera` must be right to a pixel or two.
    pub fn edges(&self, camera: &CameraModel, x_cb: &Pose) -> Vec<Sight> {
        let mut sights = Vec::new();
        for (place, detection) in &self.tags {
            if detection.width() < EDGES_FROM {
                sights.extend(corner_sights(place, detection));
                continue;
            }
            let mut places = Vec::new();
            edges::measure(&self.grey, camera, place, x_cb, 0, &mut places);
            // Fewer places belong to a tag that is partly hidden.
            if places.len() as f64 >= MEASURED * edges::COUNT as f64 {
                sights.extend(places.iter().map(|place| Sight {
                    p_b: place.p_p,
                    normal: place.normal,
                    along: place.along,
                    sigma: EDGE_ERROR,
                }));
            }
        }
        sights
    }
}

fn corner_sights(place: &TagPlace, detection: &Detection) -> impl Iterator<Item = Sight> {
    let corners = corner_points(place).into_iter().zip(detection.corners);
    corners.flat_map(|(p_b, pixel)| {
        [0, 1].map(|axis| {
            let mut normal = [0.0; 2];
            normal[axis] = 1.0;
            Sight { p_b, normal, along: pixel[axis], sigma: CORNER_ERROR }
        })
    })
}
