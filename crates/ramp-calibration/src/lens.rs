//! A camera's lens from images of the calibration sheet: focal lengths, principal point, distortion.

use std::path::PathBuf;

use nalgebra::{DVector, Matrix3, Point3};
use ramp_kit::board;
use ramp_robot::{CameraModel, Pose};
use ramp_vision::detect::TagFinder;

use crate::adjust::{Adjusted, Model, adjust, moved, six};
use crate::error::CalibrationError;
use crate::jackknife::{kept, standard_error};
use crate::records::read_image;
use crate::sights::{Seen, Sight, bare};
use crate::start::{focal_length, homography, plane_points, plane_pose};
use crate::verdict::{Measure, Verdict};

/// Fewest images. Nine unknowns of the lens and six of each image: with six images of 35 tags there are
/// hundreds of measurements for each unknown, and leaving one out changes little.
pub const LEAST_IMAGES: usize = 6;
/// Fewest tags in an image that is used.
pub const LEAST_TAGS: usize = 6;
/// Least angle between the two most different directions from which the sheet is seen, rad: focal length and
/// distance cannot be distinguished in images from one direction.
pub const LEAST_ANGLE: f64 = 0.35;
/// Largest residual of a good lens, pixels: half of what perception believes of a part's edges.
pub const RESIDUAL: f64 = 0.17;
/// Largest standard error of the place of a pixel of a good lens, pixels: 0.2 mm at 0.25 m from the wrist
/// camera, a fifth of what world `real` draws as error of a camera's pose.
pub const PLACE: f64 = 0.5;
/// Unknowns of the lens.
const OF_LENS: usize = 9;
/// Rows and columns of the pixels at which lenses are compared.
const GRID: usize = 5;

/// A lens that was estimated.
#[derive(Clone, Debug)]
pub struct Lens {
    /// The camera model; its mounting has no meaning.
    pub model: CameraModel,
    /// Root of the mean of the squares of the residuals, pixels.
    pub residual: f64,
    /// Standard error of the place of a pixel, the largest in the image, pixels.
    pub place: f64,
    /// Standard errors of focal lengths and principal point, pixels.
    pub errors: [f64; 4],
    /// Number of images that show enough of the sheet.
    pub images: usize,
    /// Images that do not.
    pub left_out: Vec<PathBuf>,
    /// Angle between the two most different directions from which the sheet is seen, rad.
    pub angle: f64,
}

impl Lens {
    /// Is it good enough?
    pub fn verdict(&self) -> Verdict {
        let measure = |name, value, limit| Measure { name, value, limit, unit: "pixels" };
        Verdict {
            measures: vec![
                measure("residual", self.residual, RESIDUAL),
                measure("standard error of a pixel's place", self.place, PLACE),
            ],
        }
    }
}

/// Lens and poses of the sheet as unknowns, about a first estimate.
struct Unknowns {
    start: CameraModel,
    poses: Vec<Pose>,
}

impl Unknowns {
    fn lens(&self, unknowns: &DVector<f64>) -> CameraModel {
        let scale = self.start.focal[0];
        let mut model = self.start.clone();
        for axis in 0..2 {
            model.focal[axis] *= 1.0 + unknowns[axis];
            model.centre[axis] += unknowns[2 + axis] * scale;
        }
        for (value, index) in model.distortion.iter_mut().zip(4..) {
            *value += unknowns[index];
        }
        model
    }
}

impl Model for Unknowns {
    fn see(&self, unknowns: &DVector<f64>, image: usize) -> (CameraModel, Pose) {
        (self.lens(unknowns), moved(&self.poses[image], six(unknowns, OF_LENS + 6 * image)))
    }

    fn depends(&self, image: usize) -> Vec<usize> {
        (0..OF_LENS).chain(OF_LENS + 6 * image..OF_LENS + 6 * image + 6).collect()
    }
}

/// Estimates a lens from images of the calibration sheet.
///
/// # Errors
/// Images that cannot be read or are of different sizes, fewer than [`LEAST_IMAGES`] that show enough of the
/// sheet, or all of them from one direction.
pub fn calibrate(paths: &[PathBuf]) -> Result<Lens, CalibrationError> {
    let (seen, left_out, [width, height]) = see_all(paths)?;
    let help = "take images of the whole calibration sheet from several directions, in focus, well lit";
    if seen.len() < LEAST_IMAGES {
        let what = "images that show enough of the calibration sheet";
        return Err(CalibrationError::TooFew { what, found: seen.len(), least: LEAST_IMAGES, help });
    }
    let one_direction = |angle: f64| CalibrationError::Degenerate {
        why: format!(
            "all images show the sheet from one direction: the angle between any two is at most {:.0}°, expected {:.0}° or more",
            angle.to_degrees(),
            LEAST_ANGLE.to_degrees()
        ),
        help: "tilt the sheet or the camera to all four sides, by 30° or so",
    };
    let first = first_lens(&seen, width, height).ok_or_else(|| one_direction(0.0))?;
    let poses: Vec<Pose> = seen.iter().filter_map(|seen| plane_pose(&first, seen.tags())).collect();
    let angle = widest(&poses);
    if poses.len() < seen.len() || angle < LEAST_ANGLE {
        return Err(one_direction(angle));
    }
    let not_found =
        || CalibrationError::Degenerate { why: "no lens explains these images".to_string(), help };
    // From corners first: edges are measured only where they are expected.
    let corners: Vec<Vec<Sight>> = seen.iter().map(Seen::corners).collect();
    let unknowns = Unknowns { start: first, poses };
    let (unknowns, _) = solve(&unknowns, &corners).ok_or_else(not_found)?;
    let edges = |unknowns: &Unknowns| -> Vec<Vec<Sight>> {
        seen.iter().zip(&unknowns.poses).map(|(seen, x_cb)| seen.edges(&unknowns.start, x_cb)).collect()
    };
    let (unknowns, _) = solve(&unknowns, &edges(&unknowns)).ok_or_else(not_found)?;
    let sights = edges(&unknowns);
    let (unknowns, adjusted) = solve(&unknowns, &sights).ok_or_else(not_found)?;
    let angle = widest(&unknowns.poses);
    if angle < LEAST_ANGLE {
        return Err(one_direction(angle));
    }
    let (place, errors) = spread(&unknowns, &sights).ok_or_else(not_found)?;
    let residual = adjusted.residual;
    Ok(Lens { model: unknowns.start, residual, place, errors, images: seen.len(), left_out, angle })
}

/// The sheet in each image that shows enough of it, the other images, and the size of all of them.
#[allow(clippy::type_complexity)]
fn see_all(paths: &[PathBuf]) -> Result<(Vec<Seen>, Vec<PathBuf>, [usize; 2]), CalibrationError> {
    let mut finder = TagFinder::new().map_err(CalibrationError::Detector)?;
    let places = board::places();
    let (mut all, mut left_out) = (Vec::new(), Vec::new());
    let mut size: Option<[usize; 2]> = None;
    for path in paths {
        let image = read_image(path)?;
        let file = || path.display().to_string();
        let [width, height] = *size.get_or_insert([image.width, image.height]);
        if [width, height] != [image.width, image.height] {
            let why = format!(
                "is {} × {} pixels, the first image {width} × {height}; expected one size",
                image.width, image.height
            );
            return Err(CalibrationError::Image { file: file(), why });
        }
        let seen = Seen::find(&mut finder, &image, &places)
            .map_err(|why| CalibrationError::Sight { file: file(), why })?;
        if seen.tags().len() < LEAST_TAGS { left_out.push(path.clone()) } else { all.push(seen) }
    }
    Ok((all, left_out, size.unwrap_or_default()))
}

/// A lens without distortion whose principal point is the middle of the image.
fn first_lens(seen: &[Seen], width: usize, height: usize) -> Option<CameraModel> {
    let middle = [width as f64 / 2.0, height as f64 / 2.0];
    let homographies: Vec<Matrix3<f64>> = seen
        .iter()
        .filter_map(|seen| {
            let points: Vec<_> = plane_points(seen.tags())
                .into_iter()
                .map(|(point, [u, v])| (point, [u - middle[0], v - middle[1]]))
                .collect();
            homography(&points)
        })
        .collect();
    Some(bare(width, height, focal_length(&homographies)?))
}

/// The widest angle between two normals of the sheet in the optical frame, rad.
fn widest(poses: &[Pose]) -> f64 {
    let normal = |pose: &Pose| pose.rotation * nalgebra::Vector3::z();
    let angles = poses
        .iter()
        .enumerate()
        .flat_map(|(index, a)| poses[index + 1..].iter().map(move |b| normal(a).angle(&normal(b))));
    angles.fold(0.0, f64::max)
}

fn solve(unknowns: &Unknowns, sights: &[Vec<Sight>]) -> Option<(Unknowns, Adjusted)> {
    let images: Vec<&[Sight]> = sights.iter().map(Vec::as_slice).collect();
    let start = DVector::zeros(OF_LENS + 6 * images.len());
    let adjusted = adjust(unknowns, &images, start)?;
    let found = &adjusted.unknowns;
    let poses = (0..images.len()).map(|image| unknowns.see(found, image).1).collect();
    Some((Unknowns { start: unknowns.lens(found), poses }, adjusted))
}

/// Standard error of the place of a pixel, the largest of a grid over the image, and those of focal lengths
/// and principal point, pixels.
fn spread(unknowns: &Unknowns, sights: &[Vec<Sight>]) -> Option<(f64, [f64; 4])> {
    let model = &unknowns.start;
    let pixels: Vec<[f64; 2]> = (0..GRID * GRID)
        .map(|index| {
            let share = |at: usize| at as f64 / (GRID - 1) as f64;
            [share(index % GRID) * model.width as f64, share(index / GRID) * model.height as f64]
        })
        .collect();
    let mut places = vec![Vec::new(); pixels.len()];
    let mut numbers = [const { Vec::new() }; 4];
    for kept in kept(sights.len()) {
        let poses = kept.iter().map(|&image| unknowns.poses[image]).collect();
        let sights: Vec<Vec<Sight>> = kept.iter().map(|&image| sights[image].clone()).collect();
        let (other, _) = solve(&Unknowns { start: model.clone(), poses }, &sights)?;
        for (pixel, squares) in pixels.iter().zip(&mut places) {
            let [x, y] = model.direction(*pixel);
            let [u, v] = other.start.project(&Point3::new(x, y, 1.0))?;
            squares.push((u - pixel[0]).powi(2) + (v - pixel[1]).powi(2));
        }
        for axis in 0..2 {
            numbers[axis].push((other.start.focal[axis] - model.focal[axis]).powi(2));
            numbers[2 + axis].push((other.start.centre[axis] - model.centre[axis]).powi(2));
        }
    }
    let place = places.iter().map(|squares| standard_error(squares)).fold(0.0, f64::max);
    Some((place, numbers.map(|squares| standard_error(&squares))))
}
