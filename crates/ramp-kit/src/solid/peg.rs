//! The peg, and the holder in which three of them start.

use super::body::{MM, PAST, Solid, SolidError, arc, ball};
use crate::beam::Holder;
use crate::dimensions::{Dimensions, HEAD_HEIGHT, HEAD_WIDTH, STEM_CONE, STEM_RADIUS, STEM_TIP_RADIUS};
use std::f64::consts::PI;

/// A peg; z = 0 is the underside of its head, the stem points down.
///
/// # Errors
/// None for the benchmark's dimensions.
pub fn peg(dimensions: &Dimensions) -> Result<Solid, SolidError> {
    /// Radius of the head's edges; the groove around the tag's pad: its inside, its width and depth.
    const ROUND: f64 = 1.0;
    const PAD: f64 = 25.5;
    const GROOVE: [f64; 2] = [0.6, 0.2];
    let (half, top) = (HEAD_WIDTH * MM / 2.0 - ROUND, HEAD_HEIGHT * MM - ROUND);
    let mut corners = Vec::new();
    for x in [-half, half] {
        for y in [-half, half] {
            for z in [ROUND, top] {
                corners.extend(ball([x, y, z], ROUND));
            }
        }
    }
    let head = Solid::hull(&corners);
    let (top, [width, depth]) = (HEAD_HEIGHT * MM, GROOVE);
    let square = |half: f64| Solid::cuboid([-half, half], [-half, half], [top - depth, top + PAST]);
    let groove = square(PAD / 2.0 + width).minus(&[square(PAD / 2.0)]);
    // As long as the height of a female, for any wall thickness.
    let (length, cone) = (dimensions.female_height() * MM, STEM_CONE * MM);
    let (radius, tip) = (STEM_RADIUS * MM, STEM_TIP_RADIUS * MM);
    let stem = Solid::round([0.0; 2], [radius; 2], [cone - length, 2.0]);
    let end = Solid::round([0.0; 2], [tip, radius], [-length, cone - length]);
    Solid::union(&[head.minus(&[groove]), stem, end]).checked("peg")
}

/// A holder for three pegs; the origin is the centre of its base.
///
/// # Errors
/// None for the benchmark's dimensions.
pub fn holder(dimensions: &Dimensions) -> Result<Solid, SolidError> {
    /// Half the depth of a rib at several heights; the last is inside the bar.
    const RIB: [[f64; 2]; 6] =
        [[0.0, 20.0], [3.85, 17.7], [9.9, 14.98], [17.2, 12.4], [28.2, 10.45], [36.2, 10.0]];
    const RIBS: [[f64; 2]; 4] = [[-51.5, -45.5], [-20.0, -14.0], [14.0, 20.0], [45.5, 51.5]];
    const ROUND: f64 = 1.0;
    /// Half the width of the ridge that holds the tips, the heights of its top and of the pockets'
    /// floor, and the height from which the floor between the ribs narrows into it.
    const RIDGE: f64 = 11.86;
    const TOP: f64 = 6.0;
    const FLOOR: f64 = 4.0;
    const SLAB: f64 = 3.85;
    /// Height of the bar over the ribs' last step; the countersink at its top.
    const BAR: f64 = 4.0;
    const SINK: [f64; 2] = [5.6, 1.4];
    let height = Holder::HEIGHT * MM;
    let length = Holder::BASE[0] * MM / 2.0;
    let mut solids = Vec::new();
    for [from, to] in RIBS {
        for pair in RIB.windows(2) {
            let mut points = Vec::new();
            for &[z, half] in pair {
                for (x, out_x) in [(from, -1.0), (to, 1.0)] {
                    for out_y in [-1.0, 1.0] {
                        let centre = [x - out_x * ROUND, out_y * (half - ROUND)];
                        let corner = arc([0.0; 2], ROUND, 0.0, PI / 2.0, 6);
                        points.extend(
                            corner.iter().map(|c| [centre[0] + out_x * c[0], centre[1] + out_y * c[1], z]),
                        );
                    }
                }
            }
            solids.push(Solid::hull(&points));
        }
    }
    // The bar, its upper edges round.
    let half = RIB[5][1];
    let mut points = Vec::new();
    for x in [-1.0, 1.0] {
        for y in [-1.0, 1.0] {
            points.push([x * length, y * half, height - BAR]);
            points.extend(ball([x * (length - ROUND), y * (half - ROUND), height - ROUND], ROUND));
        }
    }
    solids.push(Solid::hull(&points));
    let inner = length - 1.0;
    let slab =
        |z: f64, half: f64| [[-inner, -half, z], [inner, -half, z], [inner, half, z], [-inner, half, z]];
    solids.push(Solid::hull(&[slab(0.0, RIB[0][1]), slab(SLAB, RIB[1][1])].concat()));
    solids.push(Solid::cuboid([-inner, inner], [-RIDGE, RIDGE], [SLAB - 1.0, TOP]));
    let mut cuts = Vec::new();
    let radius = dimensions.peg_hole * MM / 2.0;
    for slot in [-1.0, 0.0, 1.0] {
        let at = [slot * Holder::PITCH * MM, 0.0];
        cuts.push(Solid::round(at, [radius; 2], [height - BAR - PAST, height + PAST]));
        let slope = (SINK[0] - radius) / SINK[1] * PAST;
        cuts.push(Solid::round(at, [radius, SINK[0] + slope], [height - SINK[1], height + PAST]));
        cuts.push(Solid::round(at, [radius; 2], [FLOOR, TOP + PAST]));
    }
    Solid::union(&solids).minus(&cuts).checked("holder")
}
