//! Measured depth against the drawing of a part: how far its faces are off, whether something hides a place,
//! and whether the part is there at all.
//!
//! Depth sensors err by the disparity, and mostly in common for all that is near: a slow bias. So many depths
//! of a part count hardly more than one. Near edges a nearer surface spreads, so depths are taken in the
//! middle of faces only.

use nalgebra::{Point3, RowVector6, Vector3};
use ramp_robot::{Camera, DEPTH_UNIT, Image, Pose};

use super::canvas::{Canvas, GROUND};
use super::profile::Photograph;
use crate::fit::{Terms, motion};

/// Error of a disparity that depths of one part have in common (1 σ), pixels.
const COMMON: f64 = 0.12;
/// Largest number of depths that are taken of a part, and the least that tells something.
const MOST: usize = 80;
const LEAST: usize = 12;
/// Pixels on all sides of a depth that show the same part, and for its place the same face.
const CLEAR: usize = 5;
/// Least distance before the drawing from which on something hides it: m, and standard deviations of the
/// depth.
const HIDES: (f64, f64) = (8.0e-3, 4.0);
/// Share of the depths of a part that show something farther off, from which on it is not there.
const ABSENT: f64 = 0.6;

/// The standard deviation of a depth (m) that a camera measures at this distance, m.
pub fn sigma(camera: Camera, focal: f64, distance: f64) -> f64 {
    COMMON * distance * distance / (focal * camera.baseline())
}

/// The measured distance along the optical axis at a pixel of the drawing, m.
pub fn measured(image: &Image, photograph: &Photograph, pixel: [f64; 2]) -> Option<f64> {
    let [x, y] = photograph.place(pixel);
    if !(x >= 0.0 && y >= 0.0 && x < image.width as f64 && y < image.height as f64) {
        return None;
    }
    let units = *image.depth.as_ref()?.get(y as usize * image.width + x as usize)?;
    (units > 0).then(|| f64::from(units) * DEPTH_UNIT)
}

/// Whether something nearer is measured where the drawing has a distance, m.
pub fn hides(image: &Image, photograph: &Photograph, focal: f64, pixel: [f64; 2], distance: f64) -> bool {
    let least = HIDES.0.max(HIDES.1 * sigma(image.camera, focal, distance));
    measured(image, photograph, pixel).is_some_and(|measured| measured < distance - least)
}

/// A depth on a face of a part.
#[derive(Clone, Copy, Debug)]
struct Depth {
    /// Its place in the drawing, in the part's frame, m.
    p_p: Point3<f64>,
    /// The face's normal, likewise.
    normal_p: Vector3<f64>,
    /// Its measured place, in the optical frame, m.
    q_c: Point3<f64>,
    /// Standard deviation along the normal, m.
    sigma: f64,
}

/// The depths of one part.
#[derive(Clone, Debug, Default)]
pub struct Depths {
    all: Vec<Depth>,
    /// Number of those that show what is farther off than the part.
    behind: usize,
    /// Number of all that were compared.
    compared: usize,
}

impl Depths {
    /// Of the body of this number, which is drawn at `x_cp`, within a window of the drawing.
    pub fn of(
        image: &Image,
        photograph: &Photograph,
        canvas: &Canvas,
        (body, x_cp): (u16, &Pose),
        window: [[f64; 2]; 2],
    ) -> Depths {
        let mut depths = Depths::default();
        if image.depth.is_none() {
            return depths;
        }
        let [columns, rows] = canvas.window();
        let [x0, x1] = inside(window[0], columns);
        let [y0, y1] = inside(window[1], rows);
        let area = (x1.saturating_sub(x0) * y1.saturating_sub(y0)) as f64;
        // A long part fills a small share of its window.
        let step = (area / (20 * MOST) as f64).sqrt().max(2.0) as usize;
        let (width, focal) = (canvas.lens.size[0], canvas.lens.focal[0]);
        let x_pc = x_cp.inverse();
        for y in (y0..y1).step_by(step) {
            for x in (x0..x1).step_by(step) {
                let index = y * width + x;
                let shown = canvas.shown[index];
                let around = [index - CLEAR, index + CLEAR, index - CLEAR * width, index + CLEAR * width];
                let body_at =
                    |index: &usize| canvas.shown.get(*index).map(|it| canvas.faces[*it as usize].body);
                if shown == GROUND || [index].iter().chain(&around).any(|it| body_at(it) != Some(body)) {
                    continue;
                }
                let pixel = [x as f64 + 0.5, y as f64 + 0.5];
                let drawn = 1.0 / f64::from(canvas.near[index]);
                let Some(seen) = measured(image, photograph, pixel) else { continue };
                let along = sigma(image.camera, focal, drawn);
                let least = HIDES.0.max(HIDES.1 * along);
                if seen < drawn - least {
                    continue;
                }
                depths.compared += 1;
                if seen > drawn + least {
                    depths.behind += 1;
                    continue;
                }
                if around.iter().any(|other| canvas.shown[*other] != shown) {
                    continue;
                }
                let [dx, dy] = canvas.lens.direction(pixel);
                let at = |distance: f64| Point3::new(dx * distance, dy * distance, distance);
                let normal = Vector3::from(canvas.faces[shown as usize].normal.map(f64::from));
                let slant = normal.dot(&Vector3::new(dx, dy, 1.0)).abs();
                depths.all.push(Depth {
                    p_p: x_pc * at(drawn),
                    normal_p: x_pc.rotation * normal,
                    q_c: at(seen),
                    sigma: along * slant.max(0.1),
                });
            }
        }
        let stride = depths.all.len().div_ceil(MOST).max(1);
        depths.all = depths.all.into_iter().step_by(stride).collect();
        depths
    }

    /// Whether they show that the part is not there.
    pub fn show_absence(&self) -> bool {
        self.compared >= LEAST && self.behind as f64 >= ABSENT * self.compared as f64
    }
}

/// Columns or rows of a window in which neighbours can be looked at.
fn inside(window: [f64; 2], drawn: [usize; 2]) -> [usize; 2] {
    let from = (window[0].max(0.0) as usize).max(drawn[0] + CLEAR);
    [from, (window[1].max(0.0) as usize).min(drawn[1].saturating_sub(CLEAR))]
}

impl Terms for Depths {
    fn each(&self, x_cp: &Pose, take: &mut dyn FnMut(f64, &RowVector6<f64>)) {
        if self.all.len() < LEAST {
            return;
        }
        // Together they count as one for each direction.
        let share = (self.all.len() as f64).sqrt();
        for depth in &self.all {
            let normal = x_cp.rotation * depth.normal_p;
            let off = normal.dot(&(x_cp * depth.p_p - depth.q_c));
            let sigma = depth.sigma * share;
            let row = normal.transpose() * motion(x_cp, &depth.p_p);
            take(off / sigma, &(row / sigma));
        }
    }
}
