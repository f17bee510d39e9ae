//! Adjusts unknowns until the known points of all images would have been seen where they were: Levenberg and
//! Marquardt's method, with residuals that count less when they are unusually large.

use nalgebra::{DMatrix, DVector, Translation3, UnitQuaternion, Vector3};
use ramp_robot::{CameraModel, Pose};

use crate::sights::Sight;

/// Residuals beyond this many of their usual size count less and less.
const HUBER: f64 = 3.0;
/// The median of the absolute value of normally distributed errors, in standard deviations.
const MEDIAN: f64 = 0.6745;
/// Step of numerical derivatives. All unknowns are of the order of 1: rad, m, shares.
const STEP: f64 = 1e-6;
/// Most steps of a search.
const STEPS: usize = 60;
/// A step that lowers the cost by less than this share ends the search.
const SETTLED: f64 = 1e-9;

/// The meaning of the unknowns for each image.
pub trait Model {
    /// Camera model, and pose of the target in its optical frame, in the image of this index.
    fn see(&self, unknowns: &DVector<f64>, image: usize) -> (CameraModel, Pose);
    /// The unknowns on which that depends.
    fn depends(&self, image: usize) -> Vec<usize>;
    /// Unknowns that are known to be about zero, each with its usual size.
    fn priors(&self) -> Vec<(usize, f64)> {
        Vec::new()
    }
}

/// A pose moved by a small shift (m) and turn (rad) in the axes of the frame in which it is given.
pub fn moved(x: &Pose, change: [f64; 6]) -> Pose {
    let [x0, y0, z0, a, b, c] = change;
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(a, b, c));
    Pose::from_parts(Translation3::from(x.translation.vector + Vector3::new(x0, y0, z0)), turn * x.rotation)
}

/// Six unknowns from an index on.
pub fn six(unknowns: &DVector<f64>, from: usize) -> [f64; 6] {
    std::array::from_fn(|axis| unknowns[from + axis])
}

/// The unknowns that were found.
#[derive(Clone, Debug)]
pub struct Adjusted {
    /// The unknowns.
    pub unknowns: DVector<f64>,
    /// Root of the mean of the squares of all residuals, pixels.
    pub residual: f64,
    /// The same, each residual in units of its usual error.
    pub normalised: f64,
    /// Inverse of their covariance for residuals of their usual size.
    pub information: DMatrix<f64>,
}

/// Sums over all residuals at some unknowns.
struct Sums {
    matrix: DMatrix<f64>,
    vector: DVector<f64>,
    robust: f64,
    squares: f64,
    normalised: f64,
    count: usize,
}

/// Moves the unknowns from `start`, where `images` are the sights of each image; `None` when they lead
/// nowhere.
pub fn adjust(model: &dyn Model, images: &[&[Sight]], start: DVector<f64>) -> Option<Adjusted> {
    let mut unknowns = start;
    // The usual residual depends on the lens and the light, too: first of the start, then of what was
    // found.
    for _ in 0..2 {
        let scale = usual(model, images, &unknowns);
        unknowns = search(model, images, unknowns, scale)?;
    }
    let sums = sum(model, images, &unknowns, 1.0);
    let mean = |squares: f64| (squares / sums.count.max(1) as f64).sqrt();
    let (residual, normalised) = (mean(sums.squares), mean(sums.normalised));
    Some(Adjusted { unknowns, residual, normalised, information: sums.matrix })
}

/// One search, with residuals of `scale` times their usual error.
fn search(
    model: &dyn Model,
    images: &[&[Sight]],
    mut unknowns: DVector<f64>,
    scale: f64,
) -> Option<DVector<f64>> {
    let mut damping = 1e-3;
    let mut now = sum(model, images, &unknowns, scale);
    for _ in 0..STEPS {
        let mut matrix = now.matrix.clone();
        for index in 0..unknowns.len() {
            matrix[(index, index)] *= 1.0 + damping;
            // An unknown without any effect stays.
            matrix[(index, index)] += 1e-9;
        }
        let change = matrix.cholesky()?.solve(&-&now.vector);
        if !change.iter().all(|value| value.is_finite()) {
            return None;
        }
        let there = &unknowns + change;
        let next = sum(model, images, &there, scale);
        // A point behind a camera has no residual.
        if next.count == now.count && next.robust <= now.robust {
            let gain = now.robust - next.robust;
            (unknowns, now) = (there, next);
            damping = (damping * 0.2).max(1e-9);
            if gain <= SETTLED * now.robust {
                break;
            }
        } else {
            damping *= 10.0;
            if damping > 1e8 {
                break;
            }
        }
    }
    Some(unknowns)
}

/// How many times larger than expected usual residuals are, at least 1.
fn usual(model: &dyn Model, images: &[&[Sight]], unknowns: &DVector<f64>) -> f64 {
    let mut sizes = Vec::new();
    for (image, sights) in images.iter().enumerate() {
        let (camera, x_cb) = model.see(unknowns, image);
        sizes.extend(sights.iter().filter_map(|it| Some((residual(&camera, &x_cb, it)? / it.sigma).abs())));
    }
    sizes.sort_by(f64::total_cmp);
    (sizes.get(sizes.len() / 2).copied().unwrap_or_default() / MEDIAN).max(1.0)
}

/// Expected less measured place, pixels; `None` behind the camera.
fn residual(camera: &CameraModel, x_cb: &Pose, sight: &Sight) -> Option<f64> {
    let at = camera.project(&(x_cb * sight.p_b))?;
    Some(sight.normal[0] * at[0] + sight.normal[1] * at[1] - sight.along)
}

fn sum(model: &dyn Model, images: &[&[Sight]], unknowns: &DVector<f64>, scale: f64) -> Sums {
    let count = unknowns.len();
    let mut sums = Sums {
        matrix: DMatrix::zeros(count, count),
        vector: DVector::zeros(count),
        robust: 0.0,
        squares: 0.0,
        normalised: 0.0,
        count: 0,
    };
    for (index, usual) in model.priors() {
        let size = unknowns[index] / usual;
        sums.matrix[(index, index)] += 1.0 / (usual * usual);
        sums.vector[index] += size / usual;
        sums.robust += size * size;
    }
    for (image, sights) in images.iter().enumerate() {
        let depends = model.depends(image);
        let here = model.see(unknowns, image);
        let moved: Vec<(CameraModel, Pose)> = depends
            .iter()
            .map(|&index| {
                let mut there = unknowns.clone();
                there[index] += STEP;
                model.see(&there, image)
            })
            .collect();
        // The sums over this image's unknowns only.
        let mut matrix = DMatrix::zeros(depends.len(), depends.len());
        let mut vector = DVector::zeros(depends.len());
        let mut row = DVector::zeros(depends.len());
        for sight in *sights {
            let Some(at) = residual(&here.0, &here.1, sight) else { continue };
            let unit = sight.sigma * scale;
            for (slope, (camera, x_cb)) in row.iter_mut().zip(&moved) {
                *slope = residual(camera, x_cb, sight).map_or(0.0, |there| (there - at) / STEP / unit);
            }
            let size = (at / unit).abs();
            let weight = if size > HUBER { HUBER / size } else { 1.0 };
            matrix.syger(weight, &row, &row, 1.0);
            vector.axpy(weight * at / unit, &row, 1.0);
            sums.robust += if size > HUBER { HUBER * (2.0 * size - HUBER) } else { size * size };
            sums.squares += at * at;
            sums.normalised += (at / sight.sigma).powi(2);
            sums.count += 1;
        }
        matrix.fill_upper_triangle_with_lower_triangle();
        for (a, &row) in depends.iter().enumerate() {
            sums.vector[row] += vector[a];
            for (b, &column) in depends.iter().enumerate() {
                sums.matrix[(row, column)] += matrix[(a, b)];
            }
        }
    }
    sums
}
