//! How much of the lamp's light reaches a place on a body.

use super::map::shadow_size;
use super::occluder::{Occluders, along_light, plane};
use super::renderer::Renderer;

/// A triangle so small is lit as its corners are, cells: as wide as the edge of a shadow.
const SMALL: f32 = 3.0;
/// Light of the lamp at the corners of a triangle that counts as even, of 256.
const EVEN: u32 = 32;
/// Light of the lamp where nothing is in its way.
pub(super) const FULLY: u32 = 256;

/// How a surface lies in the lamp's light.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Lit {
    /// So much of the lamp's light, of 256, reaches all of it.
    Evenly(u32),
    /// An edge of a shadow may cross it.
    Partly,
}

impl Renderer {
    /// How a triangle of a body with corners at these places in the light ([`along_light`]) lies in it. Takes
    /// the light at its corners, of 256, from `known`, or adds it there.
    #[inline]
    pub(super) fn lit(&self, at: &[[f32; 3]; 3], body: u16, known: &mut [Option<u32>; 3]) -> Lit {
        let [columns, rows] = shadow_size();
        let low = |axis: usize| at[0][axis].min(at[1][axis]).min(at[2][axis]);
        let high = |axis: usize| at[0][axis].max(at[1][axis]).max(at[2][axis]);
        // With the cells that a soft edge reaches.
        let around = |axis: usize, count: usize| {
            let from = (low(axis) - 1.5).clamp(0.0, (count - 5) as f32);
            let to = (high(axis) + 2.5).clamp(3.0, (count - 1) as f32);
            [from as usize, to as usize]
        };
        if self.occluders.are_clear(around(0, columns), around(1, rows), low(2), body) {
            return Lit::Evenly(FULLY);
        }
        if (high(0) - low(0)).max(high(1) - low(1)) < SMALL {
            self.by_corners(at, body, known)
        } else {
            self.by_cells(at, body)
        }
    }

    fn by_corners(&self, at: &[[f32; 3]; 3], body: u16, known: &mut [Option<u32>; 3]) -> Lit {
        let [a, b, c] =
            [0, 1, 2].map(|corner| *known[corner].get_or_insert_with(|| self.lamp_along(at[corner], body)));
        let even = a.max(b).max(c) - a.min(b).min(c) < EVEN;
        if even { Lit::Evenly((a + b + c) / 3) } else { Lit::Partly }
    }

    fn by_cells(&self, at: &[[f32; 3]; 3], body: u16) -> Lit {
        let [columns, rows] = shadow_size();
        let range = |axis: usize, count: usize| {
            let [low, high] = [f32::min, f32::max].map(|of| of(of(at[0][axis], at[1][axis]), at[2][axis]));
            let from = (low - 1.5).max(0.0) as usize;
            let to = ((high + 2.5).max(0.0) as usize).min(count);
            from.min(to)..to
        };
        let (across, down) = (range(0, columns), range(1, rows));
        if across.is_empty() || down.is_empty() {
            return Lit::Evenly(FULLY);
        }
        let height = plane(at);
        let low = at[0][2].min(at[1][2]).min(at[2][2]);
        let (mut any_lit, mut any_dark) = (false, false);
        for row in down {
            for cells in Occluders::of_tiles(across.clone()) {
                if self.occluders.are_clear([cells.start; 2], [row; 2], low, body) {
                    any_lit = true;
                } else {
                    for column in cells {
                        let height = height(column as f32 + 0.5, row as f32 + 0.5);
                        let dark = self.occluders.covers(row * columns + column, height, body);
                        any_dark |= dark;
                        any_lit |= !dark;
                    }
                }
                if any_lit && any_dark {
                    return Lit::Partly;
                }
            }
        }
        Lit::Evenly(if any_dark { 0 } else { FULLY })
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
        if self.occluders.are_clear([column, column + 3], [row, row + 3], height, body) {
            return FULLY;
        }
        let weights = |share: u32| [256 - share, 256, 256, share];
        let mut dark = 0;
        for (line, weight) in weights(down).into_iter().enumerate() {
            let cells = (row + line) * columns + column..;
            let covered = cells
                .zip(weights(across))
                .map(|(cell, weight)| u32::from(self.occluders.covers(cell, height, body)) * weight);
            dark += weight * covered.sum::<u32>();
        }
        // Nine cells of 256 times 256.
        FULLY - dark / (9 * 256)
    }
}
