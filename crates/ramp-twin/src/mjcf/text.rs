//! Numbers, poses and plain geoms as MJCF text.

use ramp_kit::Pose;
use ramp_kit::shape::Cuboid;
use ramp_robot::arm::Capsule;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;

/// Contact stiffness and friction that hold a 27 g peg without walls going soft.
pub(super) const CONTACT: &str = r#"solref="0.004 1" solimp="0.95 0.999 0.0002 0.5 2""#;
/// Contact of the fingertips with held parts: as stiff as the others (at 4 ms and the critical damping of
/// 500/s), and damped ten times as much or more, with `damping` (1/s). The engine's friction ignores the
/// rotation of the joints' directions of motion. A part in a hand on rotating joints slips by that, times
/// half of the step plus the inverse of this damping. Under a load the damping determines how fast a part
/// creeps.
pub(super) fn grip(damping: f64) -> String {
    format!(r#"solref="-62500 -{damping}" solimp="0.95 0.999 0.0002 0.5 2""#)
}

/// Edges of the polygon around a peg hole.
const HOLE_EDGES: usize = 16;
/// Recess of the rotated boxes around a hole below the plate's faces, m.
const RING_RECESS: f64 = 0.1e-3;
/// Radial thickness of those boxes, m.
const RING_THICKNESS: f64 = 2.0e-3;

/// Numbers separated by spaces.
pub(super) fn numbers(values: &[f64]) -> String {
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
pub(super) fn placed(x: &Pose) -> String {
    let q = x.rotation.quaternion();
    format!(r#"pos="{}" quat="{} {} {} {}""#, numbers(x.translation.vector.as_slice()), q.w, q.i, q.j, q.k)
}

/// A capsule of a class.
pub(super) fn capsule_geom(xml: &mut String, class: &str, capsule: &Capsule) {
    let ends: Vec<f64> = capsule.from.iter().chain(&capsule.to).copied().collect();
    let _ = write!(
        xml,
        r#"<geom class="{class}" type="capsule" fromto="{}" size="{}"/>"#,
        numbers(&ends),
        numbers(&[capsule.radius])
    );
}

/// A box of a class.
pub(super) fn box_geom(xml: &mut String, class: &str, cuboid: &Cuboid) {
    let _ = write!(
        xml,
        r#"<geom class="{class}" type="box" pos="{}" size="{}"/>"#,
        numbers(&cuboid.centre()),
        numbers(&cuboid.half())
    );
}

/// Mass (kg), its centre (m) and the moments of inertia (kg·m²) of a body.
pub(super) fn inertial(xml: &mut String, mass: f64, centre: &[f64; 3], inertia: &[f64; 6]) {
    let _ = write!(
        xml,
        r#"<inertial mass="{mass}" pos="{}" fullinertia="{}"/>"#,
        numbers(centre),
        numbers(inertia)
    );
}

/// A plate with a round hole along z: the boxes around its square, and those in the corners.
pub(super) fn plate_geoms(xml: &mut String, class: &str, cuboid: &Cuboid, hole: [f64; 2], radius: f64) {
    hole_boxes(xml, class, cuboid, hole, radius);
    ring_boxes(xml, class, cuboid, hole, radius);
}

/// The four boxes of a plate around the square of its hole.
pub(super) fn hole_boxes(xml: &mut String, class: &str, cuboid: &Cuboid, hole: [f64; 2], radius: f64) {
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
}

/// The rotated boxes in the corners of that square, which make the hole round.
pub(super) fn ring_boxes(xml: &mut String, class: &str, cuboid: &Cuboid, hole: [f64; 2], radius: f64) {
    let (z0, z1) = (cuboid.min[2], cuboid.max[2]);
    let [cx, cy] = hole;
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
