//! A beam as solids: its joints in place, and the pieces of extrusion between them.

use super::body::{CIRCLE, MM, Solid, SolidError, arc};
use super::joint::joint;
use crate::beam::Beam;
use crate::dimensions::Dimensions;
use std::f64::consts::PI;

/// A part of a beam in place.
#[derive(Clone)]
pub struct Piece {
    /// The name of the joint or link.
    pub name: String,
    /// The part, mm, in the beam's frame: origin on the axis at the first hole, x along the beam, z up.
    pub solid: Solid,
    /// Whether it is a piece of extrusion.
    pub link: bool,
}

/// The parts of a beam in their order along it, each moved by `apart` (mm) from the one before.
///
/// # Errors
/// As [`joint`].
pub fn beam(beam: &Beam, dimensions: &Dimensions, apart: f64) -> Result<Vec<Piece>, SolidError> {
    let mut pieces = Vec::new();
    for (index, part) in beam.joints.iter().enumerate() {
        let form = part.kind.form();
        let height = if form.male { dimensions.body() } else { dimensions.female_height() };
        let axis = height * MM / 2.0;
        let solid = joint(part.kind, dimensions)?.translated([0.0, 0.0, -axis]);
        // An end faces out of its beam; a middle joint is rotated so that it opens to its side. A
        // female end that opens to the other side is rotated about the beam, which does not change
        // its look.
        let open = part.opens.map_or(1.0, |side| -side.sign());
        let (turn, over) = match (form.end, index == 0) {
            (true, true) => (90.0, open < 0.0),
            (true, false) => (-90.0, open > 0.0),
            (false, _) => (-90.0 * open, false),
        };
        let solid = solid.rotated([0.0, 0.0, turn]);
        let solid = if over && form.one_sided { solid.rotated([180.0, 0.0, 0.0]) } else { solid };
        let shift = 2.0 * apart * index as f64;
        let solid = solid.translated([part.offset * MM + shift, 0.0, 0.0]);
        pieces.push(Piece { name: part.name.clone(), solid, link: false });
        let Some(link) = beam.links.get(index) else { continue };
        let from = (part.offset + form.socket_offset) * MM + shift + apart;
        let solid = extrusion(link.length * MM)?.rotated([0.0, 90.0, 0.0]).translated([from, 0.0, 0.0]);
        pieces.push(Piece { name: link.name.clone(), solid, link: true });
    }
    Ok(pieces)
}

/// A piece of extrusion along z, mm: a 20 × 20 profile with four slots.
///
/// # Errors
/// Zero length.
pub fn extrusion(length: f64) -> Result<Solid, SolidError> {
    Solid::extrude(&profile(), length).checked("extrusion")
}

/// The section of the extrusion: its outline and its bore, mm.
pub fn profile() -> Vec<Vec<[f64; 2]>> {
    /// Half the edge, the corners' radius, half the slot's mouth, thickness of its lips, half its
    /// width behind them, depth before it narrows, half the web.
    const HALF: f64 = 10.0;
    const CORNER: f64 = 2.0;
    const MOUTH: f64 = 2.5;
    const LIP: f64 = 1.8;
    const UNDERCUT: f64 = 5.75;
    const STRAIGHT: f64 = 1.11;
    const WEB: f64 = 3.65;
    const BORE: f64 = 2.15;
    // One quarter: the corner at (+, +) and the slot that follows it on the +y side, anticlockwise.
    let floor = UNDERCUT - (HALF - LIP - STRAIGHT - WEB);
    let mut quarter: Vec<[f64; 2]> = arc([HALF - CORNER; 2], CORNER, 0.0, PI / 2.0, 8);
    quarter.extend([
        [MOUTH, HALF],
        [MOUTH, HALF - LIP],
        [UNDERCUT, HALF - LIP],
        [UNDERCUT, HALF - LIP - STRAIGHT],
        [floor, WEB],
        [-floor, WEB],
        [-UNDERCUT, HALF - LIP - STRAIGHT],
        [-UNDERCUT, HALF - LIP],
        [-MOUTH, HALF - LIP],
        [-MOUTH, HALF],
    ]);
    let turned = |turns: i32| {
        quarter.iter().map(move |&[x, y]| match turns {
            0 => [x, y],
            1 => [-y, x],
            2 => [-x, -y],
            _ => [y, -x],
        })
    };
    let outline = (0..4).flat_map(turned).collect();
    let mut bore = arc([0.0; 2], BORE, 0.0, 2.0 * PI, CIRCLE);
    bore.pop();
    bore.reverse();
    vec![outline, bore]
}
