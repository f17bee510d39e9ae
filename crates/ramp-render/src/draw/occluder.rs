//! The lamp's view of bodies: what it meets first above each cell of the table's map, and where the corners
//! of a surface are in that view. Its rays are parallel.

use super::light::LIGHT;
use super::map::{SHADOW_SCALE, TABLE};

/// Least height of an occluder above a place in its shadow, m: more than the rough surfaces of parts stand
/// out.
/// No body throws a shadow on itself, since the surfaces of the arm's links are rougher.
const ABOVE: f32 = 6.0e-3;

/// The body that the lamp's ray to a cell of the map meets first.
#[derive(Clone, Copy)]
pub(super) struct Occluder {
    /// m above the table.
    height: f32,
    body: u16,
}

impl Occluder {
    pub(super) const NONE: Occluder = Occluder { height: f32::NEG_INFINITY, body: u16::MAX };

    /// Is there nothing above the cell?
    #[inline]
    pub(super) fn is_none(&self) -> bool {
        self.height == f32::NEG_INFINITY
    }

    /// Takes over what is higher.
    #[inline]
    pub(super) fn raise(&mut self, height: f32, body: u16) {
        if height > self.height {
            *self = Occluder { height, body };
        }
    }

    /// Does it keep the lamp's light from a place so high on this body?
    #[inline]
    pub(super) fn covers(&self, height: f32, body: u16) -> bool {
        self.body != body && self.height > height + ABOVE
    }
}

/// The place on the map, in cells, of the light that passes a point (m, world), and the point's height, m.
#[inline]
pub(super) fn along_light([x, y, z]: &[f32; 3]) -> [f32; 3] {
    let down = z.max(0.0) / LIGHT[2];
    [
        (x - LIGHT[0] * down - TABLE[0][0]) * SHADOW_SCALE,
        (y - LIGHT[1] * down - TABLE[1][0]) * SHADOW_SCALE,
        *z,
    ]
}

/// The height (m) of a triangle on the map at a place on it (cells).
pub(super) fn plane([a, b, c]: &[[f32; 3]; 3]) -> impl Fn(f32, f32) -> f32 + use<> {
    let [ab, ac]: [[f32; 3]; 2] = [b, c].map(|to| std::array::from_fn(|axis| to[axis] - a[axis]));
    let area = ab[0] * ac[1] - ab[1] * ac[0];
    let [low, high] = [f32::min, f32::max].map(|of| of(of(a[2], b[2]), c[2]));
    // The highest of one that the lamp sees from the side.
    let slope = |rise: f32| if area.abs() > 1e-6 { rise / area } else { 0.0 };
    let [dx, dy] = [slope(ab[2] * ac[1] - ab[1] * ac[2]), slope(ab[0] * ac[2] - ab[2] * ac[0])];
    let [x, y, z] = *a;
    let start = if area.abs() > 1e-6 { z } else { high };
    move |column, row| (start + dx * (column - x) + dy * (row - y)).clamp(low, high)
}

/// A corner of a surface in the lamp's light.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    /// As [`along_light`] has it.
    pub(super) at: [f32; 3],
    /// Light of the lamp, of 256, once it is known.
    pub(super) lit: Option<u32>,
}

impl Corner {
    /// A corner at a place, m in the world.
    pub(super) fn new(place: &[f32; 3]) -> Corner {
        Corner { at: along_light(place), lit: None }
    }
}
