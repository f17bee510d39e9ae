//! The scene as MJCF: table, sheet, arm, beams, holders and pegs, all from the kit, the arm file and a layout.
//!
//! Every flat of a part is a box, so the clearances of the parts are kept exactly. A peg hole is four boxes and
//! twelve turned boxes tangent to its circle (a 16-gon around it, at most 0.08 mm outside); the turned ones are a
//! little thinner than the plate, so that a seated head meets only the four. Parts meet the table through one
//! invisible box for each joint. What these choices are worth, and which others failed, is in docs/src/explanation/twin.md.

use std::f64::consts::{PI, TAU};
use std::fmt::Write;

use nalgebra::Vector3;
use ramp_kit::joint::{
    BODY_WIDTH, EXTRUSION, EXTRUSION_MASS, HEAD_HEIGHT, HEAD_ROUNDING, HEAD_WIDTH, HOLE_RADIUS, MALE_CHAMFER,
    MALE_TIP, PLA_DENSITY, SOCKET_DEPTH, STEM_CONE, STEM_LENGTH, STEM_RADIUS, STEM_TIP_RADIUS,
};
use ramp_kit::shape::{Cuboid, Piece, Shape, beam_rests, beam_shapes, peg_head};
use ramp_kit::{Beam, Holder, Kit, Pose};
use ramp_robot::arm::{ArmBox, ArmModel, Capsule};

use crate::layout::Layout;
use crate::looks;

/// Edges of the polygon around a peg hole.
const HOLE_EDGES: usize = 16;
/// By how much the turned boxes around a hole stay below the plate's faces, m.
const RING_RECESS: f64 = 0.1e-3;
/// Radial thickness of those boxes, m.
const RING_THICKNESS: f64 = 2.0e-3;
/// Edges of the polygon of a peg's cone.
const CONE_EDGES: usize = 24;
/// Mass of a peg in solid PLA, kg.
pub const PEG_MASS: f64 = 26.9e-3;

/// Contact stiffness and friction that hold a 27 g peg without walls going soft.
const CONTACT: &str = r#"solref="0.004 1" solimp="0.95 0.999 0.0002 0.5 2""#;

/// Dry friction of a holder that can be pushed over the table, N along each axis, and its mass, kg.
const HOLDER_FRICTION: f64 = 20.0;
/// See [`HOLDER_FRICTION`].
const HOLDER_MASS: f64 = 0.1;

/// The MJCF text of a scene. `base` names the beam that is clamped to the table. Holders are fixed to it, or with
/// `loose_holders` slide on it when they are pushed hard.
pub fn scene_xml(kit: &Kit, arm: &ArmModel, layout: &Layout, base: &str, loose_holders: bool) -> String {
    let mut xml = String::with_capacity(512 * 1024);
    header(&mut xml, arm);
    table(&mut xml, kit);
    arm_bodies(&mut xml, arm);
    for (name, x_wb) in &layout.beams {
        if let Some(beam) = kit.beam(name) {
            beam_body(&mut xml, beam, x_wb, name == base);
        }
    }
    for (name, x_wh) in &layout.holders {
        holder_body(&mut xml, name, x_wh, loose_holders);
    }
    for (name, x_wp) in &layout.pegs {
        peg_body(&mut xml, name, x_wp);
    }
    xml.push_str("</worldbody>\n");
    actuators_and_sensors(&mut xml, arm);
    xml.push_str("</mujoco>\n");
    xml
}

/// Numbers separated by spaces.
fn numbers(values: &[f64]) -> String {
    let mut text = String::new();
    for (index, value) in values.iter().enumerate() {
        if index > 0 {
            text.push(' ');
        }
        // Nine digits after the point: a nanometre, and no noise in the text from sums.
        let rounded = (value * 1e9).round() / 1e9;
        let _ = write!(text, "{rounded}");
    }
    text
}

/// `pos` and `quat` attributes of a pose.
fn placed(x: &Pose) -> String {
    let q = x.rotation.quaternion();
    format!(r#"pos="{}" quat="{} {} {} {}""#, numbers(x.translation.vector.as_slice()), q.w, q.i, q.j, q.k)
}

fn header(xml: &mut String, arm: &ArmModel) {
    let _ = write!(
        xml,
        r#"<mujoco model="ramp">
<compiler angle="radian" autolimits="true" boundmass="1e-6"/>
<option timestep="0.001" integrator="discrete" cone="elliptic" impratio="10" noslip_iterations="3" iterations="100" tolerance="1e-8"><flag sleep="enable"/></option>
<size memory="512M"/>
<visual><global offwidth="1280" offheight="800" fovy="40"/><headlight ambient="0.35 0.35 0.35" diffuse="0.4 0.4 0.4"/><map znear="0.005"/></visual>
<default>
<default class="part"><geom mass="0" friction="0.3 0.005 0.0001" condim="3" {CONTACT} contype="2" conaffinity="3" rgba="0.93 0.53 0.18 1"/></default>
<default class="metal"><geom mass="0" friction="0.3 0.005 0.0001" condim="3" {CONTACT} contype="2" conaffinity="3" rgba="0.78 0.80 0.83 1"/></default>
<default class="peg"><geom mass="0" friction="0.3 0.005 0.0001" condim="3" {CONTACT} contype="6" conaffinity="3" rgba="0.20 0.45 0.80 1"/></default>
<default class="feet"><geom mass="0" friction="0.5 0.005 0.0001" condim="3" {CONTACT} contype="6" conaffinity="3" rgba="0.93 0.53 0.18 1"/></default>
<default class="rest"><geom mass="0" friction="0.5 0.005 0.0001" condim="3" {CONTACT} contype="4" conaffinity="0" group="4" rgba="1 0 0 0.2"/></default>
<default class="arm"><geom mass="0" {CONTACT} contype="1" conaffinity="0" group="3" rgba="0.92 0.93 0.95 1"/></default>
<default class="tool"><geom mass="0" {CONTACT} contype="1" conaffinity="0" rgba="0.30 0.31 0.34 1"/></default>
<default class="look"><geom type="mesh" mass="0" contype="0" conaffinity="0"/></default>
<default class="pad"><geom mass="0" friction="1.0 0.01 0.0005" condim="4" priority="1" {CONTACT} contype="1" conaffinity="0" rgba="0.18 0.19 0.21 1"/></default>
</default>
<asset>
<texture name="sky" type="skybox" builtin="gradient" rgb1="0.85 0.90 0.95" rgb2="0.55 0.62 0.70" width="256" height="256"/>
{}{}{}
</asset>
<worldbody>
<light pos="0.2 -0.8 2.2" dir="0.1 0.4 -1" directional="true" diffuse="0.55 0.55 0.55" specular="0.1 0.1 0.1"/>
<camera name="overview" fovy="36" pos="1.45 -1.0 0.95" xyaxes="0.6686 0.7436 0 -0.349 0.314 0.882"/>
"#,
        nose_mesh(),
        cone_mesh(),
        looks::assets(&arm.name),
    );
}

/// The chamfered end of a male: full section at x = 0, the tip at x = +length.
fn nose_mesh() -> String {
    let half = BODY_WIDTH / 2.0;
    let mut vertices = Vec::new();
    for (x, h) in [(0.0, half), (MALE_CHAMFER, half - MALE_CHAMFER)] {
        for y in [-h, h] {
            for z in [-h, h] {
                vertices.extend([x, y, z]);
            }
        }
    }
    format!("<mesh name=\"nose\" vertex=\"{}\"/>\n", numbers(&vertices))
}

/// The cone at the end of a peg's stem, with a short piece of the stem above it, in the peg's frame.
fn cone_mesh() -> String {
    let mut vertices = Vec::new();
    let cone = STEM_LENGTH - STEM_CONE;
    for (z, r) in [(4.0e-3 - cone, STEM_RADIUS), (-cone, STEM_RADIUS), (-STEM_LENGTH, STEM_TIP_RADIUS)] {
        for edge in 0..CONE_EDGES {
            let angle = TAU * (edge as f64 + 0.5) / CONE_EDGES as f64;
            vertices.extend([r * angle.cos(), r * angle.sin(), z]);
        }
    }
    format!("<mesh name=\"cone\" vertex=\"{}\"/>\n", numbers(&vertices))
}

fn table(xml: &mut String, kit: &Kit) {
    let _ = writeln!(
        xml,
        r#"<geom name="table" type="plane" size="2 2 0.1" contype="0" conaffinity="5" condim="3" friction="0.5 0.005 0.0001" {CONTACT} rgba="0.62 0.60 0.57 1"/>"#
    );
    let [width, height] = kit.sheet.size;
    let [x, y] = kit.sheet.corner;
    let _ = writeln!(
        xml,
        r#"<geom name="sheet" type="box" pos="{}" size="{}" contype="0" conaffinity="0" rgba="0.96 0.96 0.94 1"/>"#,
        numbers(&[x + width / 2.0, y - height / 2.0, 0.0001]),
        numbers(&[width / 2.0, height / 2.0, 0.0002]),
    );
}

fn capsule_geom(xml: &mut String, class: &str, capsule: &Capsule) {
    let ends: Vec<f64> = capsule.from.iter().chain(&capsule.to).copied().collect();
    let _ = write!(
        xml,
        r#"<geom class="{class}" type="capsule" fromto="{}" size="{}"/>"#,
        numbers(&ends),
        numbers(&[capsule.radius])
    );
}

fn box_geom(xml: &mut String, class: &str, cuboid: &Cuboid) {
    let _ = write!(
        xml,
        r#"<geom class="{class}" type="box" pos="{}" size="{}"/>"#,
        numbers(&cuboid.centre()),
        numbers(&cuboid.half())
    );
}

/// A box of the hand.
fn hand_box(piece: &ArmBox) -> Cuboid {
    Cuboid { min: piece.min, max: piece.max }
}

/// A box of a finger in the finger's frame; `tip` is how far the tip is out along that frame's z (m), and the arm
/// file counts heights from the tip towards the hand.
fn finger_box(piece: &ArmBox, tip: f64) -> Cuboid {
    let [x0, y0, z0] = piece.min;
    let [x1, y1, z1] = piece.max;
    Cuboid { min: [x0, y0, tip - z1], max: [x1, y1, tip - z0] }
}

fn inertial(xml: &mut String, mass: f64, centre: &[f64; 3], inertia: &[f64; 6]) {
    let _ = write!(
        xml,
        r#"<inertial mass="{mass}" pos="{}" fullinertia="{}"/>"#,
        numbers(centre),
        numbers(inertia)
    );
}

fn arm_bodies(xml: &mut String, arm: &ArmModel) {
    xml.push_str("<body name=\"link0\">");
    for capsule in &arm.base.capsules {
        capsule_geom(xml, "arm", capsule);
    }
    xml.push_str(&looks::geoms(&arm.name, "link0"));
    for (index, joint) in arm.joints.iter().enumerate() {
        let number = index + 1;
        let q = joint.quat_wxyz;
        let _ = write!(
            xml,
            "\n<body name=\"link{number}\" pos=\"{}\" quat=\"{} {} {} {}\" gravcomp=\"1\">",
            numbers(&joint.position),
            q[0],
            q[1],
            q[2],
            q[3]
        );
        inertial(xml, joint.link.mass, &joint.link.centre, &joint.link.inertia);
        let _ = write!(
            xml,
            r#"<joint name="joint{number}" axis="0 0 1" range="{}" damping="0.5" armature="0.1"/>"#,
            numbers(&joint.range)
        );
        for capsule in &joint.link.capsules {
            capsule_geom(xml, "arm", capsule);
        }
        xml.push_str(&looks::geoms(&arm.name, &format!("link{number}")));
    }
    let hand = &arm.hand;
    let q = hand.quat_wxyz;
    let _ = write!(
        xml,
        "\n<body name=\"hand\" pos=\"{}\" quat=\"{} {} {} {}\" gravcomp=\"1\">",
        numbers(&hand.position),
        q[0],
        q[1],
        q[2],
        q[3]
    );
    inertial(xml, hand.mass, &hand.centre, &hand.inertia);
    let _ = write!(
        xml,
        r#"<site name="wrist" pos="0 0 0" size="0.002"/><site name="tip" pos="0 0 {}" size="0.002"/>"#,
        hand.tip
    );
    for (index, piece) in hand.boxes.iter().enumerate() {
        // The first box is the hand's body, which has a mesh; the others are what is mounted on it.
        box_geom(xml, if index == 0 { "arm" } else { "tool" }, &hand_box(piece));
    }
    xml.push_str(&looks::geoms(&arm.name, "hand"));
    let finger = &arm.finger;
    let tip = hand.tip - finger.origin;
    for (name, turn) in [("finger1", 0.0), ("finger2", PI)] {
        let half: f64 = turn / 2.0;
        let _ = write!(
            xml,
            "\n<body name=\"{name}\" pos=\"0 0 {}\" quat=\"{} 0 0 {}\" gravcomp=\"1\">",
            finger.origin,
            half.cos().round(),
            half.sin().round()
        );
        inertial(xml, finger.mass, &finger.centre, &finger.inertia);
        let _ = write!(
            xml,
            r#"<joint name="{name}" type="slide" axis="0 1 0" range="0 {}" armature="0.1" damping="5"/>"#,
            finger.stroke
        );
        for pad in &finger.pads {
            box_geom(xml, "pad", &finger_box(pad, tip));
        }
        for piece in &finger.boxes {
            box_geom(xml, "tool", &finger_box(piece, tip));
        }
        xml.push_str("</body>");
    }
    xml.push_str("</body>");
    for _ in &arm.joints {
        xml.push_str("</body>");
    }
    xml.push_str("</body>\n");
}

/// A plate with a round hole along z: four boxes around the hole's square, turned boxes in its corners.
fn plate_geoms(xml: &mut String, class: &str, cuboid: &Cuboid, hole: [f64; 2], radius: f64) {
    let ([x0, y0, z0], [x1, y1, z1]) = (cuboid.min, cuboid.max);
    let [cx, cy] = hole;
    let z = [z0, z1];
    for piece in [
        Cuboid::new([x0, x1], [cy + radius, y1], z),
        Cuboid::new([x0, x1], [y0, cy - radius], z),
        Cuboid::new([cx + radius, x1], [cy - radius, cy + radius], z),
        Cuboid::new([x0, cx - radius], [cy - radius, cy + radius], z),
    ] {
        box_geom(xml, class, &piece);
    }
    for edge in 0..HOLE_EDGES {
        if edge % (HOLE_EDGES / 4) == 0 {
            continue;
        }
        let angle = TAU * edge as f64 / HOLE_EDGES as f64;
        // A little longer than the polygon's edge, so that neighbours overlap.
        let half_length = 1.25 * radius * (PI / HOLE_EDGES as f64).tan();
        let distance = radius + RING_THICKNESS / 2.0;
        let _ = write!(
            xml,
            r#"<geom class="{class}" type="box" pos="{}" euler="0 0 {}" size="{}"/>"#,
            numbers(&[cx + distance * angle.cos(), cy + distance * angle.sin(), (z0 + z1) / 2.0]),
            angle,
            numbers(&[RING_THICKNESS / 2.0, half_length, (z1 - z0) / 2.0 - RING_RECESS])
        );
    }
}

fn beam_body(xml: &mut String, beam: &Beam, x_wb: &Pose, clamped: bool) {
    let _ = write!(xml, "<body name=\"{}\" {}>", beam.name, placed(x_wb));
    if !clamped {
        let (mass, centre, diagonal) = beam_inertia(beam);
        let _ = write!(
            xml,
            r#"<freejoint name="{}"/><inertial mass="{mass}" pos="{}" diaginertia="{}"/>"#,
            beam.name,
            numbers(&centre),
            numbers(&diagonal)
        );
    }
    for shape in beam_shapes(beam) {
        shape_geoms(xml, shape);
    }
    for rest in beam_rests(beam) {
        box_geom(xml, "rest", &rest);
    }
    xml.push_str("</body>\n");
}

fn shape_geoms(xml: &mut String, shape: Shape) {
    match shape {
        Shape::Solid(cuboid) => {
            let metal = cuboid.max[1] - cuboid.min[1] < BODY_WIDTH * 0.9
                && cuboid.max[1] <= EXTRUSION / 2.0 + 1e-6
                && cuboid.min[1] >= -EXTRUSION / 2.0 - 1e-6;
            box_geom(xml, if metal { "metal" } else { "part" }, &cuboid);
        }
        Shape::Plate { cuboid, hole } => plate_geoms(xml, "part", &cuboid, hole, HOLE_RADIUS),
        Shape::Nose { x0, x1 } => {
            let turn = if x1 > x0 { "1 0 0 0" } else { "0 0 0 1" };
            let _ = write!(
                xml,
                r#"<geom class="part" type="mesh" mesh="nose" pos="{}" quat="{turn}"/>"#,
                numbers(&[x0, 0.0, 0.0])
            );
        }
        Shape::Foot(cuboid) => box_geom(xml, "feet", &cuboid),
        Shape::Turned { about, angle, piece } => {
            let _ = write!(xml, r#"<frame pos="{}" euler="0 0 {angle}">"#, numbers(&[about, 0.0, 0.0]));
            shape_geoms(
                xml,
                match piece {
                    Piece::Solid(cuboid) => Shape::Solid(cuboid),
                    Piece::Plate(cuboid) => Shape::Plate { cuboid, hole: [0.0, 0.0] },
                    Piece::Nose { x0, x1 } => Shape::Nose { x0, x1 },
                },
            );
            xml.push_str("</frame>");
        }
    }
}

/// Mass (kg), centre of mass (m, in B) and principal moments (kg·m²) of a beam: printed joints as boxes of their
/// mass where their sleeves are, extrusions as square rods over their whole length.
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

fn holder_body(xml: &mut String, name: &str, x_wh: &Pose, loose: bool) {
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

fn peg_body(xml: &mut String, name: &str, x_wp: &Pose) {
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
    let _ = write!(
        xml,
        r#"<body name="{name}" {}><freejoint name="{name}"/><inertial mass="{PEG_MASS}" pos="0 0 {}" diaginertia="{}"/>"#,
        placed(x_wp),
        numbers(&[centre]),
        numbers(&[across, across, along])
    );
    head_geoms(xml);
    // The capsule's round end stays inside the cone.
    let end = -(STEM_LENGTH - STEM_CONE) + STEM_RADIUS;
    let stem = Vector3::new(0.0, 0.0, end);
    let _ = write!(
        xml,
        r#"<geom class="peg" type="capsule" fromto="0 0 0.005 {}" size="{STEM_RADIUS}"/><geom class="peg" type="mesh" mesh="cone"/></body>"#,
        numbers(stem.as_slice())
    );
    xml.push('\n');
}

/// The head of a peg with its rounded edges: three boxes, each short of the edges in one direction, which keep the flat
/// sides flat, and a capsule along each edge.
fn head_geoms(xml: &mut String) {
    let Cuboid { min, max } = peg_head();
    let r = HEAD_ROUNDING;
    for long in 0..3 {
        let mut piece = Cuboid { min, max };
        for axis in (0..3).filter(|axis| *axis != long) {
            piece.min[axis] += r;
            piece.max[axis] -= r;
        }
        box_geom(xml, "peg", &piece);
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
            capsule_geom(xml, "peg", &edge);
        }
    }
}

fn actuators_and_sensors(xml: &mut String, arm: &ArmModel) {
    // The fingertips' ribs pass each other's plates when the hand is closed on nothing.
    xml.push_str("<contact><exclude body1=\"finger1\" body2=\"finger2\"/></contact>\n<actuator>");
    for (index, joint) in arm.joints.iter().enumerate() {
        let _ = write!(
            xml,
            r#"<motor name="joint{0}" joint="joint{0}" ctrlrange="{1} {2}"/>"#,
            index + 1,
            -joint.torque,
            joint.torque
        );
    }
    xml.push_str(
        r#"<motor name="finger1" joint="finger1"/><motor name="finger2" joint="finger2"/></actuator>"#,
    );
    xml.push_str("\n<sensor><force name=\"wrist_force\" site=\"wrist\"/><torque name=\"wrist_torque\" site=\"wrist\"/></sensor>\n");
}
