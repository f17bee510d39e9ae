//! Tags in an image, by the reference detector of the AprilTag project.

use apriltag::{Detector, DetectorBuilder, Family, detector::QuadThresholds};
use measurements::Angle;
use noisy_float::types::r32;

use crate::image::{Grey, SightError};
use crate::regions::{Region, regions};

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
    /// The mean of its corners, pixels.
    pub fn middle(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.corners.iter().map(|corner| corner[axis]).sum::<f64>() / 4.0)
    }

    /// The area of its black square, pixels.
    pub fn area(&self) -> f64 {
        let [[ax, ay], [bx, by], [cx, cy], [dx, dy]] = self.corners;
        0.5 * ((cx - ax) * (dy - by) - (dx - bx) * (cy - ay)).abs()
    }

    /// Its extent in the direction in which it is narrowest, pixels.
    pub fn width(&self) -> f64 {
        let side = |index: usize| {
            let ([ax, ay], [bx, by]) = (self.corners[index], self.corners[(index + 1) % 4]);
            [bx - ax, by - ay]
        };
        let longest = (0..4).map(|index| side(index)[0].hypot(side(index)[1])).fold(0.0, f64::max);
        self.area() / longest.max(1e-9)
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
}

impl TagFinder {
    /// A finder that measures in the full image.
    ///
    /// # Errors
    /// When the detector does not start.
    pub fn new() -> Result<TagFinder, SightError> {
        let mut detector = DetectorBuilder::new()
            .add_family_bits(Family::tag_25h9(), CORRECTED)
            .build()
            .map_err(|error| SightError::Detector(error.to_string()))?;
        detector.set_decimation(1.0);
        detector.set_thread_number(1);
        detector.set_refine_edges(true);
        // Its defaults, but for the contrast. The smallest angle at a corner is 10°, which it wants as a
        // cosine too.
        let least_angle = 10f64.to_radians();
        detector.set_thresholds(QuadThresholds {
            min_cluster_pixels: 70,
            max_maxima_number: 10,
            min_angle: Angle::from_radians(least_angle),
            min_opposite_angle: Angle::from_radians(least_angle.cos()),
            max_mse: r32(10.0),
            min_white_black_diff: CONTRAST,
            deglitch: false,
        });
        Ok(TagFinder { detector })
    }

    /// All tags, in the order of their ids and then from left to right. Only the [`regions()`] in which a tag
    /// can be are looked through.
    ///
    /// # Errors
    /// When memory for a copy of a region cannot be allocated.
    pub fn find(&mut self, grey: &Grey) -> Result<Vec<Detection>, SightError> {
        self.find_in(grey, &regions(grey, CONTRAST))
    }

    /// As [`TagFinder::find`], in these regions.
    ///
    /// # Errors
    /// When memory for a copy of a region cannot be allocated.
    pub fn find_in(&mut self, grey: &Grey, regions: &[Region]) -> Result<Vec<Detection>, SightError> {
        let mut found: Vec<Detection> = Vec::new();
        for region in regions {
            let image = copy(grey, region)?;
            for tag in self.read(&image, region) {
                // One tag may have two regions.
                let again =
                    |other: &Detection| other.id == tag.id && region.is_for(other.middle(), other.area());
                if !region.is_whole() && found.iter().any(again) {
                    continue;
                }
                found.push(tag);
            }
        }
        found.sort_by(|a, b| a.id.cmp(&b.id).then(a.corners[0][0].total_cmp(&b.corners[0][0])));
        Ok(found)
    }

    /// The tags that a region is for, in its copy.
    fn read(&mut self, image: &apriltag::Image, region: &Region) -> Vec<Detection> {
        let detections = self.detector.detect(image);
        let believed = detections.iter().filter(|detection| f64::from(detection.decision_margin()) >= MARGIN);
        let corner = |[x, y]: [f64; 2]| [x + region.left as f64, y + region.top as f64];
        let tag = |detection: &apriltag::Detection| {
            // From the lower left one on, anticlockwise.
            let [lower_left, lower_right, upper_right, upper_left] = detection.corners();
            Detection {
                id: detection.id() as u32,
                corners: [upper_left, upper_right, lower_right, lower_left].map(corner),
                margin: f64::from(detection.decision_margin()),
                corrected: detection.hamming(),
            }
        };
        believed.map(tag).filter(|tag| region.is_for(tag.middle(), tag.area())).collect()
    }
}

/// A region alone. Around it, it is as dark as in its darkest place: its white ends there, and its black
/// does not.
fn copy(grey: &Grey, region: &Region) -> Result<apriltag::Image, SightError> {
    let mut image = apriltag::Image::zeros_with_alignment(region.width, region.height, 96)
        .map_err(|error| SightError::Detector(error.to_string()))?;
    let stride = image.stride();
    let columns = |row: usize| &grey.pixels[row * grey.width..][region.columns(row)];
    let rows = region.top..region.top + region.height;
    let dark = rows.clone().filter_map(|row| columns(row).iter().min()).min().copied().unwrap_or_default();
    for (row, copy) in rows.zip(image.as_slice_mut().chunks_mut(stride)) {
        copy.fill(dark);
        let from = region.columns(row).start - region.left;
        copy[from..from + columns(row).len()].copy_from_slice(columns(row));
    }
    Ok(image)
}
