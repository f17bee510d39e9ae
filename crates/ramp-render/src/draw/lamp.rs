//! How much of the lamp's light reaches a place on a body: what the lamp meets first above each cell of the
//! table's map is all there is to know, since its rays are parallel.

use super::light::LIGHT;
use super::map::{SHADOW_SCALE, TABLE, shadow_size};
use super::renderer::{NOTHING, Renderer};

/// What throws a shadow is so far above what it falls on, m: more than the rough surfaces of parts stand out.
/// No body throws a shadow on itself, since the surfaces of the arm's links are rougher.
const ABOVE: f32 = 6.0e-3;
/// A triangle so small is lit as its corners are, cells: as wide as the edge of a shadow.
const SMALL: f32 = 3.0;
/// Light of the lamp at the corners of a triangle that counts as even, of 256.
const EVEN: u32 = 32;
/// Light of the lamp where nothing is in its way.
pub(super) const FULLY: u32 = 256;

/// What the lamp meets first on its way to a cell.
#[derive(Clone, Copy)]
pub(super) struct Roof {
    /// m above the table.
    height: f32,
    body: u16,
}

impl Roof {
    pub(super) const NONE: Roof = Roof { height: f32::NEG_INFINITY, body: NOTHING };

    /// Is there nothing above the cell?
    #[inline]
    pub(super) fn is_none(&self) -> bool {
        self.height == f32::NEG_INFINITY
    }

    /// Takes over what is higher.
    #[inline]
    pub(super) fn raise(&mut self, height: f32, body: u16) {
        if height > self.height {
            *self = Roof { height, body };
        }
    }

    /// Does it keep the lamp's light from a place so high on this body?
    #[inline]
    fn covers(&self, height: f32, body: u16) -> bool {
        self.body != body && self.height > height + ABOVE
    }
}

/// Where the light that passes a point (m, world) meets the map, in cells, and the point's height, m.
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
    at: [f32; 3],
    /// Light of the lamp, of 256, once it is known.
    lit: Option<u32>,
}

impl Corner {
    /// A corner at a place, m in the world.
    pub(super) fn new(place: &[f32; 3]) -> Corner {
        Corner { at: along_light(place), lit: None }
    }
}

/// How a surface lies in the lamp's light.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Lit {
    /// So much of the lamp's light, of 256, reaches all of it.
    Evenly(u32),
    /// An edge of a shadow may cross it.
    Partly,
}

impl Renderer {
    /// How a triangle of a body with these corners lies in the light.
    pub(super) fn lit(&self, corners: [&mut Corner; 3], body: u16) -> Lit {
        let [columns, rows] = shadow_size();
        let at = corners.each_ref().map(|corner| corner.at);
        let low = |axis: usize| at[0][axis].min(at[1][axis]).min(at[2][axis]);
        let high = |axis: usize| at[0][axis].max(at[1][axis]).max(at[2][axis]);
        if (high(0) - low(0)).max(high(1) - low(1)) < SMALL {
            let [a, b, c] =
                corners.map(|corner| *corner.lit.get_or_insert_with(|| self.lamp_along(corner.at, body)));
            let even = a.max(b).max(c) - a.min(b).min(c) < EVEN;
            return if even { Lit::Evenly((a + b + c) / 3) } else { Lit::Partly };
        }
        // With the cells that a soft edge reaches.
        let range = |axis: usize, count: usize| {
            let from = (low(axis) - 1.5).max(0.0) as usize;
            let to = ((high(axis) + 2.5).max(0.0) as usize).min(count);
            from.min(to)..to
        };
        let (across, down) = (range(0, columns), range(1, rows));
        if across.is_empty() || down.is_empty() {
            return Lit::Evenly(FULLY);
        }
        let (height, mut covered) = (plane(&at), 0);
        let count = across.len() * down.len();
        for (seen, row) in down.enumerate() {
            let roofs = self.roofs[row * columns..][across.clone()].iter().zip(across.start..);
            let covers = |(roof, column): (&Roof, usize)| {
                usize::from(roof.covers(height(column as f32 + 0.5, row as f32 + 0.5), body))
            };
            covered += roofs.map(covers).sum::<usize>();
            if covered > 0 && covered < (seen + 1) * across.len() {
                return Lit::Partly;
            }
        }
        Lit::Evenly(if covered == count { 0 } else { FULLY })
    }

    /// Light of the lamp, of 256, at a place (m, world) on a body. The lamp is not a point: an edge of a
    /// shadow is three cells wide.
    pub(super) fn lamp_at(&self, place: &[f32; 3], body: u16) -> u32 {
        self.lamp_along(along_light(place), body)
    }

    /// The same at a place on the map, with its height.
    fn lamp_along(&self, [u, v, height]: [f32; 3], body: u16) -> u32 {
        let [columns, rows] = shadow_size();
        // Of four cells along both directions, the first and the last count by a share.
        let begin = |at: f32, count: usize| {
            let at = (at - 1.5).clamp(0.0, (count - 5) as f32);
            (at as usize, (256.0 * (at - at.floor())) as u32)
        };
        let ((column, across), (row, down)) = (begin(u, columns), begin(v, rows));
        let weights = |share: u32| [256 - share, 256, 256, share];
        let mut dark = 0;
        for (line, weight) in weights(down).into_iter().enumerate() {
            let roofs = &self.roofs[(row + line) * columns + column..][..4];
            let covered = roofs.iter().zip(weights(across)).filter(|(roof, _)| roof.covers(height, body));
            dark += weight * covered.map(|(_, weight)| weight).sum::<u32>();
        }
        // Nine cells of 256 times 256.
        FULLY - dark / (9 * 256)
    }
}
