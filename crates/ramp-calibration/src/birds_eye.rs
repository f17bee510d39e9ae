//! Pose of the overhead camera in the robot's base frame, from the tags of the start sheet and of the clamped
//! beam, whose places there are known.

use std::path::PathBuf;

use nalgebra::{DVector, Matrix2x6, Matrix6, Point3};
use ramp_kit::Kit;
use ramp_kit::tags::{self, TagPlace};
use ramp_robot::{CameraModel, Pose};
use ramp_vision::detect::TagFinder;
use ramp_vision::fit::candidates;

use crate::adjust::{Model, adjust, moved, six};
use crate::error::CalibrationError;
use crate::hand_eye::check_size;
use crate::records::read_image;
use crate::sights::{Seen, Sight};
use crate::verdict::{Measure, Verdict};

/// Fewest different tags: the tilt of a single small one is uncertain.
pub const LEAST_TAGS: usize = 2;
/// Largest residual of a good pose, pixels: 0.8 mm on the table from the nominal place of the camera, about
/// as well as a sheet is laid by hand.
pub const RESIDUAL: f64 = 0.5;
/// Largest standard error of the place at which a part on the sheet is seen, mm: the largest that perception
/// accepts of a part that lies there.
pub const PLACE_MM: f64 = 1.8;
/// Measurements next to each other on a tag have errors in common: this many count as one. As in perception.
const COMMON: f64 = 4.0;
/// Residuals, in units of the usual one, are taken to be at least this large. As in perception.
const LEAST_RESIDUAL: f64 = 0.56;

/// A pose of the overhead camera that was estimated.
#[derive(Clone, Debug)]
pub struct BirdsEye {
    /// Pose of the optical frame C in the robot's base frame W.
    pub x_wc: Pose,
    /// Root of the mean of the squares of the residuals, pixels.
    pub residual: f64,
    /// Standard error of the place at which a part is seen, at the least certain corner of the sheet, m.
    pub place: f64,
    /// Number of images.
    pub images: usize,
    /// The tags that were seen.
    pub tags: Vec<u32>,
}

impl BirdsEye {
    /// Is it good enough?
    pub fn verdict(&self) -> Verdict {
        let measure = |name, value, limit, unit| Measure { name, value, limit, unit };
        Verdict {
            measures: vec![
                measure("residual", self.residual, RESIDUAL, "pixels"),
                measure("standard error of a place on the sheet", self.place * 1e3, PLACE_MM, "mm"),
            ],
        }
    }
}

/// The tags with known places in the robot's base frame: the sheet's own, and those of the clamped beam.
pub fn places(kit: &Kit) -> Vec<TagPlace> {
    let sheet = TagPlace {
        id: tags::SHEET_ID,
        part: "sheet".to_string(),
        x_pg: tags::x_wg_sheet(kit),
        edge: kit.sheet.tag_edge,
    };
    let clamped = kit.beams.iter().filter(|beam| beam.start.is_none());
    let on_beams = clamped.flat_map(|beam| {
        let x_wb = kit.x_wa() * Pose::translation(0.0, 0.0, beam.axis_height_on_table());
        let own = tags::places(kit).into_iter().filter(|place| place.part == beam.name);
        own.map(move |place| TagPlace { x_pg: x_wb * place.x_pg, ..place }).collect::<Vec<_>>()
    });
    std::iter::once(sheet).chain(on_beams).collect()
}

/// The corners of the start sheet in the robot's base frame, m.
pub fn sheet_corners(kit: &Kit) -> [[f64; 2]; 4] {
    let [width, height] = kit.sheet.size;
    [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]].map(|at| {
        let corner = kit.sheet_to_world(at);
        [corner.x, corner.y]
    })
}

/// The world in the optical frame as unknowns, about a first estimate.
struct Unknowns<'a> {
    lens: &'a CameraModel,
    x_cw: Pose,
}

impl Model for Unknowns<'_> {
    fn see(&self, unknowns: &DVector<f64>, _image: usize) -> (CameraModel, Pose) {
        (self.lens.clone(), moved(&self.x_cw, six(unknowns, 0)))
    }

    fn depends(&self, _image: usize) -> Vec<usize> {
        (0..6).collect()
    }
}

/// Estimates the pose of the overhead camera. `lens` is its lens, whose mounting has no meaning; the camera
/// stood still for all images.
///
/// # Errors
/// Images that cannot be read or are not of the lens's size, or fewer than [`LEAST_TAGS`] different tags.
pub fn calibrate(lens: &CameraModel, kit: &Kit, paths: &[PathBuf]) -> Result<BirdsEye, CalibrationError> {
    let help =
        "lay the start sheet at its place, clamp the beam, and keep both in view, in focus and well lit";
    if paths.is_empty() {
        return Err(CalibrationError::TooFew { what: "images", found: 0, least: 1, help });
    }
    let mut finder = TagFinder::new().map_err(CalibrationError::Detector)?;
    let places = places(kit);
    let mut all = Vec::new();
    for path in paths {
        let image = read_image(path)?;
        check_size(lens, &image, path)?;
        let seen = Seen::find(&mut finder, &image, &places)
            .map_err(|why| CalibrationError::Sight { file: path.display().to_string(), why })?;
        all.push(seen);
    }
    let mut ids: Vec<u32> = all.iter().flat_map(Seen::tags).map(|(place, _)| place.id).collect();
    ids.sort_unstable();
    ids.dedup();
    if ids.len() < LEAST_TAGS {
        let what = "tags of the start sheet and the clamped beam";
        return Err(CalibrationError::TooFew { what, found: ids.len(), least: LEAST_TAGS, help });
    }
    let not_found = || CalibrationError::Degenerate {
        why: "no pose of the camera explains these images".to_string(),
        help,
    };
    let solve = |x_cw: &Pose, sights: &[Vec<Sight>]| {
        let images: Vec<&[Sight]> = sights.iter().map(Vec::as_slice).collect();
        let adjusted = adjust(&Unknowns { lens, x_cw: *x_cw }, &images, DVector::zeros(6))?;
        Some((moved(x_cw, six(&adjusted.unknowns, 0)), adjusted))
    };
    let corners: Vec<Vec<Sight>> = all.iter().map(Seen::corners).collect();
    // A tag alone has two poses: that which suits all tags is right.
    let starts = all.iter().flat_map(Seen::tags);
    let starts = starts.filter_map(|(place, seen)| candidates(lens, place, &seen.corners)).flatten();
    let first = starts.filter_map(|x_cw| solve(&x_cw, &corners));
    let first = first.min_by(|(_, a), (_, b)| a.residual.total_cmp(&b.residual));
    let (x_cw, _) = first.ok_or_else(not_found)?;
    let sights: Vec<Vec<Sight>> = all.iter().map(|seen| seen.edges(lens, &x_cw)).collect();
    let (x_cw, adjusted) = solve(&x_cw, &sights).ok_or_else(not_found)?;
    let information = Matrix6::from_iterator(adjusted.information.iter().copied());
    let scale = COMMON * adjusted.normalised.max(LEAST_RESIDUAL).powi(2);
    let covariance = information.try_inverse().ok_or_else(not_found)? * scale;
    let variance = |[x, y]: [f64; 2]| {
        // Across the line of sight, to which the optical axis is close: its height is known of a part.
        let arm = x_cw.rotation * Point3::new(x, y, 0.0).coords;
        let turn = -arm.cross_matrix();
        let mut motion = Matrix2x6::zeros();
        motion.fixed_view_mut::<2, 2>(0, 0).fill_with_identity();
        motion.fixed_view_mut::<2, 3>(0, 3).copy_from(&turn.fixed_rows::<2>(0));
        (motion * covariance * motion.transpose()).trace()
    };
    let place = sheet_corners(kit).map(variance).into_iter().fold(0.0, f64::max).sqrt();
    let residual = adjusted.residual;
    Ok(BirdsEye { x_wc: x_cw.inverse(), residual, place, images: all.len(), tags: ids })
}
