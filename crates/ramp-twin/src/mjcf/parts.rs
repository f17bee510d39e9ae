//! The parts: beams, holders and pegs with their shapes and masses.

use super::print::PrintedPart;
use super::text::{box_geom, capsule_geom, hole_boxes, inertial, numbers, placed, plate_geoms, ring_boxes};
use crate::pieces::Piece;
use nalgebra::Vector3;
use ramp_kit::joint::{
    BODY_WIDTH, EXTRUSION, EXTRUSION_MASS, HEAD_HEIGHT, HEAD_ROUNDING, HEAD_WIDTH, HOLE_RADIUS, MALE_CHAMFER,
    MALE_TIP, PLA_DENSITY, SOCKET_DEPTH, STEM_CONE, STEM_LENGTH, STEM_RADIUS, STEM_TIP_RADIUS,
};
use ramp_kit::shape::{Cuboid, Piece as TurnedPiece, Shape, beam_rests, beam_shapes, peg_head};
use ramp_kit::{Beam, Holder, Pose};
use ramp_robot::arm::Capsule;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;

/// Edges of the polygon of a peg's cone.
const CONE_EDGES: usize = 24;
/// Mass of a peg in solid PLA, kg.
pub const PEG_MASS: f64 = 26.9e-3;
/// Dry friction of a holder that can be pushed over the table, N along each axis, and its mass, kg.
const HOLDER_FRICTION: f64 = 20.0;
/// See [`HOLDER_FRICTION`].
const HOLDER_MASS: f64 = 0.1;

/// The chamfered end of a male: full section at x = 0, the tip at x = +length.
pub(super) fn nose_mesh() -> String {
    let half = BODY_WIDTH / 2.0;
    let body = Cuboid::new([0.0, MALE_CHAMFER], [-half, half], [-half, half]);
    chamfered("nose", &body, [0.0, MALE_CHAMFER])
}

/// A mesh like that box, but smaller by the chamfer on all four sides at its tip: it extends from the first
/// to the second `x`, m.
fn chamfered(name: &str, body: &Cuboid, [root, tip]: [f64; 2]) -> String {
    let mut vertices = Vec::new();
    for (x, smaller) in [(root, 0.0), (tip, MALE_CHAMFER)] {
        for y in [body.min[1] + smaller, body.max[1] - smaller] {
            for z in [body.min[2] + smaller, body.max[2] - smaller] {
                vertices.extend([x, y, z]);
            }
        }
    }
    format!("<mesh name=\"{name}\" vertex=\"{}\"/>\n", numbers(&vertices))
}

/// The cone at the end of a peg's stem of that radius (m), with a short piece of the stem above it, in the
/// peg's frame.
pub(super) fn cone_mesh(name: &str, radius: f64) -> String {
    let mut vertices = Vec::new();
    let cone = STEM_LENGTH - STEM_CONE;
    for (z, r) in [(4.0e-3 - cone, radius), (-cone, radius), (-STEM_LENGTH, STEM_TIP_RADIUS)] {
        for edge in 0..CONE_EDGES {
            let angle = TAU * (edge as f64 + 0.5) / CONE_EDGES as f64;
            vertices.extend([r * angle.cos(), r * angle.sin(), z]);
        }
    }
    format!("<mesh name=\"{name}\" vertex=\"{}\"/>\n", numbers(&vertices))
}

/// A beam at its place: without a joint if it is `fixed`, else free. The [clamp](crate::clamp) moves a fixed
/// one.
pub(super) fn beam_body(xml: &mut String, beam: &Beam, x_wb: &Pose, fixed: bool, printed: &mut PrintedPart) {
    let beam = &printed.beam(beam);
    let _ = write!(xml, "<body name=\"{}\" {}>", beam.name, placed(x_wb));
    if !fixed {
        let (mass, centre, diagonal) = beam_inertia(beam);
        let _ = write!(
            xml,
            r#"<freejoint name="{}"/><inertial mass="{mass}" pos="{}" diaginertia="{}"/>"#,
            beam.name,
            numbers(&centre),
            numbers(&diagonal)
        );
    }
    // The holes and rings of each joint.
    let mut around_holes: BTreeMap<(usize, Piece), String> = BTreeMap::new();
    for shape in beam_shapes(beam) {
        let [middle, ..] = shape.bounds().centre();
        printed.go_to(beam, middle);
        let mut geoms = Geoms::default();
        shape_geoms(&mut geoms, shape, printed);
        if let Some([x, y, turn]) = printed.bent(beam, middle) {
            geoms.place(&[x, y, 0.0], turn);
        }
        xml.push_str(&geoms.solid);
        for (piece, text) in [(Piece::Hole, geoms.hole), (Piece::Ring, geoms.ring)] {
            around_holes.entry((printed.joint(), piece)).or_default().push_str(&text);
        }
    }
    // A fixed beam needs no table below.
    if !fixed {
        for rest in beam_rests(beam) {
            box_geom(xml, "rest", &rest);
        }
    }
    for ((joint, piece), geoms) in around_holes.iter().filter(|(_, geoms)| !geoms.is_empty()) {
        // At the hole.
        let x = beam.joints[*joint].offset;
        let at = printed
            .bent(beam, x)
            .map_or([x, 0.0, 0.0], |[dx, dy, turn]| [dx + x * turn.cos(), dy + x * turn.sin(), 0.0]);
        let (name, back) = (piece.name(&beam.name, *joint), at.map(|it| -it));
        let (at, back) = (numbers(&at), numbers(&back));
        let _ = write!(xml, r#"<body name="{name}" pos="{at}"><frame pos="{back}">{geoms}</frame></body>"#);
    }
    xml.push_str("</body>\n");
}

/// The geoms of a shape: what everything meets, and what only stems meet.
#[derive(Default)]
struct Geoms {
    solid: String,
    hole: String,
    ring: String,
}

impl Geoms {
    /// Moves all of them to a place (m), turned by an angle (rad).
    fn place(&mut self, at: &[f64; 3], turn: f64) {
        for text in [&mut self.solid, &mut self.hole, &mut self.ring] {
            if !text.is_empty() {
                *text = format!(r#"<frame pos="{}" euler="0 0 {turn}">{text}</frame>"#, numbers(at));
            }
        }
    }
}

fn shape_geoms(geoms: &mut Geoms, shape: Shape, printed: &mut PrintedPart) {
    let xml = &mut geoms.solid;
    match shape {
        Shape::Solid(cuboid) => {
            let metal = cuboid.max[1] - cuboid.min[1] < BODY_WIDTH * 0.9
                && cuboid.max[1] <= EXTRUSION / 2.0 + 1e-6
                && cuboid.min[1] >= -EXTRUSION / 2.0 - 1e-6;
            if metal {
                box_geom(xml, "metal", &cuboid);
            } else {
                box_geom(xml, "part", &printed.cuboid(cuboid));
            }
        }
        Shape::Plate { cuboid, hole } => {
            let (cuboid, radius) = (printed.cuboid(cuboid), printed.hole(HOLE_RADIUS));
            box_geom(xml, "plate", &cuboid);
            hole_boxes(&mut geoms.hole, "hole", &cuboid, hole, radius);
            ring_boxes(&mut geoms.ring, "hole", &cuboid, hole, radius);
        }
        Shape::Nose { x0, x1 } => nose_geom(xml, [x0, x1], &shape.bounds(), printed),
        Shape::Foot(cuboid) => box_geom(xml, "feet", &printed.cuboid(cuboid)),
        Shape::Turned { about, angle, piece } => {
            let mut turned = Geoms::default();
            let shape = match piece {
                TurnedPiece::Solid(cuboid) => Shape::Solid(cuboid),
                TurnedPiece::Plate(cuboid) => Shape::Plate { cuboid, hole: [0.0, 0.0] },
                TurnedPiece::Nose { x0, x1 } => Shape::Nose { x0, x1 },
            };
            shape_geoms(&mut turned, shape, printed);
            turned.place(&[about, 0.0, 0.0], angle);
            geoms.solid.push_str(&turned.solid);
            geoms.hole.push_str(&turned.hole);
            geoms.ring.push_str(&turned.ring);
        }
    }
}

/// The chamfered tip of a male from `x0` to `x1`, m, with that box around it.
fn nose_geom(xml: &mut String, [x0, x1]: [f64; 2], bounds: &Cuboid, printed: &mut PrintedPart) {
    if printed.is_exact() {
        let turn = if x1 > x0 { "1 0 0 0" } else { "0 0 0 1" };
        let place = numbers(&[x0, 0.0, 0.0]);
        let _ = write!(xml, r#"<geom class="part" type="mesh" mesh="nose" pos="{place}" quat="{turn}"/>"#);
        return;
    }
    let body = printed.cuboid(*bounds);
    let ends = if x1 > x0 { [body.min[0], body.max[0]] } else { [body.max[0], body.min[0]] };
    let name = printed.mesh_name("nose");
    printed.meshes.push_str(&chamfered(&name, &body, ends));
    let _ = write!(xml, r#"<geom class="part" type="mesh" mesh="{name}"/>"#);
}

/// Mass (kg), centre of mass (m, in B) and principal moments (kg·m²) of a beam: printed joints as boxes of
/// their mass where their sleeves are, extrusions as square rods over their whole length.
fn beam_inertia(beam: &Beam) -> (f64, [f64; 3], [f64; 3]) {
    let mut pieces: Vec<(f64, f64, f64, f64)> = Vec::new(); // mass, centre x, length, width
    for (index, joint) in beam.joints.iter().enumerate() {
        let (from, to) = if !joint.kind.is_end() {
            (joint.offset - joint.kind.sleeve(), joint.offset + joint.kind.sleeve())
        } else if index == 0 {
            (-MALE_TIP, joint.kind.sleeve())
        } else {
            (joint.offset - joint.kind.sleeve(), joint.offset + MALE_TIP)
        };
        pieces.push((joint.kind.mass(), (from + to) / 2.0, to - from, BODY_WIDTH));
    }
    for (link, pair) in beam.links.iter().zip(beam.joints.windows(2)) {
        let from = pair[0].offset + pair[0].kind.sleeve() - SOCKET_DEPTH;
        let middle = from + link.length / 2.0;
        pieces.push((link.length * EXTRUSION_MASS, middle, link.length, EXTRUSION));
    }
    let mass: f64 = pieces.iter().map(|piece| piece.0).sum();
    let centre = pieces.iter().map(|piece| piece.0 * piece.1).sum::<f64>() / mass;
    let mut along = 0.0;
    let mut across = 0.0;
    for (m, x, length, width) in pieces {
        along += m * width * width / 6.0;
        across += m * ((length * length + width * width) / 12.0 + (x - centre).powi(2));
    }
    (mass, [centre, 0.0, 0.0], [along, across, across])
}

/// A holder at its place; `loose` lets it slide on the table.
pub(super) fn holder_body(xml: &mut String, name: &str, x_wh: &Pose, loose: bool) {
    let _ = write!(xml, "<body name=\"{name}\" {}>", placed(x_wh));
    if loose {
        inertial(xml, HOLDER_MASS, &[0.0, 0.0, Holder::HEIGHT / 2.0], &[1e-4, 1e-4, 1e-4, 0.0, 0.0, 0.0]);
        for (axis, along) in [("x", "1 0 0"), ("y", "0 1 0")] {
            let _ = write!(
                xml,
                r#"<joint name="{name}{axis}" type="slide" axis="{along}" frictionloss="{HOLDER_FRICTION}"/>"#
            );
        }
    }
    let top = Holder::HEIGHT;
    for slot in [-1.0, 0.0, 1.0] {
        let x = slot * Holder::PITCH;
        let half = Holder::PITCH / 2.0;
        // The bar the heads rest on, and the ridge with the pocket for the tip (its floor 4 mm up).
        let bar = Cuboid::new([x - half, x + half], [-10.0e-3, 10.0e-3], [top - 4.0e-3, top]);
        plate_geoms(xml, "part", &bar, [x, 0.0], HOLE_RADIUS);
        let ridge = Cuboid::new([x - half, x + half], [-10.0e-3, 10.0e-3], [4.0e-3, 6.0e-3]);
        plate_geoms(xml, "part", &ridge, [x, 0.0], HOLE_RADIUS);
        let floor = Cuboid::new([x - half, x + half], [-10.0e-3, 10.0e-3], [0.0, 4.0e-3]);
        box_geom(xml, "part", &floor);
    }
    for [from, to] in [[-51.5e-3, -45.5e-3], [-20.0e-3, -14.0e-3], [14.0e-3, 20.0e-3], [45.5e-3, 51.5e-3]] {
        // The ribs taper; three steps follow them from inside.
        for (half, z) in
            [(17.7e-3, [0.0, 9.9e-3]), (12.4e-3, [9.9e-3, 17.2e-3]), (10.0e-3, [17.2e-3, 33.2e-3])]
        {
            box_geom(xml, "part", &Cuboid::new([from, to], [-half, half], z));
        }
    }
    xml.push_str("</body>\n");
}

/// A peg at its place.
pub(super) fn peg_body(xml: &mut String, name: &str, x_wp: &Pose, fixed: bool, printed: &mut PrintedPart) {
    let radius = printed.stem();
    // Head and stem as one solid each, of the printed part's mass.
    let head_mass = HEAD_WIDTH * HEAD_WIDTH * HEAD_HEIGHT * PLA_DENSITY;
    let scale = PEG_MASS / (head_mass + PI * STEM_RADIUS * STEM_RADIUS * STEM_LENGTH * PLA_DENSITY);
    let head_mass = head_mass * scale;
    let stem_mass = PEG_MASS - head_mass;
    let (head_z, stem_z) = (HEAD_HEIGHT / 2.0, -STEM_LENGTH / 2.0);
    let centre = (head_mass * head_z + stem_mass * stem_z) / PEG_MASS;
    let across = head_mass * ((HEAD_WIDTH.powi(2) + HEAD_HEIGHT.powi(2)) / 12.0 + (head_z - centre).powi(2))
        + stem_mass * ((3.0 * STEM_RADIUS.powi(2) + STEM_LENGTH.powi(2)) / 12.0 + (stem_z - centre).powi(2));
    let along = head_mass * HEAD_WIDTH.powi(2) / 6.0 + stem_mass * STEM_RADIUS.powi(2) / 2.0;
    let joint = if fixed { String::new() } else { format!(r#"<freejoint name="{name}"/>"#) };
    let _ = write!(
        xml,
        r#"<body name="{name}" {}>{joint}<inertial mass="{PEG_MASS}" pos="0 0 {}" diaginertia="{}"/>"#,
        placed(x_wp),
        numbers(&[centre]),
        numbers(&[across, across, along])
    );
    box_geom(xml, "head", &peg_head());
    let _ = write!(xml, r#"<body name="{}">"#, Piece::Grip.name(name, 0));
    head_geoms(xml);
    let _ = write!(xml, r#"</body><body name="{}">"#, Piece::Stem.name(name, 0));
    // The capsule's round end stays inside the cone.
    let end = -(STEM_LENGTH - STEM_CONE) + radius;
    let cone = if radius == STEM_RADIUS { "cone".to_string() } else { format!("cone-{name}") };
    let stem = Vector3::new(0.0, 0.0, end);
    let _ = write!(
        xml,
        r#"<geom class="stem" type="capsule" fromto="0 0 0.005 {}" size="{radius}"/><geom class="stem" type="mesh" mesh="{cone}"/></body></body>"#,
        numbers(stem.as_slice())
    );
    xml.push('\n');
}

/// The head of a peg with its rounded edges: three boxes, each short of the edges in one direction, which
/// keep the flat sides flat, and a capsule along each edge.
fn head_geoms(xml: &mut String) {
    let Cuboid { min, max } = peg_head();
    let r = HEAD_ROUNDING;
    for long in 0..3 {
        let mut piece = Cuboid { min, max };
        for axis in (0..3).filter(|axis| *axis != long) {
            piece.min[axis] += r;
            piece.max[axis] -= r;
        }
        box_geom(xml, "grip", &piece);
        // The four edges along this direction.
        let (u, v) = ((long + 1) % 3, (long + 2) % 3);
        for (u_end, v_end) in [
            (min[u] + r, min[v] + r),
            (max[u] - r, min[v] + r),
            (min[u] + r, max[v] - r),
            (max[u] - r, max[v] - r),
        ] {
            let end = |along: f64| {
                let mut point = [0.0; 3];
                point[long] = along;
                point[u] = u_end;
                point[v] = v_end;
                point
            };
            let edge = Capsule { from: end(min[long] + r), to: end(max[long] - r), radius: r };
            capsule_geom(xml, "grip", &edge);
        }
    }
}
