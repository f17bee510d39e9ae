//! Tags in an image, by the reference detector of the AprilTag project.

use apriltag::{Detector, DetectorBuilder, Family, detector::QuadThresholds};
use measurements::Angle;
use noisy_float::types::r32;

use crate::image::{Grey, SightError};

/// A tag that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Detection {
    /// Its id.
    pub id: u32,
    /// Corners of its black square, pixels: upper left, upper right, lower right, lower left as it is
    /// printed.
    pub corners: [[f64; 2]; 4],
    /// Mean brightness difference between its white and black cells, levels of 255.
    pub margin: f64,
    /// Cells that were read wrongly and corrected.
    pub corrected: usize,
}

impl Detection {
    /// Its extent in the direction in which it is narrowest, pixels.
    pub fn width(&self) -> f64 {
        let side = |index: usize| {
            let ([ax, ay], [bx, by]) = (self.corners[index], self.corners[(index + 1) % 4]);
            [bx - ax, by - ay]
        };
        let cross = |a: [f64; 2], b: [f64; 2]| (a[0] * b[1] - a[1] * b[0]).abs();
        let area = 0.5 * (cross(side(0), side(1)) + cross(side(2), side(3)));
        let longest = (0..4).map(|index| side(index)[0].hypot(side(index)[1])).fold(0.0, f64::max);
        area / longest.max(1e-9)
    }

    /// Mean length of its edges, pixels.
    pub fn size(&self) -> f64 {
        let edge = |index: usize| {
            let ([ax, ay], [bx, by]) = (self.corners[index], self.corners[(index + 1) % 4]);
            (bx - ax).hypot(by - ay)
        };
        (0..4).map(edge).sum::<f64>() / 4.0
    }
}

/// Most cells that may have been read wrongly: of the family's 35 codes any two differ in nine.
const CORRECTED: usize = 2;
/// Least [`Detection::margin`].
const MARGIN: f64 = 12.0;

/// Least difference of light between black and white nearby, levels of 255: several times the noise, so that
/// plain surfaces are passed over.
const CONTRAST: u8 = 30;

/// Finds tags of the family tag25h9.
pub struct TagFinder {
    detector: Detector,
    image: Option<apriltag::Image>,
}

impl TagFinder {
    /// A finder that looks for candidates in an image made smaller by `decimate`; cells are read and edges
    /// measured in the full image whatever it is.
    ///
    /// # Errors
    /// When the detector does not start.
    pub fn new(decimate: f32) -> Result<TagFinder, SightError> {
        let mut detector = DetectorBuilder::new()
            .add_family_bits(Family::tag_25h9(), CORRECTED)
            .build()
            .map_err(|error| SightError::Detector(error.to_string()))?;
        detector.set_decimation(decimate);
        detector.set_thread_number(1);
        detector.set_refine_edges(true);
        // Its defaults, but for the contrast. The smallest angle at a corner is 10°, which it wants as a
        // cosine too.
        let least_angle = 10f64.to_radians();
        detector.set_thresholds(QuadThresholds {
            min_cluster_pixels: 5,
            max_maxima_number: 10,
            min_angle: Angle::from_radians(least_angle),
            min_opposite_angle: Angle::from_radians(least_angle.cos()),
            max_mse: r32(10.0),
            min_white_black_diff: CONTRAST,
            deglitch: false,
        });
        Ok(TagFinder { detector, image: None })
    }

    /// All tags, in the order of their ids and then from left to right.
    ///
    /// # Errors
    /// When memory for a copy of the image cannot be allocated.
    pub fn find(&mut self, grey: &Grey) -> Result<Vec<Detection>, SightError> {
        let fits = |image: &apriltag::Image| image.width() == grey.width && image.height() == grey.height;
        if !self.image.as_ref().is_some_and(fits) {
            let image = apriltag::Image::zeros_with_alignment(grey.width, grey.height, 96)
                .map_err(|error| SightError::Detector(error.to_string()))?;
            self.image = Some(image);
        }
        let Some(image) = &mut self.image else { return Ok(Vec::new()) };
        let stride = image.stride();
        for (row, pixels) in grey.pixels.chunks_exact(grey.width).enumerate() {
            image.as_slice_mut()[row * stride..][..grey.width].copy_from_slice(pixels);
        }
        let mut found: Vec<Detection> = self
            .detector
            .detect(image)
            .iter()
            .filter(|detection| f64::from(detection.decision_margin()) >= MARGIN)
            .map(|detection| {
                // From the lower left one on, anticlockwise.
                let [lower_left, lower_right, upper_right, upper_left] = detection.corners();
                Detection {
                    id: detection.id() as u32,
                    corners: [upper_left, upper_right, lower_right, lower_left],
                    margin: f64::from(detection.decision_margin()),
                    corrected: detection.hamming(),
                }
            })
            .collect();
        found.sort_by(|a, b| a.id.cmp(&b.id).then(a.corners[0][0].total_cmp(&b.corners[0][0])));
        Ok(found)
    }
}
