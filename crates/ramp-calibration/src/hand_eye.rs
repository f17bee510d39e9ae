//! Pose of the wrist camera in the tip frame, from images of the calibration sheet, which lies still, with
//! the pose of the tip at each.
//!
//! While the tip moves by A, the camera moves by B, and A X = X B for its pose X in the tip frame. Turns give
//! the rotation in closed form (Park and Martin 1994), then the translation follows linearly. From there X,
//! the pose of the sheet and, a little, the poses of the tip are adjusted until the tags would have been seen
//! where they were. Without corrections of the tip's poses, an arm's error in place would turn the camera.

use std::path::PathBuf;

use nalgebra::{DMatrix, DVector, Matrix3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::board;
use ramp_robot::{CameraModel, Pose};
use ramp_vision::detect::TagFinder;

use crate::adjust::{Adjusted, Model, adjust, moved, six};
use crate::error::CalibrationError;
use crate::jackknife::{kept, standard_error};
use crate::lens::{self, LEAST_TAGS};
use crate::records::read_image;
use crate::sights::{Seen, Sight};
use crate::start::plane_pose;
use crate::verdict::{Measure, Verdict};

/// Fewest images: five poses have ten motions between them, and leaving one out still has six.
pub const LEAST_IMAGES: usize = 5;
/// Least turn about a second axis, rad (root of the mean over all motions): about one axis alone, the
/// camera's place along it has no effect.
pub const LEAST_TURN: f64 = 0.10;
/// Usual error of the tip's poses, m and rad: what a Panda has after a calibration of its kinematics. Only
/// their ratio matters much.
pub const TIP: [f64; 2] = [0.2e-3, 0.2e-3];
/// Largest residual in the images of a good pose, pixels, as of a good lens.
pub const RESIDUAL: f64 = lens::RESIDUAL;
/// Largest correction of the tip's places (root of the mean square), mm: the error of a camera's place that
/// world `real` draws.
pub const CORRECTION_MM: f64 = 1.0;
/// Largest standard error of the camera's place, mm: that of world `real` in all three axes.
pub const PLACE_MM: f64 = 1.0;
/// Largest standard error of its direction, degrees: that of world `real`.
pub const ANGLE: f64 = 0.25;

/// A pose of the wrist camera that was estimated.
#[derive(Clone, Debug)]
pub struct HandEye {
    /// Pose of the optical frame C in the tip frame T.
    pub x_tc: Pose,
    /// Pose of the sheet in the robot's base frame W.
    pub x_wk: Pose,
    /// Root of the mean of the squares of the residuals, pixels.
    pub residual: f64,
    /// Corrections of the tip's poses, root of the mean square, m and rad.
    pub corrections: [f64; 2],
    /// Standard errors of place, m, and direction, rad.
    pub errors: [f64; 2],
    /// Number of images that show enough of the sheet.
    pub images: usize,
    /// Images that do not.
    pub left_out: Vec<PathBuf>,
}

impl HandEye {
    /// Is it good enough?
    pub fn verdict(&self) -> Verdict {
        let measure = |name, value, limit, unit| Measure { name, value, limit, unit };
        let [place, angle] = self.errors;
        Verdict {
            measures: vec![
                measure("residual", self.residual, RESIDUAL, "pixels"),
                measure("correction of the tip's places", self.corrections[0] * 1e3, CORRECTION_MM, "mm"),
                measure("correction of its directions", self.corrections[1].to_degrees(), ANGLE, "°"),
                measure("standard error of the place", place * 1e3, PLACE_MM, "mm"),
                measure("standard error of the direction", angle.to_degrees(), ANGLE, "°"),
            ],
        }
    }
}

/// Camera and sheet as unknowns, about a first estimate.
struct Unknowns {
    lens: CameraModel,
    x_tc: Pose,
    x_wk: Pose,
    tips: Vec<Pose>,
}

/// Unknowns of camera and sheet; those of the tip follow, six for each image.
const OF_BOTH: usize = 12;

impl Model for Unknowns {
    fn see(&self, unknowns: &DVector<f64>, image: usize) -> (CameraModel, Pose) {
        let (x_tc, x_wk) = (moved(&self.x_tc, six(unknowns, 0)), moved(&self.x_wk, six(unknowns, 6)));
        let x_wt = moved(&self.tips[image], six(unknowns, OF_BOTH + 6 * image));
        (self.lens.clone(), (x_wt * x_tc).inverse() * x_wk)
    }

    fn depends(&self, image: usize) -> Vec<usize> {
        (0..OF_BOTH).chain(OF_BOTH + 6 * image..OF_BOTH + 6 * image + 6).collect()
    }

    fn priors(&self) -> Vec<(usize, f64)> {
        (0..6 * self.tips.len()).map(|index| (OF_BOTH + index, TIP[usize::from(index % 6 >= 3)])).collect()
    }
}

/// Estimates the pose of the wrist camera. `lens` is the camera's lens, whose mounting has no meaning, and
/// `images` are files with the pose of the tip in the robot's base frame at each.
///
/// # Errors
/// Images that cannot be read or are not of the lens's size, fewer than [`LEAST_IMAGES`] that show enough of
/// the sheet, or turns about one axis only.
pub fn calibrate(lens: &CameraModel, images: &[(PathBuf, Pose)]) -> Result<HandEye, CalibrationError> {
    let (seen, tips, left_out) = see_all(lens, images)?;
    let help = "move the arm to ten or more poses around the sheet, turned about all three axes";
    if seen.len() < LEAST_IMAGES {
        let what = "images that show enough of the calibration sheet";
        return Err(CalibrationError::TooFew { what, found: seen.len(), least: LEAST_IMAGES, help });
    }
    let boards: Vec<Pose> = seen.iter().filter_map(|seen| plane_pose(lens, seen.tags())).collect();
    let not_found = || CalibrationError::Degenerate {
        why: "no pose of the camera explains these images".to_string(),
        help: "check that each row of poses.csv belongs to its image, and that the sheet lay still",
    };
    if boards.len() < seen.len() {
        return Err(not_found());
    }
    let second = second_turn(&tips);
    if second < LEAST_TURN {
        let why = format!(
            "the arm turned about one axis only: {:.1}° about a second one, expected {:.1}° or more",
            second.to_degrees(),
            LEAST_TURN.to_degrees()
        );
        return Err(CalibrationError::Degenerate { why, help });
    }
    let x_tc = closed_form(&tips, &boards).ok_or_else(not_found)?;
    let x_wk = tips[0] * x_tc * boards[0];
    let first = Unknowns { lens: lens.clone(), x_tc, x_wk, tips };
    let corners: Vec<Vec<Sight>> = seen.iter().map(Seen::corners).collect();
    let (first, _) = solve(&first, &corners).ok_or_else(not_found)?;
    // Edges are measured where the sheet is seen, which the arm's own errors do not move.
    let sights: Vec<Vec<Sight>> =
        seen.iter().zip(&boards).map(|(seen, x_ck)| seen.edges(lens, x_ck)).collect();
    let (found, adjusted) = solve(&first, &sights).ok_or_else(not_found)?;
    let errors = spread(&found, &sights).ok_or_else(not_found)?;
    let mean = |from: usize| {
        let changes = (0..seen.len()).map(|image| six(&adjusted.unknowns, OF_BOTH + 6 * image));
        let squares: f64 =
            changes.flat_map(|six| [six[from], six[from + 1], six[from + 2]]).map(|it| it * it).sum();
        (squares / seen.len() as f64).sqrt()
    };
    Ok(HandEye {
        x_tc: found.x_tc,
        x_wk: found.x_wk,
        residual: adjusted.residual,
        corrections: [mean(0), mean(3)],
        errors,
        images: seen.len(),
        left_out,
    })
}

/// The sheet in each image that shows enough of it, with the pose of the tip, and the other images.
#[allow(clippy::type_complexity)]
fn see_all(
    lens: &CameraModel,
    images: &[(PathBuf, Pose)],
) -> Result<(Vec<Seen>, Vec<Pose>, Vec<PathBuf>), CalibrationError> {
    let mut finder = TagFinder::new().map_err(CalibrationError::Detector)?;
    let places = board::places();
    let (mut all, mut tips, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
    for (path, x_wt) in images {
        let image = read_image(path)?;
        let file = || path.display().to_string();
        check_size(lens, &image, path)?;
        let seen = Seen::find(&mut finder, &image, &places)
            .map_err(|why| CalibrationError::Sight { file: file(), why })?;
        if seen.tags().len() < LEAST_TAGS {
            left_out.push(path.clone());
        } else {
            all.push(seen);
            tips.push(*x_wt);
        }
    }
    Ok((all, tips, left_out))
}

/// Checks that an image is of the size for which the lens was calibrated.
pub(crate) fn check_size(
    lens: &CameraModel,
    image: &ramp_robot::Image,
    path: &std::path::Path,
) -> Result<(), CalibrationError> {
    if [image.width, image.height] == [lens.width, lens.height] {
        return Ok(());
    }
    let why = format!(
        "is {} × {} pixels; the lens was calibrated with {} × {}",
        image.width, image.height, lens.width, lens.height
    );
    Err(CalibrationError::Image { file: path.display().to_string(), why })
}

/// Motions between all pairs of poses.
fn motions<'a>(poses: &'a [Pose]) -> impl Iterator<Item = (usize, usize, Pose)> + 'a {
    (0..poses.len()).flat_map(move |from| {
        (from + 1..poses.len()).map(move |to| (from, to, poses[from].inverse() * poses[to]))
    })
}

/// The turn about the second of the three principal axes of all motions, rad: root of the mean of the
/// squares.
fn second_turn(tips: &[Pose]) -> f64 {
    let mut sum = Matrix3::zeros();
    let mut count = 0.0;
    for (_, _, motion) in motions(tips) {
        let turn = motion.rotation.scaled_axis();
        sum += turn * turn.transpose();
        count += 1.0;
    }
    let mut squares: Vec<f64> = (sum / count).symmetric_eigenvalues().iter().copied().collect();
    squares.sort_by(f64::total_cmp);
    squares[1].max(0.0).sqrt()
}

/// The camera's pose in the tip frame from poses of the tip in the base frame and of the sheet in the optical
/// frame.
pub fn closed_form(tips: &[Pose], boards: &[Pose]) -> Option<Pose> {
    // A X = X B, of which the turn axes are a = R b.
    let mut sum = Matrix3::zeros();
    let mut pairs = Vec::new();
    for (from, to, a) in motions(tips) {
        let b = boards[from] * boards[to].inverse();
        sum += a.rotation.scaled_axis() * b.rotation.scaled_axis().transpose();
        pairs.push((a, b));
    }
    let svd = sum.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    let sign = (u * v_t).determinant().signum();
    let rotation = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * v_t;
    // (R_A - 1) t = R t_B - t_A.
    let mut matrix = DMatrix::zeros(3 * pairs.len(), 3);
    let mut vector = DVector::zeros(3 * pairs.len());
    for (index, (a, b)) in pairs.iter().enumerate() {
        let turn = a.rotation.to_rotation_matrix().into_inner() - Matrix3::identity();
        matrix.fixed_view_mut::<3, 3>(3 * index, 0).copy_from(&turn);
        let right = rotation * b.translation.vector - a.translation.vector;
        vector.fixed_rows_mut::<3>(3 * index).copy_from(&right);
    }
    let t = (matrix.transpose() * &matrix).cholesky()?.solve(&(matrix.transpose() * vector));
    let translation = Translation3::new(t[0], t[1], t[2]);
    Some(Pose::from_parts(translation, UnitQuaternion::from_matrix(&rotation)))
}

fn solve(unknowns: &Unknowns, sights: &[Vec<Sight>]) -> Option<(Unknowns, Adjusted)> {
    let images: Vec<&[Sight]> = sights.iter().map(Vec::as_slice).collect();
    let adjusted = adjust(unknowns, &images, DVector::zeros(OF_BOTH + 6 * images.len()))?;
    let x_tc = moved(&unknowns.x_tc, six(&adjusted.unknowns, 0));
    let x_wk = moved(&unknowns.x_wk, six(&adjusted.unknowns, 6));
    let found = Unknowns { lens: unknowns.lens.clone(), x_tc, x_wk, tips: unknowns.tips.clone() };
    Some((found, adjusted))
}

/// Standard errors of the camera's place, m, and direction, rad, by leaving out one image after another: the
/// arm's errors are common to all tags of an image.
fn spread(unknowns: &Unknowns, sights: &[Vec<Sight>]) -> Option<[f64; 2]> {
    let (mut places, mut angles) = (Vec::new(), Vec::new());
    for kept in kept(sights.len()) {
        let sights: Vec<Vec<Sight>> = kept.iter().map(|&image| sights[image].clone()).collect();
        let tips = kept.iter().map(|&image| unknowns.tips[image]).collect();
        let (lens, x_tc, x_wk) = (unknowns.lens.clone(), unknowns.x_tc, unknowns.x_wk);
        let (other, _) = solve(&Unknowns { lens, x_tc, x_wk, tips }, &sights)?;
        places.push((other.x_tc.translation.vector - x_tc.translation.vector).norm_squared());
        angles.push(other.x_tc.rotation.angle_to(&x_tc.rotation).powi(2));
    }
    Some([standard_error(&places), standard_error(&angles)])
}
