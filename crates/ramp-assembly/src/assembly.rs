//! An assembly: the goal pose of every beam, and the joints that are to be pinned.

pub use crate::class::{Class, OpenSet, Size};
use crate::paths::Paths;
pub use crate::placed::{Connection, Insertion, JointRef, PlacedBeam};
use nalgebra::{Point3, Vector3};
use ramp_kit::Kit;
use std::sync::Arc;

/// A placed goal: the input of the planner, the skills, the twin and the referee.
#[derive(Clone, Debug)]
pub struct Assembly {
    /// The goal's name, for example `easy-3`, or the stem of its file.
    pub name: String,
    /// Its class; `None` for a goal without one.
    pub class: Option<Class>,
    /// The kit that its beams and pegs are taken from.
    pub kit: Arc<Kit>,
    /// The beams, in the order of the file.
    pub beams: Vec<PlacedBeam>,
    /// Index into `beams` of the beam that is clamped to the table.
    pub base: usize,
    /// The connections, in the order of the file.
    pub connections: Vec<Connection>,
    /// A collision-free order of straight insertions that builds it, without the base.
    pub insertions: Vec<Insertion>,
    /// The insertion directions of each beam and the beams that block them.
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

    /// The hole of a joint in its goal pose, on the beam's axis, in the assembly frame, m.
    pub fn p_a_hole(&self, joint: JointRef) -> Point3<f64> {
        let placed = &self.beams[joint.beam];
        placed.x_ab * placed.beam.p_b_hole(joint.joint)
    }

    /// The joints of `connection` on `beam` and on the other beam; `None` when the beam is not part
    /// of it.
    pub fn sides(&self, connection: &Connection, beam: usize) -> Option<(JointRef, JointRef)> {
        if connection.male.beam == beam {
            Some((connection.male, connection.female))
        } else if connection.female.beam == beam {
            Some((connection.female, connection.male))
        } else {
            None
        }
    }

    /// Number of through passages of a beam, plus the number of beams oblique to X and Y.
    pub fn specials(&self) -> usize {
        let passes = |c: &&Connection| !self.beams[c.male.beam].beam.joints[c.male.joint].kind.is_end();
        let angled = |placed: &&PlacedBeam| {
            let along = placed.x_ab.rotation * Vector3::x();
            along.x.abs() > 1e-3 && along.y.abs() > 1e-3
        };
        self.connections.iter().filter(passes).count() + self.beams.iter().filter(angled).count()
    }

    /// The one of the paper's three classes that fits its features. Easy: square, small, at most four
    /// pegs. Medium: at most one beam that passes through another or lies obliquely.
    pub fn likely_class(&self) -> Class {
        match self.specials() {
            0 if self.connections.len() <= 4 => Class::Easy,
            0 | 1 => Class::Medium,
            _ => Class::Hard,
        }
    }

    /// The connections, by index, in an order in which their pegs can be inserted: after each
    /// insertion the connections that it closes, in the order of the file.
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
