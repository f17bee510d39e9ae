//! The pose of one part, from the distances of its steps in the image from those of the drawing.

use nalgebra::{Matrix6, Point3, RowVector6, Vector3, Vector6};
use ramp_robot::Pose;

use super::canvas::Lens;
use super::depths::Depths;
use crate::fit::{Level, Terms, motion, moved};

/// Usual error of a step's place, pixels.
const STEP_ERROR: f64 = 0.33;
/// Steps next to each other have errors in common: this many count as one.
const COMMON: f64 = 4.0;
/// A step within this of the pose's own supports it, pixels.
const AGREES: f64 = 1.0;
/// A part's middle is within this of where it is believed (m, rad, 1 σ): next to nothing.
const NEAR: [f64; 2] = [5.0e-3, 0.05];
/// Rounds of Gauss and Newton's method, in which the window narrows by this share each.
const ROUNDS: i32 = 7;
const NARROWER: f64 = 0.65;

/// A step that was found in the image.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// On the part, m.
    pub p_p: Point3<f64>,
    /// Unit vector in the drawing in which its place was measured.
    pub normal: [f64; 2],
    /// Its place along that vector, pixels.
    pub along: f64,
    /// Whether it looks like a printed line.
    pub is_line: bool,
}

/// A fitted pose.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// In the optical frame.
    pub x_cp: Pose,
    /// Inverse of the covariance of a shift (m) and turn (rad) about the part's origin, axes of the optical
    /// frame: what the image tells.
    pub information: Matrix6<f64>,
    /// The same: what was known of its height and tilt, and what depth tells.
    pub known: Matrix6<f64>,
    /// Steps that support it.
    pub agreeing: usize,
    /// Root of the mean square of how far off those are, pixels.
    pub pixels: f64,
}

/// Residual of a place and its derivative by shift and turn of the part.
fn residual(lens: &Lens, x_cp: &Pose, place: &Place) -> Option<(f64, RowVector6<f64>)> {
    let p_c = x_cp * place.p_p;
    if p_c.z <= 0.01 {
        return None;
    }
    let at = lens.project(&p_c);
    let [nx, ny] = place.normal;
    let slope = lens.slope(&p_c);
    let row = (slope.row(0) * nx + slope.row(1) * ny) * motion(x_cp, &place.p_p);
    Some((nx * at[0] + ny * at[1] - place.along, row))
}

/// Whether a place supports a pose.
pub fn supports(lens: &Lens, x_cp: &Pose, place: &Place) -> bool {
    residual(lens, x_cp, place).is_some_and(|(off, _)| off.abs() < AGREES)
}

/// Moves a part from `start` until the places lie on its steps; `reach` (pixels) is how far off they may be
/// at first. `level` is what is known of its height and tilt, and `depths` are what a depth sensor says.
pub fn settle(
    lens: &Lens,
    start: &Pose,
    places: &[Place],
    (level, depths): (Option<&Level>, &Depths),
    reach: f64,
) -> Option<Fitted> {
    let count = places.len().max(1) as f64;
    let middle = Point3::from(places.iter().map(|place| place.p_p.coords).sum::<Vector3<f64>>() / count);
    let mut x = *start;
    let (mut information, mut known) = (Matrix6::zeros(), Matrix6::zeros());
    let (mut agreeing, mut pixels) = (0, 0.0);
    for round in 0..ROUNDS {
        let window = (reach * NARROWER.powi(round)).max(AGREES);
        let (mut matrix, mut vector) = (Matrix6::zeros(), Vector6::zeros());
        let mut add = |off: f64, row: &RowVector6<f64>, weight: f64| {
            matrix += row.transpose() * row * weight;
            vector += row.transpose() * (off * weight);
        };
        let mut squares = 0.0;
        agreeing = 0;
        for place in places {
            let Some((off, row)) = residual(lens, &x, place) else { continue };
            let share = off / window;
            if share.abs() >= 1.0 {
                continue;
            }
            if off.abs() < AGREES {
                agreeing += 1;
                squares += off * off;
            }
            // Tukey's weight: what is far off counts nothing.
            let weight = (1.0 - share * share).powi(2) / (STEP_ERROR * STEP_ERROR * COMMON);
            add(off, &row, weight);
        }
        pixels = (squares / f64::from(agreeing.max(1) as u32)).sqrt();
        let slope = motion(&x, &middle);
        let shift = x * middle - start * middle;
        let turn = (x.rotation * start.rotation.inverse()).scaled_axis();
        for axis in 0..3 {
            add(shift[axis], &slope.row(axis).into_owned(), NEAR[0].powi(-2));
            let mut row = RowVector6::zeros();
            row[3 + axis] = 1.0;
            add(turn[axis], &row, NEAR[1].powi(-2));
        }
        information = matrix;
        known = Matrix6::zeros();
        let mut take = |off: f64, row: &RowVector6<f64>| {
            known += row.transpose() * row;
            vector += row.transpose() * off;
        };
        if let Some(level) = level {
            level.each(&x, &mut take);
        }
        depths.each(&x, &mut take);
        x = moved(&x, &(matrix + known).cholesky()?.solve(&(-vector)));
    }
    let sound = x.translation.vector.iter().all(|value| value.is_finite()) && x.translation.z > 0.0;
    sound.then_some(Fitted { x_cp: x, information, known, agreeing, pixels })
}
