//! Parts as simple solids: the single source of collision geometry, overlap tests and drawings.
//!
//! Every flat of the printed parts is a box, so boxes keep each clearance exactly. A plate with a
//! peg hole stays one [`Shape::Plate`]; users that need contacts split it into boxes around the
//! circle.

use crate::beam::{Beam, Joint};
use crate::dimensions::{
    BODY_WIDTH, EXTRUSION, FEET, FEMALE_HEIGHT, HEAD_HEIGHT, HEAD_WIDTH, MALE_CHAMFER, MALE_TIP, TAG_PLATE,
    WALL,
};
use crate::joint::JointType;

pub use crate::cuboid::Cuboid;

/// A solid of a part, metres, in the part's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A plain box of printed plastic or aluminium.
    Solid(Cuboid),
    /// A box with a vertical round hole of [`crate::dimensions::HOLE_RADIUS`] through it, at `hole` (x, y).
    Plate {
        /// Its outside.
        cuboid: Cuboid,
        /// Position of the hole's axis, m.
        hole: [f64; 2],
    },
    /// The chamfered end of a male: a box from `x0` to the tip at `x1` (towards either end of the
    /// beam), whose tip face is smaller by the chamfer on all four sides.
    Nose {
        /// Start of the chamfer, m.
        x0: f64,
        /// The tip, m.
        x1: f64,
    },
    /// The two small feet of a male end, each a box.
    Foot(Cuboid),
    /// A piece of a male end that is rotated against its beam.
    Turned {
        /// Position of the joint's hole along the beam, m: the rotation axis.
        about: f64,
        /// The angle, rad, counted from the beam's +x towards +y.
        angle: f64,
        /// The piece before the rotation, with its hole at the origin.
        piece: Piece,
    },
}

/// The shapes that can be rotated, see [`Shape::Turned`]; as the shapes of these names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Piece {
    /// A plain box.
    Solid(Cuboid),
    /// A box with a hole along z through the origin.
    Plate(Cuboid),
    /// The chamfered tip, towards +x or −x.
    Nose {
        /// Start of the chamfer, m.
        x0: f64,
        /// The tip, m.
        x1: f64,
    },
}

impl Piece {
    /// Bounding box before the rotation. The chamfer of a tip is filled.
    pub fn bounds(&self) -> Cuboid {
        match *self {
            Piece::Solid(cuboid) | Piece::Plate(cuboid) => cuboid,
            Piece::Nose { x0, x1 } => nose_bounds(x0, x1),
        }
    }
}

fn nose_bounds(x0: f64, x1: f64) -> Cuboid {
    let half = BODY_WIDTH / 2.0;
    Cuboid::new([x0, x1], [-half, half], [-half, half])
}

impl Shape {
    /// Bounding box along the beam's axes. The chamfer of a tip is filled.
    pub fn bounds(&self) -> Cuboid {
        match *self {
            Shape::Solid(cuboid) | Shape::Foot(cuboid) | Shape::Plate { cuboid, .. } => cuboid,
            Shape::Nose { x0, x1 } => nose_bounds(x0, x1),
            Shape::Turned { about, angle, piece } => {
                let (cuboid, (sin, cos)) = (piece.bounds(), angle.sin_cos());
                let ([x, y, _], [dx, dy, _]) = (cuboid.centre(), cuboid.half());
                let (cx, cy) = (about + x * cos - y * sin, x * sin + y * cos);
                let (rx, ry) = (dx * cos.abs() + dy * sin.abs(), dx * sin.abs() + dy * cos.abs());
                let z = [cuboid.min[2], cuboid.max[2]];
                Cuboid::new([cx - rx, cx + rx], [cy - ry, cy + ry], z)
            }
        }
    }
}

/// All solids of a beam, in its frame.
pub fn beam_shapes(beam: &Beam) -> Vec<Shape> {
    let mut shapes = Vec::new();
    let last = beam.joints.len().saturating_sub(1);
    for (index, joint) in beam.joints.iter().enumerate() {
        // Outward direction of an end joint along the beam.
        let outward = if index == 0 && last > 0 { -1.0 } else { 1.0 };
        joint_at(joint, outward, &mut shapes);
    }
    for pair in beam.joints.windows(2) {
        let from = pair[0].offset + pair[0].kind.sleeve();
        let to = pair[1].offset - pair[1].kind.sleeve();
        shapes.extend(extrusion_shapes(from, to).map(Shape::Solid));
    }
    shapes
}

/// The bare extrusion between x = `from` and x = `to`, m: two flanges and the web between the side
/// slots, into which the fingertips' ribs fit (mouth 5.0 mm, web floor 3.65 mm from the axis).
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

/// The solids of a joint in its position on its beam; `outward` (±1) is the outward direction of an
/// end joint along the beam.
pub fn joint_at(joint: &Joint, outward: f64, shapes: &mut Vec<Shape>) {
    joint_shapes(joint.kind, joint.offset, outward, joint.opens.map_or(0.0, |side| side.sign()), shapes);
}

/// The solids of one joint whose hole is at x = `at`. `outward` (±1) is the outward direction of an
/// end joint and `opens` (±1) the sign of y to which a one-sided female opens.
fn joint_shapes(kind: JointType, at: f64, outward: f64, opens: f64, shapes: &mut Vec<Shape>) {
    let form = kind.form();
    let w = BODY_WIDTH / 2.0;
    let h = FEMALE_HEIGHT / 2.0;
    let cavity_h = h - WALL;
    // Along the beam, measured outwards from the hole.
    let x = |a: f64, b: f64| [at + outward * a, at + outward * b];
    let plate =
        |xs: [f64; 2], zs: [f64; 2]| Shape::Plate { cuboid: Cuboid::new(xs, [-w, w], zs), hole: [at, 0.0] };
    let solid = |xs: [f64; 2], ys: [f64; 2], zs: [f64; 2]| Shape::Solid(Cuboid::new(xs, ys, zs));
    let (socket, sleeve) = (form.socket_offset, kind.sleeve());
    if form.male && !form.end {
        return shapes.push(plate(x(-sleeve, sleeve), [-w, w]));
    }
    if form.male {
        let begin = MALE_TIP - MALE_CHAMFER;
        if form.turn == 0.0 {
            shapes.push(plate(x(-socket, begin), [-w, w]));
            shapes.push(Shape::Nose { x0: at + outward * begin, x1: at + outward * MALE_TIP });
            shapes.push(solid(x(-sleeve, -socket), [-w, w], [-w, w]));
        } else {
            turned_male(kind, at, outward, shapes);
        }
        // The plate that carries the tag.
        shapes.push(solid(x(-sleeve - TAG_PLATE, -sleeve), [-w, w], [w - WALL, w]));
        if form.feet {
            let [across, along] = FEET;
            for side in [-1.0, 1.0] {
                let ys = across.map(|y| side * y);
                shapes.push(Shape::Foot(Cuboid::new(x(along[0], along[1]), ys, [-h, -w])));
            }
        }
        return;
    }
    let cavity = form.cavity;
    let head = cavity + WALL;
    // The stop wall opposite the opening.
    let wall = [-opens * (w - WALL), -opens * w];
    if form.end {
        for side in [-1.0, 1.0] {
            shapes.push(plate(x(-head, cavity), [side * cavity_h, side * h]));
        }
        // The stop wall, the wall towards the beam, and the neck.
        if form.one_sided {
            shapes.push(solid(x(-head, cavity), wall, [-cavity_h, cavity_h]));
        }
        shapes.push(solid(x(-head, -cavity), [-w, w], [-cavity_h, cavity_h]));
        shapes.push(solid(x(-sleeve, -head), [-w, w], [-w, w]));
        return;
    }
    for side in [-1.0, 1.0] {
        shapes.push(plate([at - head, at + head], [side * cavity_h, side * h]));
        let (inner, outer) = (at + side * cavity, at + side * head);
        shapes.push(solid([inner, outer], [-w, w], [-cavity_h, cavity_h]));
        shapes.push(solid([outer, at + side * sleeve], [-w, w], [-w, w]));
    }
    if form.one_sided {
        shapes.push(solid([at - cavity, at + cavity], wall, [-cavity_h, cavity_h]));
    }
}

/// A male end whose tip is bent away from its beam: consecutive sections around the bend.
fn turned_male(kind: JointType, at: f64, outward: f64, shapes: &mut Vec<Shape>) {
    let w = BODY_WIDTH / 2.0;
    for section in kind.form().sections() {
        // A rotation of the joint for the other end of the beam keeps left on the left.
        let round = |[a, b]: [f64; 2]| [outward * a, outward * b];
        let [from, to] = section.along;
        let cuboid = |to: f64| Cuboid::new(round([from, to]), round(section.across), [-w, w]);
        let mut push = |piece| shapes.push(Shape::Turned { about: at, angle: section.turn, piece });
        if to < MALE_TIP {
            push(Piece::Solid(cuboid(to)));
            continue;
        }
        let begin = MALE_TIP - MALE_CHAMFER;
        push(Piece::Plate(cuboid(begin)));
        push(Piece::Nose { x0: outward * begin, x1: outward * MALE_TIP });
    }
}

/// Boxes that together are the outside of a beam where it rests on the table, one per joint that
/// rests; a joint with feet rests on them instead.
pub fn beam_rests(beam: &Beam) -> Vec<Cuboid> {
    let w = BODY_WIDTH / 2.0;
    let h = FEMALE_HEIGHT / 2.0;
    let rest = |(index, joint): (usize, &Joint)| {
        let form = joint.kind.form();
        let outward = if index == 0 { -1.0 } else { 1.0 };
        let x = |a: f64, b: f64| [joint.offset + outward * a, joint.offset + outward * b];
        let (sleeve, head) = (joint.kind.sleeve(), form.cavity + WALL);
        match (form.male, form.end) {
            (true, _) if form.feet => None,
            (true, true) if form.turn != 0.0 => {
                Some(Cuboid::new(x(-sleeve, -form.socket_offset), [-w, w], [-w, w]))
            }
            (true, true) => Some(Cuboid::new(x(-sleeve, MALE_TIP), [-w, w], [-w, w])),
            (true, false) => Some(Cuboid::new(x(-sleeve, sleeve), [-w, w], [-w, w])),
            (false, true) => Some(Cuboid::new(x(-head, form.cavity), [-w, w], [-h, h])),
            (false, false) => Some(Cuboid::new(x(-head, head), [-w, w], [-h, h])),
        }
    };
    beam.joints.iter().enumerate().filter_map(rest).collect()
}

/// The head of a peg in the peg's frame (origin at the centre of the head's underside, +z up).
pub fn peg_head() -> Cuboid {
    let w = HEAD_WIDTH / 2.0;
    Cuboid::new([-w, w], [-w, w], [0.0, HEAD_HEIGHT])
}
