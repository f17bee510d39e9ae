//! The surface of a part as it was printed and sawn, for its pictures: where each point of the drawing is.
//!
//! The errors are those that the part's bodies have in the scene ([`super::print`]).

use std::collections::BTreeMap;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::joint::STEM_RADIUS;
use ramp_kit::{Beam, Kit, Pose};

use super::parts::beam_body;
use super::print::{Printed, PrintedPart};

/// A part's surface.
pub struct PartShape {
    part: PrintedPart,
    kind: Kind,
}

enum Kind {
    Beam(Box<BeamShape>),
    /// A peg, and how much wider its stem is.
    Peg {
        wider: f64,
    },
}

struct BeamShape {
    /// As drawn.
    beam: Beam,
    sawn: Beam,
    /// Errors of faces (m) by joint and axis, each with its position along that axis, m.
    faces: BTreeMap<(usize, usize), Vec<(f64, f64)>>,
}

impl Printed<'_> {
    /// The surface of a beam or peg of a kit; `None` for one that is as drawn.
    pub fn shape(&self, kit: &Kit, name: &str) -> Option<PartShape> {
        let parts = &self.physics.parts;
        let mut part = self.part(name);
        let kind = match kit.beam(name) {
            Some(_) if parts.face == 0.0 && parts.length == 0.0 && parts.bow == 0.0 => return None,
            Some(beam) => {
                // Drawn once more as the scene draws it, so that each face takes the same number.
                beam_body(&mut String::new(), beam, &Pose::identity(), false, &mut part);
                let (faces, sawn) = (part.faces(), self.part(name).beam(beam));
                Kind::Beam(Box::new(BeamShape { beam: beam.clone(), sawn, faces }))
            }
            None if parts.radius == 0.0 => return None,
            None => Kind::Peg { wider: part.stem() / STEM_RADIUS },
        };
        Some(PartShape { part, kind })
    }
}

impl PartShape {
    /// The pose to which a point of the drawing (m, in the part's frame) and its surroundings are moved, in
    /// the same frame.
    pub fn place(&self, p: Point3<f64>) -> Pose {
        let still = UnitQuaternion::identity();
        match &self.kind {
            Kind::Peg { wider } => {
                let wider = if p.z < 0.0 { *wider } else { 1.0 };
                Pose::from_parts(Translation3::new(p.x * wider, p.y * wider, p.z), still)
            }
            Kind::Beam(shape) => {
                let BeamShape { beam, sawn, faces } = &**shape;
                let p = printed(beam, sawn, faces, p);
                // Each joint is straight, and turned as the arc is at its middle.
                let x = nearest(sawn, p.x).map_or(p.x, |index| along(sawn, index, p.x));
                let Some([dx, dy, turn]) = self.part.bent(sawn, x) else {
                    return Pose::from_parts(Translation3::from(p.coords), still);
                };
                let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
                Pose::from_parts(Translation3::from(turn * p.coords + Vector3::new(dx, dy, 0.0)), turn)
            }
        }
    }
}

fn nearest(beam: &Beam, x: f64) -> Option<usize> {
    let distance = |index: &usize| (beam.joints[*index].offset - x).abs();
    (0..beam.joints.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// The place along a beam by which a point bends: its joint's hole, and between sleeves its own.
fn along(beam: &Beam, joint: usize, x: f64) -> f64 {
    let joint = &beam.joints[joint];
    let past = (x - joint.offset).abs() - joint.kind.sleeve();
    if past > 0.0 { x } else { joint.offset }
}

/// A point of a beam's drawing on the straight beam as it was sawn and printed.
fn printed(
    beam: &Beam,
    sawn: &Beam,
    faces: &BTreeMap<(usize, usize), Vec<(f64, f64)>>,
    p: Point3<f64>,
) -> Point3<f64> {
    let Some(index) = nearest(beam, p.x) else { return p };
    let (joint, moved) = (&beam.joints[index], &sawn.joints[index]);
    let past = (p.x - joint.offset).abs() - joint.kind.sleeve();
    if past > 0.0 {
        // An extrusion, which is as drawn but for its length.
        let longer = if beam.span() > 0.0 { sawn.span() / beam.span() } else { 1.0 };
        return Point3::new(p.x * longer, p.y, p.z);
    }
    let mut p = p + Vector3::new(moved.offset - joint.offset, 0.0, 0.0);
    for axis in 0..3 {
        if let Some(faces) = faces.get(&(index, axis)) {
            p[axis] += between(faces, p[axis]);
        }
    }
    p
}

/// The error at a position: that of the face there, and between two faces in proportion.
fn between(faces: &[(f64, f64)], at: f64) -> f64 {
    let after = faces.partition_point(|(position, _)| *position < at);
    match (after.checked_sub(1).and_then(|before| faces.get(before)), faces.get(after)) {
        (Some((low, first)), Some((high, second))) => {
            first + (second - first) * (at - low) / (high - low).max(1.0e-9)
        }
        (Some((_, error)), None) | (None, Some((_, error))) => *error,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use ramp_world::World;

    use super::*;

    /// The pictures of a part show the lengths, faces and bows of its bodies.
    #[test]
    fn a_surface_has_the_errors_of_the_bodies() {
        let data = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
        let kit = ramp_kit::read_kit(&data.join("kit.xml")).unwrap();
        let physics = World::read(&data.join("worlds/real.toml")).unwrap().draw(5);
        let printed = Printed { physics: &physics, seed: 5 };
        let beam = kit.beam("b4").unwrap();
        let shape = printed.shape(&kit, "b4").unwrap();
        let sawn = printed.part("b4").beam(beam);
        let end = shape.place(Point3::new(beam.span(), 0.0, 0.0)).translation.vector;
        assert!((end.x - sawn.span()).abs() < 0.1e-3 && end.y.abs() < 0.1e-3);
        assert!((sawn.span() - beam.span()).abs() > 1e-6);
        // A face is off by at most what the world says, and some face by a good share of it.
        let half = ramp_kit::joint::BODY_WIDTH / 2.0;
        let mut largest: f64 = 0.0;
        for joint in &beam.joints {
            let p = Point3::new(joint.offset, 0.0, half);
            largest = largest.max((shape.place(p).translation.z - p.z).abs());
        }
        assert!(largest > 0.01e-3 && largest < 0.1001e-3, "{largest}");
        let physics = World::ideal().draw(5);
        assert!(Printed { physics: &physics, seed: 5 }.shape(&kit, "b4").is_none());
    }
}
