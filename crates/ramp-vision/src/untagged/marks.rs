//! The marks of a part: steps of its drawing, each with what the drawing shows across it. They move with the
//! part, so a part that moved little need not be drawn again to be measured again.

use nalgebra::Point3;
use ramp_robot::{Image, Pose};

use super::canvas::{Canvas, Lens};
use super::contours::Step;
use super::depths::hides;
use super::profile::{Match, Photograph, Profile, normal};

/// Cosine of a step's normal and the axis from which it counts as across.
const ACROSS: f64 = 0.8;

/// A step of a part that can be measured.
#[derive(Clone, Debug)]
pub struct Mark {
    /// On the part, m.
    pub p_p: Point3<f64>,
    /// Its place in the drawing, pixels.
    pub at: [f64; 2],
    /// Unit vector in the drawing along which its place is measured.
    pub normal: [f64; 2],
    /// Whether it tells where the part is along its axis.
    pub across: bool,
    /// Whether a shadow may hide it.
    pub by_light: bool,
    /// The profile that is looked for near its drawn place.
    near: Option<Profile>,
    /// The same with larger pixels, for a first window that is wide.
    wide: Option<Profile>,
}

impl Mark {
    /// The step of the image near `at`, looked for up to `reach` on both sides; pixels. `wide` says whether
    /// that is the first, wide window.
    pub fn distance(&self, photograph: &Photograph, at: [f64; 2], reach: f64, wide: bool) -> Option<Match> {
        let profile = if wide { &self.wide } else { &self.near };
        profile.as_ref()?.distance(photograph, at, reach)
    }
}

/// The marks of a part that is drawn at `x_cp`: of its contour at most `most`, without those that something
/// hides. A first window that is wide is looked through with pixels `scale` times as large.
pub fn marks(
    (canvas, contour): (&Canvas, &[Step]),
    (image, photograph): (&Image, &Photograph),
    x_cp: &Pose,
    most: usize,
    scale: f64,
) -> Vec<Mark> {
    let lens: &Lens = &canvas.lens;
    let x_pc = x_cp.inverse();
    let stride = contour.len().div_ceil(most).max(1);
    let axis = x_cp.rotation * nalgebra::Vector3::x();
    let mark = |step: &Step| {
        let normal = normal(canvas, step)?;
        let z = 1.0 / f64::from(canvas.near[step.inside]);
        if hides(image, photograph, lens.focal[0], step.at, z) {
            return None;
        }
        let [x, y] = lens.direction(step.at);
        let p_c = Point3::new(x * z, y * z, z);
        let along = lens.slope(&p_c) * axis;
        let share = (along.x * normal[0] + along.y * normal[1]).abs() / along.norm().max(1.0e-9);
        let profile = |scale: f64| Profile::of(canvas, step, normal, scale);
        Some(Mark {
            p_p: x_pc * p_c,
            at: step.at,
            normal,
            across: share > ACROSS,
            by_light: step.by_light,
            near: profile(1.0),
            wide: if scale > 1.0 { profile(scale) } else { None },
        })
    };
    contour.iter().step_by(stride).filter_map(mark).collect()
}
