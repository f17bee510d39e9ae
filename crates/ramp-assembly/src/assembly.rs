//! An assembly: where every beam of a goal is to stand, and which joints are to be pinned by a peg.

use crate::paths::Paths;
pub use crate::placed::{Connection, Insertion, JointRef, PlacedBeam};
use nalgebra::{Point3, Vector3};
use ramp_kit::Kit;
use std::sync::Arc;

/// The three classes of goals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Class {
    /// Square insertions and one cap.
    Easy,
    /// Beams that pass through, or stand at an angle.
    Medium,
    /// Several of both.
    Hard,
}

impl Class {
    /// All three, in order of difficulty.
    pub const ALL: [Class; 3] = [Class::Easy, Class::Medium, Class::Hard];

    /// The name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Class::Easy => "easy",
            Class::Medium => "medium",
            Class::Hard => "hard",
        }
    }
}

/// A goal, placed: what the planner, the skills, the twin and the referee work from.
#[derive(Clone, Debug)]
pub struct Assembly {
    /// The goal's name, for example `easy-3`, or the stem of its file.
    pub name: String,
    /// Its class; `None` for a goal that belongs to none.
    pub class: Option<Class>,
    /// The kit that its beams and pegs are taken from.
    pub kit: Arc<Kit>,
    /// The beams, in the order of the file.
    pub beams: Vec<PlacedBeam>,
    /// Index into `beams` of the beam that is clamped to the table.
    pub base: usize,
    /// The connections, in the order of the file.
    pub connections: Vec<Connection>,
    /// An order of straight insertions, each free of collision, that builds it; the base is not in it.
    pub insertions: Vec<Insertion>,
    /// From which directions each beam can be put to its place, and what blocks it there.
    pub paths: Arc<Paths>,
}

impl Assembly {
    /// The beam of that name.
    pub fn beam_index(&self, name: &str) -> Option<usize> {
        self.beams.iter().position(|placed| placed.beam.name == name)
    }

    /// The connection of that name.
    pub fn connection_index(&self, name: &str) -> Option<usize> {
        self.connections.iter().position(|connection| connection.name == name)
    }

    /// The name of a joint, for example `b4j1`.
    pub fn joint_name(&self, joint: JointRef) -> &str {
        &self.beams[joint.beam].beam.joints[joint.joint].name
    }

    /// The hole of a joint at its place, on the beam's axis, in the assembly frame, m.
    pub fn p_a_hole(&self, joint: JointRef) -> Point3<f64> {
        let placed = &self.beams[joint.beam];
        placed.x_ab * placed.beam.p_b_hole(joint.joint)
    }

    /// The joints of `connection` on `beam` and on the other beam; `None` when the beam has no part in it.
    pub fn sides(&self, connection: &Connection, beam: usize) -> Option<(JointRef, JointRef)> {
        if connection.male.beam == beam {
            Some((connection.male, connection.female))
        } else if connection.female.beam == beam {
            Some((connection.female, connection.male))
        } else {
            None
        }
    }

    /// How often a beam passes through another one, and how many beams lie at an angle to X and Y.
    pub fn specials(&self) -> usize {
        let passes = |c: &&Connection| !self.beams[c.male.beam].beam.joints[c.male.joint].kind.is_end();
        let angled = |placed: &&PlacedBeam| {
            let along = placed.x_ab.rotation * Vector3::x();
            along.x.abs() > 1e-3 && along.y.abs() > 1e-3
        };
        self.connections.iter().filter(passes).count() + self.beams.iter().filter(angled).count()
    }

    /// The class that a goal like this one belongs to: easy ones are square and small, with at most four pegs;
    /// in a medium one a beam passes through another or lies at an angle once at most.
    pub fn likely_class(&self) -> Class {
        match self.specials() {
            0 if self.connections.len() <= 4 => Class::Easy,
            0 | 1 => Class::Medium,
            _ => Class::Hard,
        }
    }

    /// The connections, by index, in the order in which their pegs can go in: after each insertion those that it
    /// closes, in the order of the file.
    pub fn peg_order(&self) -> Vec<usize> {
        let mut standing = vec![false; self.beams.len()];
        standing[self.base] = true;
        let mut order = Vec::new();
        for insertion in &self.insertions {
            standing[insertion.beam] = true;
            let closed = |c: &Connection| {
                (c.female.beam == insertion.beam || c.male.beam == insertion.beam)
                    && standing[c.female.beam]
                    && standing[c.male.beam]
            };
            order.extend((0..self.connections.len()).filter(|&index| closed(&self.connections[index])));
        }
        order
    }
}
