//! The edges of tags' black squares, measured.
//!
//! From a pose that is nearly right, places along each edge are thrown into the image; across the edge, the
//! light there falls from the white of the sticker to the black of the square. Because the light is linear
//! and the blur the same to both sides, the edge is where the light that is missing on one side equals the
//! light too much on the other.

use nalgebra::{Point3, Vector3};
use ramp_kit::tags::{BLACK_CELLS, TagPlace};
use ramp_robot::{CameraModel, Pose};

use crate::image::Grey;

/// Places that are measured on each edge.
const PLACES: usize = 12;
/// Places that are measured on each tag.
pub const COUNT: usize = 4 * PLACES;
/// Steps across an edge per pixel.
const STEPS: f64 = 4.0;
/// Farthest that is looked to each side of an edge, pixels.
const REACH: f64 = 3.0;
/// Blur radius of an edge by the lens and between pixels, pixels.
const BLUR: f64 = 1.4;
/// Least that is looked to each side, pixels.
const LEAST_REACH: f64 = 0.8;
/// Least difference of light between the two sides, levels of 255.
const CONTRAST: f64 = 25.0;

/// A place on an edge, and how far from where it was expected it is.
#[derive(Clone, Debug)]
pub struct Place {
    /// The place on the part, m.
    pub p_p: Point3<f64>,
    /// Across the edge, away from the tag, of length 1: in the image.
    pub normal: [f64; 2],
    /// Measured distance along the normal from the origin of the image: `normal · pixel`, pixels.
    pub along: f64,
    /// Number of the edge it is on, counted through all tags.
    pub edge: usize,
}

/// Measures the four edges of a tag. `x_cp` is the pose of its part in the optical frame, as far as it is
/// known, and `first` the number of its first edge.
pub fn measure(
    grey: &Grey,
    camera: &CameraModel,
    tag: &TagPlace,
    x_cp: &Pose,
    first: usize,
    places: &mut Vec<Place>,
) {
    let half = tag.edge / 2.0;
    let corners = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]]
        .map(|[x, y]| tag.x_pg * Point3::new(half * x, half * y, 0.0));
    let middle = tag.x_pg.translation.vector;
    for edge in 0..4 {
        let (from, to) = (corners[edge], corners[(edge + 1) % 4]);
        let outwards: Vector3<f64> = ((from.coords + to.coords) / 2.0 - middle).normalize();
        for place in 0..PLACES {
            // The corners themselves, where two edges blur into each other, are left out.
            let share = 0.08 + 0.84 * (place as f64 + 0.5) / PLACES as f64;
            let p_p = from + (to - from) * share;
            let project = |p_p: Point3<f64>| camera.project(&(x_cp * p_p));
            // A cell away on both sides, to see how large a cell is here, and the way along the edge.
            let cell = tag.edge / BLACK_CELLS as f64;
            let (Some(at), Some(out), Some(next)) =
                (project(p_p), project(p_p + outwards * cell), project(p_p + (to - from) * 0.02))
            else {
                continue;
            };
            let (ax, ay) = (next[0] - at[0], next[1] - at[1]);
            let length = ax.hypot(ay);
            let mut normal = [-ay / length, ax / length];
            let width = normal[0] * (out[0] - at[0]) + normal[1] * (out[1] - at[1]);
            if width < 0.0 {
                normal = normal.map(|value| -value);
            }
            // Never into the blur of the next cell.
            let reach = (width.abs() - BLUR).clamp(LEAST_REACH, REACH);
            if let Some(offset) = across(grey, at, normal, reach) {
                let along = normal[0] * at[0] + normal[1] * at[1] + offset;
                places.push(Place { p_p, normal, along, edge: first + edge });
            }
        }
    }
}

/// Distance along the normal at which the light changes from dark to bright; `None` without a change.
fn across(grey: &Grey, at: [f64; 2], normal: [f64; 2], reach: f64) -> Option<f64> {
    let mut centre = 0.0;
    // The window follows the edge, so that both sides count alike.
    for _ in 0..5 {
        let offset = offset(grey, [at[0] + centre * normal[0], at[1] + centre * normal[1]], normal, reach)?;
        centre += offset;
        if centre.abs() > 2.0 * REACH {
            return None;
        }
        if offset.abs() < 0.01 {
            break;
        }
    }
    Some(centre)
}

fn offset(grey: &Grey, at: [f64; 2], normal: [f64; 2], reach: f64) -> Option<f64> {
    let count = (2.0 * reach * STEPS).round().max(8.0) as usize;
    let step = 2.0 * reach / count as f64;
    let mut light = [0.0; 2 * (REACH * STEPS) as usize + 1];
    let light = light.get_mut(..=count)?;
    for (index, value) in light.iter_mut().enumerate() {
        let s = -reach + step * index as f64;
        *value = grey.at([at[0] + s * normal[0], at[1] + s * normal[1]])?;
    }
    let sides = (count / 6).max(1);
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let (dark, bright) = (mean(&light[..sides]), mean(&light[count + 1 - sides..]));
    if bright - dark < CONTRAST {
        return None;
    }
    // The area under the curve: an edge at +e hides light over a length e.
    let inner: f64 = light[1..count].iter().sum::<f64>() + 0.5 * (light[0] + light[count]);
    let lit = (inner * step - dark * 2.0 * reach) / (bright - dark);
    Some(reach - lit)
}
