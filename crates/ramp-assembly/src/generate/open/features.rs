//! The features by which the difficulty of a goal is stated.

use crate::assembly::{Assembly, Connection};
use nalgebra::Vector3;
use std::collections::BTreeSet;

/// Directions that differ by less than this count as one; the cosine of 1°.
const SAME_DIRECTION: f64 = 0.999_847_7;
/// A beam is oblique if both components of its unit vector exceed this.
const OBLIQUE: f64 = 1e-3;
/// Angles of oblique beams are told apart by steps of this width, degrees.
const ANGLE_STEP: f64 = 5.0;

/// Features of a goal. They say what makes it difficult.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Features {
    /// Beams, the clamped one included.
    pub beams: usize,
    /// Pegs: one for each connection.
    pub pegs: usize,
    /// Beams that lie neither along X nor along Y.
    pub oblique: usize,
    /// Connections in which a beam passes through another one.
    pub through: usize,
    /// Beams that are put over the ends of standing beams.
    pub caps: usize,
    /// Closed loops of beams: pegs − beams + 1.
    pub loops: usize,
    /// Different directions of insertion.
    pub directions: usize,
    /// Joint types in its connections.
    pub joint_types: usize,
}

impl Features {
    /// The features of a goal, with the order of insertions of the goal.
    pub fn of(assembly: &Assembly) -> Features {
        let passes = |c: &&Connection| !assembly.beams[c.male.beam].beam.joints[c.male.joint].kind.is_end();
        let mut directions: Vec<Vector3<f64>> = Vec::new();
        let mut standing = vec![false; assembly.beams.len()];
        standing[assembly.base] = true;
        let mut caps = 0;
        for insertion in &assembly.insertions {
            let direction = insertion.direction.into_inner();
            if directions.iter().all(|known| known.dot(&direction) < SAME_DIRECTION) {
                directions.push(direction);
            }
            let over = |c: &Connection| c.female.beam == insertion.beam && standing[c.male.beam];
            caps += usize::from(assembly.connections.iter().any(over));
            standing[insertion.beam] = true;
        }
        let (beams, pegs) = (assembly.beams.len(), assembly.connections.len());
        Features {
            beams,
            pegs,
            oblique: (0..beams).filter(|&beam| oblique_yaw(assembly, beam).is_some()).count(),
            through: assembly.connections.iter().filter(passes).count(),
            caps,
            loops: (pegs + 1).saturating_sub(beams),
            directions: directions.len(),
            joint_types: joint_types(assembly).len(),
        }
    }
}

/// The yaw of a beam that is oblique, degrees from 0 to 180.
fn oblique_yaw(assembly: &Assembly, beam: usize) -> Option<f64> {
    let along = assembly.beams[beam].x_ab.rotation * Vector3::x();
    let is_oblique = along.x.abs() > OBLIQUE && along.y.abs() > OBLIQUE;
    is_oblique.then(|| along.y.atan2(along.x).to_degrees().rem_euclid(180.0))
}

/// The joint types in the connections of a goal.
fn joint_types(assembly: &Assembly) -> BTreeSet<&'static str> {
    let joints = assembly.connections.iter().flat_map(|c| [c.female, c.male]);
    joints.map(|it| assembly.beams[it.beam].beam.joints[it.joint].kind.name()).collect()
}

/// The use that a goal makes of the kit: its connected joints, their types, and the angles of its oblique
/// beams.
pub(super) fn parts(assembly: &Assembly) -> BTreeSet<String> {
    let joints = assembly.connections.iter().flat_map(|c| [c.female, c.male]);
    let joints = joints.map(|it| assembly.joint_name(it).to_string());
    let types = joint_types(assembly).into_iter().map(|name| format!("type {name}"));
    let yaws = (0..assembly.beams.len()).filter_map(|beam| oblique_yaw(assembly, beam));
    let angles = yaws.map(|yaw| format!("angle {}", (yaw / ANGLE_STEP).round()));
    joints.chain(types).chain(angles).collect()
}
