//! Lengths and positions in the file, mm, and their valid ranges.

use super::problem::{Node, Result};
use std::ops::RangeInclusive;

/// Any length of extrusion, mm.
pub(super) const LENGTH: RangeInclusive<f64> = 1.0..=2000.0;
/// Metres in a millimetre.
pub(super) const MM: f64 = 1e-3;
/// Any position on the table, mm.
const POSITION: RangeInclusive<f64> = -5000.0..=5000.0;

/// The attributes `x` and `y`, mm in the file.
pub(super) fn point(node: Node<'_>) -> Result<[f64; 2]> {
    let number = |attribute| Ok(node.required(attribute)?.number(POSITION, "mm")? * MM);
    Ok([number("x")?, number("y")?])
}
