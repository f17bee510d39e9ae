//! Parts as simple solids: the one description from which collision geometry, overlap tests and drawings come.
//!
//! Every flat of the printed parts is a box, so boxes keep each clearance exactly; a plate with a peg hole stays
//! one [`Shape::Plate`], which whoever needs contact turns into boxes around the circle.

use crate::beam::Beam;
use crate::joint::{
    BODY_WIDTH, EXTRUSION, FEMALE_HEIGHT, HEAD_HEIGHT, HEAD_WIDTH, JointType, MALE_CHAMFER, MALE_TIP, WALL,
};

/// An axis-parallel box, metres, in the frame of its part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    /// The corner with the smallest coordinates.
    pub min: [f64; 3],
    /// The corner with the largest coordinates.
    pub max: [f64; 3],
}

impl Cuboid {
    /// A box from the ranges of its three coordinates, m; each range in either order.
    pub fn new(x: [f64; 2], y: [f64; 2], z: [f64; 2]) -> Cuboid {
        let low = |r: [f64; 2]| r[0].min(r[1]);
        let high = |r: [f64; 2]| r[0].max(r[1]);
        Cuboid { min: [low(x), low(y), low(z)], max: [high(x), high(y), high(z)] }
    }

    /// Its centre, m.
    pub fn centre(&self) -> [f64; 3] {
        std::array::from_fn(|axis| 0.5 * (self.min[axis] + self.max[axis]))
    }

    /// Half its edges, m.
    pub fn half(&self) -> [f64; 3] {
        std::array::from_fn(|axis| 0.5 * (self.max[axis] - self.min[axis]))
    }
}

/// A solid of a part, metres, in the part's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A plain box of printed plastic or aluminium.
    Solid(Cuboid),
    /// A box with a vertical round hole of [`crate::joint::HOLE_RADIUS`] through it, at `hole` (x, y).
    Plate {
        /// Its outside.
        cuboid: Cuboid,
        /// Where the hole's axis is, m.
        hole: [f64; 2],
    },
    /// The chamfered end of a male: a box from `x0` to the tip at `x1` (towards either end of the beam), whose
    /// face at the tip is smaller by the chamfer on all four sides.
    Nose {
        /// Where the chamfer begins, m.
        x0: f64,
        /// The tip, m.
        x1: f64,
    },
    /// The two small feet of a male end, each a box.
    Foot(Cuboid),
}

/// All solids of a beam, in its frame.
pub fn beam_shapes(beam: &Beam) -> Vec<Shape> {
    let mut shapes = Vec::new();
    let last = beam.joints.len().saturating_sub(1);
    for (index, joint) in beam.joints.iter().enumerate() {
        // Towards which end of the beam an end joint looks.
        let outward = if index == 0 && last > 0 { -1.0 } else { 1.0 };
        let opens = joint.opens.map_or(0.0, |side| side.sign());
        joint_shapes(joint.kind, joint.offset, outward, opens, &mut shapes);
    }
    for pair in beam.joints.windows(2) {
        let from = pair[0].offset + pair[0].kind.sleeve();
        let to = pair[1].offset - pair[1].kind.sleeve();
        shapes.extend(extrusion_shapes(from, to).map(Shape::Solid));
    }
    shapes
}

/// The bare extrusion between x = `from` and x = `to`, m: two flanges and the web between the side slots that the
/// fingertips' ribs enter (mouth 5.0 mm, web floor 3.65 mm from the axis).
fn extrusion_shapes(from: f64, to: f64) -> [Cuboid; 3] {
    let half = EXTRUSION / 2.0;
    let mouth = 2.5e-3;
    let web = 3.65e-3;
    [
        Cuboid::new([from, to], [-half, half], [mouth, half]),
        Cuboid::new([from, to], [-half, half], [-half, -mouth]),
        Cuboid::new([from, to], [-web, web], [-mouth, mouth]),
    ]
}

/// The solids of one joint whose hole is at x = `at`; `outward` (±1) is the direction an end joint looks in and
/// `opens` (±1) the sign of y to which a one-sided female opens.
fn joint_shapes(kind: JointType, at: f64, outward: f64, opens: f64, shapes: &mut Vec<Shape>) {
    let w = BODY_WIDTH / 2.0;
    let h = FEMALE_HEIGHT / 2.0;
    let cavity_h = h - WALL;
    // Along the beam, measured outwards from the hole.
    let x = |a: f64, b: f64| [at + outward * a, at + outward * b];
    let plate =
        |xs: [f64; 2], zs: [f64; 2]| Shape::Plate { cuboid: Cuboid::new(xs, [-w, w], zs), hole: [at, 0.0] };
    let solid = |xs: [f64; 2], ys: [f64; 2], zs: [f64; 2]| Shape::Solid(Cuboid::new(xs, ys, zs));
    match kind {
        JointType::InMEnd | JointType::InMEndFeet => {
            let begin = MALE_TIP - MALE_CHAMFER;
            shapes.push(plate(x(-8.6e-3, begin), [-w, w]));
            shapes.push(Shape::Nose { x0: at + outward * begin, x1: at + outward * MALE_TIP });
            shapes.push(solid(x(-28.6e-3, -8.6e-3), [-w, w], [-w, w]));
            // The plate that carries the tag.
            shapes.push(solid(x(-55.65e-3, -28.6e-3), [-w, w], [w - WALL, w]));
            if kind == JointType::InMEndFeet {
                for side in [-1.0, 1.0] {
                    let ys = [side * 6.3e-3, side * 9.8e-3];
                    shapes.push(Shape::Foot(Cuboid::new(x(-25.6e-3, -20.6e-3), ys, [-h, -w])));
                }
            }
        }
        JointType::ThruM => shapes.push(plate(x(-37.6e-3, 37.6e-3), [-w, w])),
        JointType::InFEnd => {
            for side in [-1.0, 1.0] {
                shapes.push(plate(x(-16.6e-3, 13.6e-3), [side * cavity_h, side * h]));
            }
            // The stop wall opposite the opening, the wall towards the beam, and the neck.
            let wall = [-opens * (w - WALL), -opens * w];
            shapes.push(solid(x(-16.6e-3, 13.6e-3), wall, [-cavity_h, cavity_h]));
            shapes.push(solid(x(-16.6e-3, -13.6e-3), [-w, w], [-cavity_h, cavity_h]));
            shapes.push(solid(x(-43.2e-3, -16.6e-3), [-w, w], [-w, w]));
        }
        JointType::InF | JointType::ThruF | JointType::AngleF => {
            let cavity = if kind == JointType::AngleF { 29.0e-3 } else { 13.6e-3 };
            let head = cavity + WALL;
            for side in [-1.0, 1.0] {
                shapes.push(plate([at - head, at + head], [side * cavity_h, side * h]));
                let (inner, outer) = (at + side * cavity, at + side * head);
                shapes.push(solid([inner, outer], [-w, w], [-cavity_h, cavity_h]));
                shapes.push(solid([outer, at + side * kind.sleeve()], [-w, w], [-w, w]));
            }
            if kind == JointType::InF {
                let wall = [-opens * (w - WALL), -opens * w];
                shapes.push(solid([at - cavity, at + cavity], wall, [-cavity_h, cavity_h]));
            }
        }
    }
}

/// The head of a peg in the peg's frame (origin at the centre of the head's underside, +z up).
pub fn peg_head() -> Cuboid {
    let w = HEAD_WIDTH / 2.0;
    Cuboid::new([-w, w], [-w, w], [0.0, HEAD_HEIGHT])
}
