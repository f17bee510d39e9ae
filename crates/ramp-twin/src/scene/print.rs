//! Parts as they come from a printer and a saw: every face a little off, each part in its own way.

use ramp_kit::Beam;
use ramp_kit::joint::STEM_RADIUS;
use ramp_kit::shape::Cuboid;
use ramp_robot::random::Stream;
use ramp_world::Physics;

/// How the parts of an episode were printed.
pub struct Printed<'a> {
    /// What the episode drew from its world.
    pub physics: &'a Physics,
    /// The episode's seed.
    pub seed: u64,
}

impl Printed<'_> {
    /// One part: its numbers do not depend on which others there are.
    pub(super) fn part(&self, name: &str) -> PrintedPart {
        let parts = &self.physics.parts;
        PrintedPart {
            stream: Stream::new(self.seed, &format!("print-{name}")),
            face: parts.face,
            radius: parts.radius,
            length: parts.length,
        }
    }

    /// Each peg and the radius of its stem, m, where they differ from what is drawn.
    pub(super) fn stems<'n>(&self, pegs: impl Iterator<Item = &'n str>) -> Vec<(&'n str, f64)> {
        if self.physics.parts.radius == 0.0 {
            return Vec::new();
        }
        pegs.map(|name| (name, self.part(name).stem())).collect()
    }
}

/// One part as it was printed.
pub(super) struct PrintedPart {
    stream: Stream,
    face: f64,
    radius: f64,
    length: f64,
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

    /// A printed box.
    pub fn cuboid(&mut self, cuboid: Cuboid) -> Cuboid {
        if self.face == 0.0 {
            return cuboid;
        }
        let Cuboid { mut min, mut max } = cuboid;
        for value in min.iter_mut().chain(&mut max) {
            *value += self.stream.symmetric(self.face);
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
}
