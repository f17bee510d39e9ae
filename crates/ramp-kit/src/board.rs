//! The calibration sheet: all tags of the family in one grid, on a page of A4 or Letter.
//!
//! Its frame K has its origin in the middle of the grid, x to the right and y to the top of the
//! page as printed, z out of the paper.

use crate::pose::Pose;
use crate::tags::{self, TagPlace};

/// Columns of the grid.
pub const COLUMNS: usize = 7;
/// Rows of the grid.
pub const ROWS: usize = tags::COUNT as usize / COLUMNS;
/// Length of the black edge of a tag, m.
pub const EDGE: f64 = 27.0e-3;
/// Distance between the middles of neighbouring tags, m: the white between them is more than two
/// cells wide, so that each has the white ring that detectors want.
pub const PITCH: f64 = 36.0e-3;

/// The tags in place on the sheet: ids from 0 on, row by row from the upper left.
///
/// ```
/// let places = ramp_kit::board::places();
/// assert_eq!(places.len(), 35);
/// // The first is the upper left one, the middle one lies at the origin.
/// assert!((places[0].x_pg.translation.x + 0.108).abs() < 1e-12);
/// assert!((places[0].x_pg.translation.y - 0.072).abs() < 1e-12);
/// assert!(places[17].x_pg.translation.vector.norm() < 1e-12);
/// ```
pub fn places() -> Vec<TagPlace> {
    let place = |id: u32| {
        let (row, column) = (id as usize / COLUMNS, id as usize % COLUMNS);
        let x = column as f64 - (COLUMNS - 1) as f64 / 2.0;
        let y = (ROWS - 1) as f64 / 2.0 - row as f64;
        let x_pg = Pose::translation(PITCH * x, PITCH * y, 0.0);
        TagPlace { id, part: "calibration sheet".to_string(), x_pg, edge: EDGE }
    };
    (0..tags::COUNT).map(place).collect()
}
