//! A large page as tiles at true scale, for printers of small paper: neighbours overlap, and marks in the
//! overlap show how they join.

use crate::drawing::{BLACK, Drawing, GREY, Pen, RED};
use crate::strokes::Align;

/// Margin of the paper that no printer needs, mm.
const MARGIN: f64 = 12.0;
/// Width of the strip that two neighbours share, mm.
const OVERLAP: f64 = 10.0;
/// Half the length of the arms of a mark, mm.
const ARM: f64 = 4.0;

/// The tiles of a page on standing paper of this size (mm), row by row.
pub fn tiles(page: &Drawing, paper: [f64; 2]) -> Vec<Drawing> {
    let room = paper.map(|edge| edge - 2.0 * MARGIN);
    let axis = |axis: usize| Axis::new(page.size[axis], room[axis]);
    let (columns, rows) = (axis(0), axis(1));
    let marks = marks(&columns, &rows);
    let mut tiles = Vec::new();
    for row in 0..rows.count {
        for column in 0..columns.count {
            let place =
                format!("row {} of {}, column {} of {}", row + 1, rows.count, column + 1, columns.count);
            let mut tile = Drawing::new(&format!("{}, {place}", page.title), paper);
            let from = [columns.begin(column), rows.begin(row)];
            let size = [columns.length, rows.length];
            let at = [0, 1].map(|axis| (paper[axis] - size[axis]) / 2.0);
            tile.inset(page, from, size, at);
            let joins = [column > 0, row > 0, column + 1 < columns.count, row + 1 < rows.count];
            frame(&mut tile, at, size, joins);
            for mark in &marks {
                let [x, y] = [0, 1].map(|axis| mark[axis] - from[axis]);
                if (0.0..=size[0]).contains(&x) && (0.0..=size[1]).contains(&y) {
                    let [x, y] = [x + at[0], y + at[1]];
                    let pen = Pen::new(RED, 0.2);
                    tile.line(&[[x - ARM, y], [x + ARM, y]], pen);
                    tile.line(&[[x, y - ARM], [x, y + ARM]], pen);
                    tile.circle([x, y], ARM / 2.0, None, Some(pen));
                }
            }
            let below = at[1] + size[1];
            tile.text([at[0], at[1] - 3.0], Align::Left, 2.6, BLACK, &format!("{}: {place}", page.title));
            let words = "Cut along the dashed lines; lay red marks on red marks. Printed at 100 %, the line is 100 mm.";
            tile.text([at[0], below + 4.0], Align::Left, 2.0, GREY, words);
            let y = below + 7.0;
            for x in [0.0, 100.0] {
                tile.line(&[[at[0] + x, y - 1.5], [at[0] + x, y + 1.5]], Pen::new(BLACK, 0.2));
            }
            tile.line(&[[at[0], y], [at[0] + 100.0, y]], Pen::new(BLACK, 0.2));
            tiles.push(tile);
        }
    }
    tiles
}

/// The division of one direction of the page.
struct Axis {
    count: usize,
    /// Length of each tile, mm.
    length: f64,
}

impl Axis {
    /// As few tiles as `room` allows, all of one length.
    fn new(whole: f64, room: f64) -> Axis {
        let count = ((whole - OVERLAP) / (room - OVERLAP)).ceil().max(1.0);
        Axis { count: count as usize, length: (whole + (count - 1.0) * OVERLAP) / count }
    }

    /// Where a tile begins, mm.
    fn begin(&self, index: usize) -> f64 {
        index as f64 * (self.length - OVERLAP)
    }

    /// The middles of the overlaps, mm.
    fn seams(&self) -> impl Iterator<Item = f64> {
        (1..self.count).map(|index| self.begin(index) + OVERLAP / 2.0)
    }

    /// Two places along each tile, outside the overlaps, mm.
    fn along(&self) -> impl Iterator<Item = f64> {
        (0..self.count).flat_map(|index| [0.25, 0.75].map(|part| self.begin(index) + part * self.length))
    }
}

/// The marks, in the page: two on each edge that tiles share.
fn marks(columns: &Axis, rows: &Axis) -> Vec<[f64; 2]> {
    let upright = columns.seams().flat_map(|x| rows.along().map(move |y| [x, y]));
    let level = rows.seams().flat_map(|y| columns.along().map(move |x| [x, y]));
    upright.chain(level).collect()
}

/// The edges of a tile: dashed where it is cut and lies on its neighbour to the left or above, plain
/// elsewhere.
fn frame(tile: &mut Drawing, [x, y]: [f64; 2], [width, height]: [f64; 2], joins: [bool; 4]) {
    let (right, bottom) = (x + width, y + height);
    let edges = [
        [[x, y], [x, bottom]],
        [[x, y], [right, y]],
        [[right, y], [right, bottom]],
        [[x, bottom], [right, bottom]],
    ];
    for (index, (edge, joins)) in edges.iter().zip(joins).enumerate() {
        let pen = if joins && index < 2 { Pen::dashed(BLACK, 0.2, 2.0) } else { Pen::new(GREY, 0.1) };
        tile.line(edge, pen);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::A4;

    #[test]
    fn each_mark_is_on_two_tiles_or_more() {
        let room = A4.map(|edge| edge - 2.0 * MARGIN);
        let (columns, rows) = (Axis::new(594.0, room[0]), Axis::new(420.0, room[1]));
        let holds = |axis: &Axis, at: f64| {
            let on = |index: &usize| (ARM..=axis.length - ARM).contains(&(at - axis.begin(*index)));
            (0..axis.count).filter(on).count()
        };
        let marks = marks(&columns, &rows);
        assert_eq!(marks.len(), 3 * 4 + 8);
        for [x, y] in marks {
            assert_eq!(holds(&columns, x) * holds(&rows, y), 2, "{x} {y}");
        }
        assert_eq!(columns.begin(columns.count - 1) + columns.length, 594.0);
    }
}
