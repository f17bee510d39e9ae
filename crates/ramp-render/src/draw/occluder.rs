//! The lamp's view of bodies: what it meets first above each cell of the table's map, and where the corners
//! of a surface are in that view. Its rays are parallel.

use std::ops::Range;

use super::light::LIGHT;
use super::map::{SHADOW_SCALE, TABLE, shadow_size};

/// Least height of an occluder above a place in its shadow, m: more than the rough surfaces of parts stand
/// out.
/// No body throws a shadow on itself, since the surfaces of the arm's links are rougher.
const ABOVE: f32 = 6.0e-3;
/// The height where there is no occluder, and its body.
const NO_HEIGHT: f32 = f32::NEG_INFINITY;
const NO_BODY: u16 = u16::MAX;
/// Cells along the side of a tile.
const TILE: usize = 8;

/// The highest of the occluders of some cells, and the body to which all of them belong.
#[derive(Clone, Copy)]
struct Tile {
    /// m above the table.
    height: f32,
    /// [`NO_BODY`] where there are several or none.
    body: u16,
}

/// The bodies that the lamp's rays meet first, by cells of the map: rows of columns, [`shadow_size`].
pub(super) struct Occluders {
    /// m above the table.
    heights: Vec<f32>,
    bodies: Vec<u16>,
    /// The same for squares of cells.
    tiles: Vec<Tile>,
}

impl Occluders {
    /// None anywhere.
    pub(super) fn new() -> Occluders {
        let [columns, rows] = shadow_size();
        let tiles = columns.div_ceil(TILE) * rows.div_ceil(TILE);
        Occluders {
            heights: vec![NO_HEIGHT; columns * rows],
            bodies: vec![NO_BODY; columns * rows],
            tiles: vec![Tile { height: NO_HEIGHT, body: NO_BODY }; tiles],
        }
    }

    /// Takes all away.
    pub(super) fn clear(&mut self) {
        self.heights.fill(NO_HEIGHT);
        self.bodies.fill(NO_BODY);
        self.tiles.fill(Tile { height: NO_HEIGHT, body: NO_BODY });
    }

    /// Takes over a body where it is higher, in some columns of a row; `height` (m) is that in a column.
    #[inline]
    pub(super) fn raise(
        &mut self,
        row: usize,
        [from, to]: [usize; 2],
        body: u16,
        height: impl Fn(f32) -> f32,
    ) {
        let begin = row * shadow_size()[0];
        let cells = begin + from..=begin + to;
        let highest = self.heights[cells.clone()].iter_mut().zip(&mut self.bodies[cells]);
        for ((highest, owner), column) in highest.zip(from..) {
            let height = height(column as f32 + 0.5);
            if height > *highest {
                (*highest, *owner) = (height, body);
            }
        }
    }

    /// Sets the tiles, after the last body.
    pub(super) fn tile(&mut self) {
        let [columns, rows] = shadow_size();
        let across = columns.div_ceil(TILE);
        for row in 0..rows {
            let tiles = &mut self.tiles[row / TILE * across..][..across];
            let heights = self.heights[row * columns..][..columns].chunks(TILE);
            let bodies = self.bodies[row * columns..][..columns].chunks(TILE);
            for ((tile, heights), bodies) in tiles.iter_mut().zip(heights).zip(bodies) {
                let highest = heights.iter().copied().fold(NO_HEIGHT, f32::max);
                if highest == NO_HEIGHT {
                    continue;
                }
                let first = if tile.height == NO_HEIGHT { bodies[0] } else { tile.body };
                let one = bodies.iter().zip(heights).all(|(it, height)| *it == first || *height == NO_HEIGHT);
                *tile = Tile { height: tile.height.max(highest), body: if one { first } else { NO_BODY } };
            }
        }
    }

    /// Ranges of columns, each of one tile.
    pub(super) fn of_tiles(columns: Range<usize>) -> impl Iterator<Item = Range<usize>> {
        let tiles = columns.start / TILE..columns.end.div_ceil(TILE);
        tiles.map(move |tile| columns.start.max(tile * TILE)..columns.end.min((tile + 1) * TILE))
    }

    /// Is there something above each cell?
    pub(super) fn any(&self) -> impl Iterator<Item = bool> {
        self.heights.iter().map(|height| *height != NO_HEIGHT)
    }

    /// Does what the lamp meets at a cell keep its light from a place so high (m) on this body?
    #[inline]
    pub(super) fn covers(&self, cell: usize, height: f32, body: u16) -> bool {
        self.bodies[cell] != body && self.heights[cell] > height + ABOVE
    }

    /// Whether it is sure that nothing keeps the lamp's light from places at least so high (m) on this body,
    /// in ranges of columns and rows up to the last.
    #[inline]
    pub(super) fn are_clear(&self, columns: [usize; 2], rows: [usize; 2], height: f32, body: u16) -> bool {
        let across = shadow_size()[0].div_ceil(TILE);
        let [columns, rows] = [columns, rows].map(|[from, to]| from / TILE..=to / TILE);
        rows.into_iter().all(|row| {
            let tiles = &self.tiles[row * across..][columns.clone()];
            tiles.iter().all(|tile| tile.body == body || tile.height <= height + ABOVE)
        })
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
