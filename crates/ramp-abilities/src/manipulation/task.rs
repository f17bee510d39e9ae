//! A step of a plan as a task of its own: what stands before it, and what is to be true after it.

use nalgebra::Vector3;
use ramp_assembly::{Assembly, JointRef};

/// A step of a plan, to be done alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// Name of the skill.
    pub skill: String,
    /// Which coarse step of the goal's plan it is, from 1.
    pub step: usize,
    /// The step, for a person.
    pub action: String,
    /// The build before it.
    pub build: Build,
    /// Its goal.
    pub aim: Aim,
}

/// The built part of a goal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Build {
    /// Beams that stand, without the base, as indices into [`Assembly::beams`].
    pub standing: Vec<usize>,
    /// Those of them that stand deeper than their place, and by how much: axes of the assembly frame, m.
    pub deep: Vec<(usize, Vector3<f64>)>,
    /// Those of them that the planner holds to be out of line.
    pub misaligned: Vec<usize>,
    /// Connections that are pinned, as indices into [`Assembly::connections`], and by which peg.
    pub pinned: Vec<(usize, String)>,
}

impl Build {
    /// Does a beam other than the base stand where it is to stay?
    pub fn stands_at_its_place(&self, beam: usize) -> bool {
        self.standing.contains(&beam) && self.deep.iter().all(|(deep, _)| *deep != beam)
    }

    /// The joint of a beam that a peg pins, if any.
    pub fn anchor(&self, assembly: &Assembly, beam: usize) -> Option<JointRef> {
        let mut pinned = self.pinned.iter();
        pinned.find_map(|(index, _)| Some(assembly.sides(&assembly.connections[*index], beam)?.0))
    }
}

/// The goal of a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Aim {
    /// This peg is in the hand, out of its holder.
    Held {
        /// Its name.
        peg: String,
    },
    /// A peg pins this connection, by the referee's rule.
    Pinned {
        /// Index into [`Assembly::connections`].
        connection: usize,
    },
    /// A peg can pin these connections.
    Placed {
        /// Indices into [`Assembly::connections`].
        connections: Vec<usize>,
    },
    /// This beam stands deeper than its place, by so much.
    Deep {
        /// Index into [`Assembly::beams`].
        beam: usize,
        /// From its place, axes of the assembly frame, m.
        shift: Vector3<f64>,
    },
    /// This beam lies at its place with nothing to hold it.
    Laid {
        /// Index into [`Assembly::beams`].
        beam: usize,
    },
    /// The joints of this beam that are not pinned are where a peg can pin them; without any, its far end is
    /// at its place.
    Straight {
        /// Index into [`Assembly::beams`].
        beam: usize,
    },
}
