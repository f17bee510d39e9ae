//! How much of the lamp's light reaches a place on a body.

use super::map::shadow_size;
use super::occluder::{Corner, Occluder, along_light, plane};
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
            let occluders = self.occluders[row * columns..][across.clone()].iter().zip(across.start..);
            let covers = |(occluder, column): (&Occluder, usize)| {
                usize::from(occluder.covers(height(column as f32 + 0.5, row as f32 + 0.5), body))
            };
            covered += occluders.map(covers).sum::<usize>();
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
            let occluders = &self.occluders[(row + line) * columns + column..][..4];
            let covered =
                occluders.iter().zip(weights(across)).filter(|(occluder, _)| occluder.covers(height, body));
            dark += weight * covered.map(|(_, weight)| weight).sum::<u32>();
        }
        // Nine cells of 256 times 256.
        FULLY - dark / (9 * 256)
    }
}
