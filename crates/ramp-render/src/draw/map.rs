//! The map of the table: content of each cell, and its light from the lamp.

use crate::looks::Looks;

/// The table's top: x and y ranges in the world, m.
pub(super) const TABLE: [[f32; 2]; 2] = [[-0.4, 1.6], [-0.6, 0.6]];
/// Cells of the map per metre.
pub(super) const SHADOW_SCALE: f32 = 200.0;
/// Share of the light in a shadow.
const SHADOW_LEFT: f32 = 0.55;
/// Cells over which a shadow's edge is spread.
pub(super) const WIDE: u16 = 5;
/// Content of a cell: something to be drawn in detail, nothing but table, nothing but paper, the floor beside
/// the table, or, where one does not look down at all, the wall.
pub(super) const DETAIL: u8 = 0;
pub(super) const TABLE_TOP: u8 = 1;
pub(super) const PAPER: u8 = 2;
pub(super) const FLOOR: u8 = 3;
pub(super) const WALL: u8 = 4;
/// The place of a pixel that does not look down at the table.
pub(super) const ABOVE: f32 = 1e9;

/// Columns and rows of the shadow map.
pub(super) fn shadow_size() -> [usize; 2] {
    TABLE.map(|[from, to]| ((to - from) * SHADOW_SCALE).ceil() as usize)
}

/// The cells of a triangle, whichever way round it goes: gives the row of each, its first and its last.
pub(super) fn cells(corners: &[[f32; 3]; 3], mut each: impl FnMut(usize, usize, usize)) {
    let [columns, rows] = shadow_size();
    let low = corners.iter().fold(f32::INFINITY, |low, p| low.min(p[1]));
    let high = corners.iter().fold(f32::NEG_INFINITY, |high, p| high.max(p[1]));
    let first = (low - 0.5).ceil().max(0.0);
    let last = (high - 0.5).floor().min(rows as f32 - 1.0);
    if first > last {
        return;
    }
    for y in first as usize..=last as usize {
        let middle = y as f32 + 0.5;
        let (mut from, mut to) = (f32::INFINITY, f32::NEG_INFINITY);
        for edge in 0..3 {
            let (p, q) = (corners[edge], corners[(edge + 1) % 3]);
            if (p[1] <= middle) != (q[1] <= middle) {
                let x = p[0] + (q[0] - p[0]) * (middle - p[1]) / (q[1] - p[1]);
                from = from.min(x);
                to = to.max(x);
            }
        }
        let from = (from - 0.5).ceil().max(0.0);
        let to = (to - 0.5).floor().min(columns as f32 - 1.0);
        if from <= to {
            each(y, from as usize, to as usize);
        }
    }
}

/// Adds up, for each cell, those around it: [`WIDE`] along both directions.
pub(super) fn spread(sums: &mut [u16], marks: &mut [u16], columns: usize) {
    // Along rows, then along columns; what runs over an edge is not missed on a table this much larger.
    for (step, across) in [(1, true), (columns, false)] {
        let (from, to): (&mut [u16], &mut [u16]) = if across { (sums, marks) } else { (marks, sums) };
        to.fill(0);
        let reach = 2 * step;
        let inner = from.len() - 2 * reach;
        let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|index| &from[index * step..][..inner]);
        for (((((to, a), b), c), d), e) in to[reach..].iter_mut().zip(a).zip(b).zip(c).zip(d).zip(e) {
            *to = a + b + c + d + e;
        }
    }
}

/// The content of each cell of the map without shadows, as seen from nearby.
pub(super) fn bare(looks: &Looks) -> Vec<u8> {
    let [columns, rows] = shadow_size();
    let kind = |column: i64, row: i64| {
        if !(0..columns as i64).contains(&column) || !(0..rows as i64).contains(&row) {
            return DETAIL;
        }
        let x = TABLE[0][0] + (column as f32 + 0.5) / SHADOW_SCALE;
        let y = TABLE[1][0] + (row as f32 + 0.5) / SHADOW_SCALE;
        let (u, v) = (x - looks.sheet_corner[0], looks.sheet_corner[1] - y);
        let [width, height] = looks.sheet_size;
        if !(u > 0.0 && v > 0.0 && u < width && v < height) {
            TABLE_TOP
        } else if looks.sheet.is_blank([u, v], 1.0 / SHADOW_SCALE) {
            PAPER
        } else {
            DETAIL
        }
    };
    let kinds: Vec<u8> =
        (0..rows as i64).flat_map(|row| (0..columns as i64).map(move |column| kind(column, row))).collect();
    // The same for two cells all around: more than a stretch of pixels reaches.
    let same = |index: usize| {
        let (row, column) = (index / columns, index % columns);
        let inside = (2..rows - 2).contains(&row) && (2..columns - 2).contains(&column);
        let around = |row: usize| &kinds[row * columns + column - 2..row * columns + column + 3];
        inside && (row - 2..row + 3).all(|row| around(row).iter().all(|kind| *kind == kinds[index]))
    };
    (0..kinds.len()).map(|index| if same(index) { kinds[index] } else { DETAIL }).collect()
}

/// Is a place on the sheet?
#[inline]
pub(super) fn on_sheet(looks: &Looks, [x, y]: [f32; 2]) -> bool {
    let (u, v) = (x - looks.sheet_corner[0], looks.sheet_corner[1] - y);
    u > 0.0 && v > 0.0 && u < looks.sheet_size[0] && v < looks.sheet_size[1]
}

/// Content of a cell or of its neighbours.
#[inline]
pub(super) fn kind(bare: &[u8], [x, y]: [f32; 2]) -> u8 {
    let (column, row) = ((x - TABLE[0][0]) * SHADOW_SCALE, (y - TABLE[1][0]) * SHADOW_SCALE);
    let [columns, rows] = shadow_size();
    if column >= 0.0 && row >= 0.0 && column < columns as f32 && row < rows as f32 {
        bare[row as usize * columns + column as usize]
    } else if x == ABOVE {
        WALL
    } else {
        FLOOR
    }
}

/// Light that reaches a place on the table, of 256.
#[inline]
pub(super) fn shade_at(soft: &[u32], [x, y]: [f32; 2]) -> u32 {
    shade(soft, (x - TABLE[0][0]) * SHADOW_SCALE, (y - TABLE[1][0]) * SHADOW_SCALE)
}

/// Light that reaches a place on the shadow map, of 256.
#[inline]
fn shade(shadow: &[u32], column: f32, row: f32) -> u32 {
    const LOST: u32 = ((1.0 - SHADOW_LEFT) * 256.0) as u32;
    let [columns, _] = shadow_size();
    let (u, v) = ((column * 256.0) as i32 - 128, (row * 256.0) as i32 - 128);
    let from = (v >> 8).max(0) as usize * columns + (u >> 8).max(0) as usize;
    let four = shadow.get(from).copied().unwrap_or_default();
    // Most places are quite lit.
    if four == 0 {
        return 256;
    }
    let byte = |shift: u32| four >> shift & 255;
    let (fu, fv) = ((u & 255) as u32, (v & 255) as u32);
    let mix = |a: u32, b: u32| a * (256 - fu) + b * fu;
    let dark = (mix(byte(0), byte(8)) * (256 - fv) + mix(byte(16), byte(24)) * fv) >> 16;
    256 - ((dark * LOST) >> 8)
}
