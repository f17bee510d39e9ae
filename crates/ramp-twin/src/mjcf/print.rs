//! Parts as they come from a printer and a saw: every face a little off, each part in its own way.
//!
//! A joint is drawn as several boxes. Faces of them that lie in one plane are one face of the print, and are
//! off by the same.

use std::collections::BTreeMap;

use ramp_kit::Beam;
use ramp_kit::joint::STEM_RADIUS;
use ramp_kit::shape::Cuboid;
use ramp_robot::random::Stream;
use ramp_world::Physics;

/// The printed parts of an episode, with their errors.
pub struct Printed<'a> {
    /// The values that the episode drew from its world.
    pub physics: &'a Physics,
    /// The episode's seed.
    pub seed: u64,
}

impl Printed<'_> {
    /// One part: its numbers do not depend on which others there are.
    pub(super) fn part(&self, name: &str) -> PrintedPart {
        let parts = &self.physics.parts;
        PrintedPart {
            name: name.to_string(),
            stream: Stream::new(self.seed, &format!("print-{name}")),
            joint: 0,
            planes: BTreeMap::new(),
            meshes: String::new(),
            face: parts.face,
            radius: parts.radius,
            length: parts.length,
            bow: Stream::new(self.seed, &format!("bow-{name}")).symmetric(parts.bow),
        }
    }

    /// Each peg and the radius of its stem, m, where they differ from the drawing.
    pub(super) fn stems<'n>(&self, pegs: impl Iterator<Item = &'n str>) -> Vec<(&'n str, f64)> {
        if self.physics.parts.radius == 0.0 {
            return Vec::new();
        }
        pegs.map(|name| (name, self.part(name).stem())).collect()
    }
}

/// One part as it was printed.
pub(super) struct PrintedPart {
    name: String,
    stream: Stream,
    /// The joint of a beam whose faces are printed.
    joint: usize,
    /// Errors of planes, m, by joint, axis, and position along it in µm.
    planes: BTreeMap<(usize, usize, i64), f64>,
    /// Meshes of shapes other than boxes, for the scene's assets.
    pub meshes: String,
    face: f64,
    radius: f64,
    length: f64,
    /// Lateral displacement of a beam's middle towards +y, as a share of its length.
    bow: f64,
}

impl PrintedPart {
    /// A peg's stem, m; the first number that is drawn for a peg.
    pub fn stem(&mut self) -> f64 {
        if self.radius == 0.0 { STEM_RADIUS } else { STEM_RADIUS + self.stream.symmetric(self.radius) }
    }

    /// The radius of a hole, m.
    pub fn hole(&mut self, radius: f64) -> f64 {
        if self.radius == 0.0 { radius } else { radius + self.stream.symmetric(self.radius) }
    }

    /// Selects the joint of a beam that is nearest to `x`, m in the beam's frame.
    pub fn go_to(&mut self, beam: &Beam, x: f64) {
        let distance = |index: &usize| (beam.joints[*index].offset - x).abs();
        let nearest = (0..beam.joints.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        self.joint = nearest.unwrap_or_default();
    }

    /// The joint that was selected.
    pub fn joint(&self) -> usize {
        self.joint
    }

    /// A name for the next of its meshes.
    pub fn mesh_name(&self, kind: &str) -> String {
        format!("{kind}-{}-{}", self.name, self.meshes.lines().count())
    }

    /// The errors of the faces that were printed so far (m), by joint and axis, each with its position along
    /// that axis (m), in their order.
    pub(super) fn faces(&self) -> BTreeMap<(usize, usize), Vec<(f64, f64)>> {
        let mut faces: BTreeMap<(usize, usize), Vec<(f64, f64)>> = BTreeMap::new();
        for ((joint, axis, position), error) in &self.planes {
            faces.entry((*joint, *axis)).or_default().push((*position as f64 * 1.0e-6, *error));
        }
        faces
    }

    /// Is everything as it was drawn?
    pub fn is_exact(&self) -> bool {
        self.face == 0.0
    }

    /// A printed box of the joint.
    pub fn cuboid(&mut self, cuboid: Cuboid) -> Cuboid {
        if self.is_exact() {
            return cuboid;
        }
        let Cuboid { mut min, mut max } = cuboid;
        for (axis, value) in (0..3).zip(&mut min).chain((0..3).zip(&mut max)) {
            let plane = (self.joint, axis, (*value * 1e6).round() as i64);
            let (stream, face) = (&mut self.stream, self.face);
            *value += *self.planes.entry(plane).or_insert_with(|| stream.symmetric(face));
        }
        Cuboid { min, max }
    }

    /// A beam of the length that was sawn: its joints are as far apart as that makes them.
    pub fn beam(&mut self, beam: &Beam) -> Beam {
        if self.length == 0.0 || beam.span() <= 0.0 {
            return beam.clone();
        }
        let longer = 1.0 + self.stream.symmetric(self.length) / beam.span();
        let mut sawn = beam.clone();
        for joint in &mut sawn.joints {
            joint.offset *= longer;
        }
        for link in &mut sawn.links {
            link.length += beam.span() * (longer - 1.0) / beam.links.len() as f64;
        }
        sawn
    }

    /// Displacement by the bow of the piece of a beam at `x` (m, in the beam's frame): the pose of the
    /// straight beam's frame for it, in the frame of the beam, as x and y (m) and the turn about z (rad).
    /// `None` for a straight beam.
    pub fn bent(&self, beam: &Beam, x: f64) -> Option<[f64; 3]> {
        let span = beam.span();
        if self.bow == 0.0 || span <= 0.0 {
            return None;
        }
        // A parabola through both end holes.
        let along = x / span;
        let aside = 4.0 * self.bow * span * along * (1.0 - along);
        let turn = (4.0 * self.bow * (1.0 - 2.0 * along)).atan();
        Some([x - x * turn.cos(), aside - x * turn.sin(), turn])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(face: f64) -> PrintedPart {
        PrintedPart {
            name: "b1".to_string(),
            stream: Stream::new(1, "print"),
            joint: 0,
            planes: BTreeMap::new(),
            meshes: String::new(),
            face,
            radius: 0.0,
            length: 0.0,
            bow: 0.0,
        }
    }

    /// No step where one box of a joint continues as another: an edge of the other part would catch on it.
    #[test]
    fn boxes_with_faces_in_one_plane_are_printed_without_a_step() {
        let mut part = part(1e-4);
        let body = part.cuboid(Cuboid::new([0.0, 0.02], [-0.0133, 0.0133], [-0.0133, 0.0133]));
        let tip = part.cuboid(Cuboid::new([0.02, 0.03], [-0.0133, 0.0133], [-0.0133, 0.0133]));
        assert_eq!(body.max[0], tip.min[0]);
        assert_eq!((&body.min[1..], &body.max[1..]), (&tip.min[1..], &tip.max[1..]));
        assert!(body.max[1] != 0.0133 && body.max[1] != -body.min[1]);
        part.joint = 1;
        let other = part.cuboid(Cuboid::new([0.0, 0.02], [-0.0133, 0.0133], [-0.0133, 0.0133]));
        assert!(other.max[1] != body.max[1]);
    }

    /// Both end holes of a bowed beam stay where they are, its middle stands aside by the share that was
    /// drawn, and each piece begins where its neighbour ends.
    #[test]
    fn a_bowed_beam_is_an_arc_between_its_end_holes() {
        let data = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
        let kit = ramp_kit::read_kit(&data.join("kit.xml")).unwrap();
        let beam = kit.beams.iter().find(|beam| beam.links.len() > 1).unwrap();
        let (bow, span) = (1e-3, beam.span());
        let part = PrintedPart { bow, ..part(0.0) };
        // The position to which the piece about `middle` moves the point at `x` of the axis.
        let at = |middle: f64, x: f64| {
            let [dx, dy, turn] = part.bent(beam, middle).unwrap();
            [dx + x * turn.cos(), dy + x * turn.sin()]
        };
        for (x, aside) in [(0.0, 0.0), (span / 2.0, bow * span), (span, 0.0)] {
            let [along, across] = at(x, x);
            assert!((along - x).abs() < 1e-9 && (across - aside).abs() < 1e-9);
        }
        let step = span / 8.0;
        for piece in 0..8 {
            let (middle, edge) = ((f64::from(piece) + 0.5) * step, f64::from(piece + 1) * step);
            let (here, next) = (at(middle, edge), at(middle + step, edge));
            assert!((here[1] - next[1]).abs() < 1e-6, "{here:?} {next:?}");
        }
    }
}
