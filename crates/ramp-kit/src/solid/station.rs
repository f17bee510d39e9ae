//! The printed parts around the kit: the fingertips of the gripper, and the clamp of the fixed beam.

use super::body::{MM, PAST, Solid, SolidError};
use crate::dimensions::Dimensions;
use std::f64::consts::PI;

/// A fingertip: x across the finger, y along the closing direction, z up to the hand; the origin is
/// the tip frame's, between the two fingertips.
///
/// # Errors
/// None.
pub fn fingertip() -> Result<Solid, SolidError> {
    /// The plate, the rib that enters the slot of an extrusion, and the block that holds a peg's head.
    const HALF: f64 = 10.0;
    const PLATE: [f64; 2] = [-19.0, 21.0];
    const THICK: f64 = 10.0;
    const RIB: [f64; 2] = [-18.5, -15.5];
    const RIB_REACH: f64 = 14.0;
    const BLOCK: [f64; 2] = [-6.2, 6.8];
    const BLOCK_REACH: f64 = 19.0;
    /// The screw: its height, its radius, the nut across flats and how deep it sits, the boss around it.
    const SCREW_Z: f64 = 10.0;
    const SCREW_R: f64 = 2.1;
    const NUT: f64 = 5.66;
    const NUT_DEPTH: f64 = 3.2;
    const BOSS: [f64; 2] = [2.95, 1.5];
    let prism = |section: &[[f64; 2]]| {
        // Drawn as (y, z), extruded along x.
        let points: Vec<[f64; 3]> =
            section.iter().flat_map(|&[y, z]| [[-HALF, y, z], [HALF, y, z]]).collect();
        Solid::hull(&points)
    };
    // The plate's front edges are broken by 1.5, its lower ones by 0.5.
    let outline = [
        [-HALF, 0.0],
        [HALF, 0.0],
        [HALF, THICK - 1.5],
        [HALF - 1.5, THICK],
        [1.5 - HALF, THICK],
        [-HALF, THICK - 1.5],
    ];
    let shrunk = outline.map(|[x, y]| [x - x.signum() * 0.5, y.clamp(0.5, THICK - 0.5)]);
    let ring = |outline: &[[f64; 2]], z: f64| outline.iter().map(|&[x, y]| [x, y, z]).collect::<Vec<_>>();
    let plate = Solid::hull(
        &[ring(&shrunk, PLATE[0]), ring(&outline, PLATE[0] + 0.5), ring(&outline, PLATE[1])].concat(),
    );
    let nose = (RIB[1] - RIB[0]) / 2.0;
    let rib = prism(&[
        [THICK - 3.0, RIB[0]],
        [RIB_REACH - nose, RIB[0]],
        [RIB_REACH, RIB[0] + nose],
        [RIB_REACH - nose, RIB[1]],
        [THICK - 3.0, RIB[1]],
    ]);
    let block = prism(&[
        [THICK - 3.0, BLOCK[0]],
        [BLOCK_REACH - 1.2, BLOCK[0]],
        [BLOCK_REACH, BLOCK[0] + 1.2],
        [BLOCK_REACH, BLOCK[1] - 1.2],
        [BLOCK_REACH - 1.2, BLOCK[1]],
        [THICK - 3.0, BLOCK[1]],
    ]);
    // Drawn along z and rotated, so that z becomes y.
    let lay = |solid: Solid| solid.rotated([-90.0, 0.0, 0.0]).translated([0.0, 0.0, SCREW_Z]);
    let boss = lay(Solid::round([0.0; 2], [BOSS[0]; 2], [-BOSS[1], 0.5]));
    let bolt = lay(Solid::round([0.0; 2], [SCREW_R; 2], [-BOSS[1] - PAST, THICK + PAST]));
    let corner = NUT / 3f64.sqrt();
    let hexagon: Vec<[f64; 2]> =
        (0..6).map(|k| (PI / 3.0 * f64::from(k)).sin_cos()).map(|(s, c)| [corner * c, corner * s]).collect();
    let nut = Solid::extrude(&[hexagon], NUT_DEPTH + PAST).translated([0.0, 0.0, THICK - NUT_DEPTH]);
    Solid::union(&[plate, rib, block, boss]).minus(&[bolt, lay(nut)]).checked("fingertip")
}

/// The clamp that holds the fixed beam on the table: a trough for its extrusion, y along the beam,
/// z = 0 on the table, four holes down into the table and two for screws into the extrusion's
/// slots.
///
/// # Errors
/// Dimensions that leave no wall beside the extrusion.
pub fn clamp(dimensions: &Dimensions) -> Result<Solid, SolidError> {
    const LENGTH: f64 = 80.0;
    const WIDTH: f64 = 30.0;
    const HEIGHT: f64 = 26.85;
    /// Height of the feet, and thickness of the walls beside the extrusion.
    const FOOT: f64 = 6.0;
    const SIDE: f64 = 9.0;
    const TABLE_SCREW: f64 = 2.75;
    const SLOT_SCREW: f64 = 2.6;
    let socket = dimensions.socket() * MM / 2.0;
    let axis = dimensions.female_height() * MM / 2.0;
    let (x, y) = (LENGTH / 2.0, WIDTH / 2.0);
    let wall = socket + SIDE;
    let foot = Solid::cuboid([-x, x], [-y, y], [0.0, FOOT]);
    let trough = Solid::cuboid([-wall, wall], [-y, y], [0.0, HEIGHT]);
    let mut cuts =
        vec![Solid::cuboid([-socket, socket], [-y - PAST, y + PAST], [axis - socket, HEIGHT + PAST])];
    for side in [-1.0, 1.0] {
        for along in [-1.0, 1.0] {
            let at = [side * (wall + x) / 2.0, along * 8.5];
            cuts.push(Solid::round(at, [TABLE_SCREW; 2], [-PAST, FOOT + PAST]));
        }
    }
    let screw = Solid::round([0.0; 2], [SLOT_SCREW; 2], [-x, x]).rotated([0.0, 90.0, 0.0]);
    cuts.push(screw.translated([0.0, 0.0, axis]));
    Solid::union(&[foot, trough]).minus(&cuts).checked("clamp")
}
