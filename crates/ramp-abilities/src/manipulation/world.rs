//! The truth of the twin with the names of parts and joints.

use nalgebra::Point3;
use ramp_assembly::{Assembly, JointRef, Truth};
use ramp_kit::Pose;
use ramp_referee::Referee;
use ramp_twin::{Setup, Twin};

use super::task::Task;

/// The truth with names.
pub(super) struct NamedTruth<'t> {
    pub assembly: &'t Assembly,
    pub x_wa: Pose,
    names: Vec<&'t str>,
    truth: Truth,
}

impl<'t> NamedTruth<'t> {
    pub(super) fn of(setup: &Setup<'t>, twin: &'t Twin) -> NamedTruth<'t> {
        NamedTruth {
            assembly: setup.assembly,
            x_wa: setup.assembly.kit.x_wa(),
            names: twin.part_names().collect(),
            truth: twin.truth(),
        }
    }

    /// Pose of a part; the origin if no part has that name.
    pub(super) fn part(&self, name: &str) -> Pose {
        let index = self.names.iter().position(|other| *other == name);
        index.and_then(|index| self.truth.x_wp.get(index)).copied().unwrap_or_default()
    }

    /// Position of a hole.
    pub(super) fn hole(&self, joint: JointRef) -> Point3<f64> {
        let beam = &self.assembly.beams[joint.beam].beam;
        self.part(&beam.name) * beam.p_b_hole(joint.joint)
    }

    /// Position of a point of a beam (m, in its frame) with the beam in its goal pose.
    pub(super) fn nominal(&self, beam: usize, p_b: &Point3<f64>) -> Point3<f64> {
        self.x_wa * self.assembly.beams[beam].x_ab * p_b
    }

    /// Name of a joint.
    pub(super) fn name(&self, joint: JointRef) -> &str {
        self.assembly.joint_name(joint)
    }
}

/// The joints of a beam that meet those of beams that stand at their places, and that no peg pins, each with
/// the other.
pub(super) fn open_joints(task: &Task, world: &NamedTruth, beam: usize) -> Vec<(JointRef, JointRef)> {
    let build = &task.build;
    let assembly = world.assembly;
    let connections = assembly.connections.iter().enumerate();
    let open = connections.filter(|(index, _)| build.pinned.iter().all(|(pinned, _)| pinned != index));
    open.filter_map(|(_, connection)| assembly.sides(connection, beam))
        .filter(|(_, theirs)| build.stands_at_its_place(theirs.beam) || theirs.beam == assembly.base)
        .collect()
}

/// Distance from j1, m, of the end of a beam that is further from the joint that a peg pins; without one, the
/// last.
pub(super) fn far_end(task: &Task, assembly: &Assembly, beam: usize) -> f64 {
    let placed = &assembly.beams[beam].beam;
    match task.build.anchor(assembly, beam) {
        Some(joint) if placed.joints[joint.joint].offset > placed.span() / 2.0 => 0.0,
        _ => placed.span(),
    }
}

/// The pegs that pin the connections of a goal now, by the referee's rule.
pub(super) fn pegs_in(setup: &Setup, twin: &Twin) -> Vec<Option<String>> {
    let mut referee = Referee::new(setup.assembly, twin.part_names());
    referee.watch(&twin.truth(), 0.0);
    referee.verdict().iter().map(|seated| seated.as_ref().map(|seated| seated.peg.clone())).collect()
}
