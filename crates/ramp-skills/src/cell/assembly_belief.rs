//! The assembly as the agent believes it: poses of the parts, standing beams, pinned connections. What
//! follows from them by geometry alone is in the files beside this one: targets, alignment, drooping beams,
//! holes and pegs.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::Point3;
use ramp_assembly::{Assembly, JointRef};
use ramp_robot::arm::ArmModel;
use ramp_world::Start;

use crate::belief::Belief;
use crate::insertion_path::InsertionPath;
use crate::parameters::Parameters;

/// A point of a part: its name, and the point in its frame, m.
pub type Point = (String, Point3<f64>);

/// The assembly as the agent believes it.
pub struct AssemblyBelief<'a> {
    /// The goal.
    pub assembly: &'a Assembly,
    /// Poses of the parts.
    pub parts: Belief,
    /// Beams that stand in the assembly, by index, the base among them.
    pub standing: Vec<usize>,
    /// The beams that stand deeper than their place, by index, until they are slid forward.
    pub deep: Vec<usize>,
    /// Pinned connections, by index, each with its peg.
    pub pinned: Vec<(usize, String)>,
    /// Connections whose peg has come to stand on the male, by index: their holes are further apart than they
    /// seem.
    pub apart: Vec<usize>,
    /// Insertion paths of the plan, by index of the beam.
    pub paths: BTreeMap<usize, InsertionPath>,
    pub(super) parameters: Arc<Parameters>,
}

impl<'a> AssemblyBelief<'a> {
    /// Nothing stands but the clamped beam.
    pub fn new(
        assembly: &'a Assembly,
        arm: &ArmModel,
        parameters: &Arc<Parameters>,
        start: &Start,
    ) -> AssemblyBelief<'a> {
        AssemblyBelief {
            assembly,
            parts: Belief::new(assembly, arm, parameters, start),
            standing: vec![assembly.base],
            deep: Vec::new(),
            pinned: Vec::new(),
            apart: Vec::new(),
            paths: BTreeMap::new(),
            parameters: parameters.clone(),
        }
    }

    /// The middle of a part.
    pub fn middle(&self, part: &str) -> Point {
        let x = self.assembly.kit.beam(part).map_or(0.0, |beam| beam.span() / 2.0);
        (part.to_string(), Point3::new(x, 0.0, 0.0))
    }

    /// The hole of a joint of the assembly.
    pub fn hole(&self, joint: JointRef) -> Point {
        let beam = &self.assembly.beams[joint.beam].beam;
        (beam.name.clone(), beam.p_b_hole(joint.joint))
    }
}
