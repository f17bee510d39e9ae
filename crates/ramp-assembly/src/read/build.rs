//! From the content of a goal file to an assembly: beams placed, overlaps checked, an order of
//! insertions found.

use super::components::Component;
use super::connections::Pair;
use super::problem::{GoalError, GoalProblem, Node, Result};
use crate::assembly::{Assembly, Class, Connection, JointRef, PlacedBeam};
use crate::check::{self, Overlap, Solids};
use crate::paths::Paths;
use crate::pose::{self, Misfit, Piece, Planar};
use ramp_kit::Kit;
use ramp_source::{Fault, SourceFile};
use std::sync::Arc;

/// A goal that has been read but not placed.
pub(super) struct Draft {
    pub(super) name: String,
    pub(super) class: Option<Class>,
    pub(super) components: Vec<Component>,
    pub(super) base: usize,
    pub(super) pairs: Vec<Pair>,
}

/// Places and checks everything; errors point at the file.
pub(super) fn build(file: &SourceFile, root: Node<'_>, kit: &Kit, draft: Draft) -> Result<Assembly> {
    let Draft { name, class, components, base, pairs } = draft;
    let pieces: Vec<Piece<'_>> = components
        .iter()
        .map(|c| Piece { beam: &kit.beams[c.beam], flipped: c.flipped, yaw: c.yaw })
        .collect();
    let connections: Vec<Connection> = pairs.iter().map(|pair| pair.connection.clone()).collect();
    let side = |joint: JointRef| (joint.beam, joint.joint);
    let ties: Vec<_> = connections.iter().map(|c| (side(c.female), side(c.male))).collect();
    let poses = pose::place(&pieces, base, &ties)
        .map_err(|misfit| explain(misfit, file, root, kit, &components, base, &pairs))?;
    let placed = |(component, pose): (&Component, &Planar)| PlacedBeam {
        beam: kit.beams[component.beam].clone(),
        flipped: component.flipped,
        x_ab: pose::x_ab(pose, component.flipped),
    };
    let beams: Vec<PlacedBeam> = components.iter().zip(&poses).map(placed).collect();
    let beam_name = |index: usize| beams[index].beam.name.clone();
    if let Some(overlap) = Solids::new(&beams).overlaps().first() {
        let (first, second) = (&components[overlap.first], &components[overlap.second]);
        let problem = GoalProblem::Overlap {
            first: beam_name(overlap.first),
            second: beam_name(overlap.second),
            depth: overlap.depth * 1e3,
            opening: opening(overlap, &beams, &connections),
        };
        let fault = Fault::new(problem, file.place(second.span.clone()));
        return Err(fault.also(first.span.clone(), "with this one"));
    }
    let paths = Paths::new(&beams, base, &connections);
    let insertions = check::find_order(&beams, base, &connections, &paths).map_err(|stuck| {
        let problem = GoalProblem::Stuck { beams: stuck.beams.iter().map(|&beam| beam_name(beam)).collect() };
        let mut spans = stuck.beams.iter().map(|&beam| components[beam].span.clone());
        let place = spans.next().unwrap_or_else(|| root.span());
        spans.fold(Fault::new(problem, file.place(place)), |fault, span| fault.also(span, "with this one"))
    })?;
    let (kit, paths) = (Arc::new(kit.clone()), Arc::new(paths));
    Ok(Assembly { name, class, kit, beams, base, connections, insertions, paths })
}

/// Advice when two connected beams overlap and the female is open to one side only.
fn opening(overlap: &Overlap, beams: &[PlacedBeam], connections: &[Connection]) -> Option<String> {
    let both = [overlap.first, overlap.second];
    let between = |c: &&Connection| both.contains(&c.female.beam) && both.contains(&c.male.beam);
    connections.iter().filter(between).find_map(|c| {
        let beam = &beams[c.female.beam].beam;
        let joint = &beam.joints[c.female.joint];
        let side = if joint.opens? == ramp_kit::Side::Left { "left" } else { "right" };
        Some(format!(
            "`{}` is open to the {side} of `{}` only: turn the beam with flipped=\"True\" or yaw=\"…\", or check \
             `opens` in the kit",
            joint.name, beam.name,
        ))
    })
}

/// A misfit in the terms of the file.
fn explain(
    misfit: Misfit,
    file: &SourceFile,
    root: Node<'_>,
    kit: &Kit,
    components: &[Component],
    base: usize,
    pairs: &[Pair],
) -> GoalError {
    let beam_name = |index: usize| kit.beams[components[index].beam].name.clone();
    let joint_name =
        |joint: JointRef| kit.beams[components[joint.beam].beam].joints[joint.joint].name.clone();
    let sides = |connection: usize| {
        let Connection { female, male, .. } = &pairs[connection].connection;
        (joint_name(*female), joint_name(*male))
    };
    let at = |connection: usize| file.place(pairs[connection].span.clone());
    match misfit {
        Misfit::Apart { connection, distance } => {
            let (female, male) = sides(connection);
            let problem = GoalProblem::HolesApart { female, male, distance: distance * 1e3 };
            Fault::new(problem, at(connection))
        }
        Misfit::Angle { connection, angle, limit } => {
            let (female, male) = sides(connection);
            let (angle, limit) = (angle.to_degrees(), limit.to_degrees());
            Fault::new(GoalProblem::Angle { female, male, angle, limit }, at(connection))
        }
        Misfit::Loose { beam } => {
            let problem = GoalProblem::Loose { beam: beam_name(beam), base: beam_name(base) };
            Fault::new(problem, file.place(components[beam].span.clone()))
        }
        Misfit::TooHard => root.fault(GoalProblem::TooHard),
    }
}
