//! The components of a goal: its beams, and the base among them.

use super::problem::{GoalProblem, Node, Result};
use crate::check::MAX_BEAMS;
use ramp_kit::Kit;
use ramp_source::{nearest, shorten};
use std::ops::Range;

/// A component as it stands in the file.
pub(super) struct Component {
    /// Index into the kit's beams.
    pub(super) beam: usize,
    pub(super) flipped: bool,
    pub(super) yaw: Option<f64>,
    pub(super) span: Range<usize>,
}

/// All components, and the index of the base.
pub(super) fn read_components(
    root: Node<'_>,
    nodes: &[Node<'_>],
    kit: &Kit,
) -> Result<(Vec<Component>, usize)> {
    let mut components: Vec<Component> = Vec::new();
    let mut base: Option<usize> = None;
    for node in nodes {
        node.check_attributes(&["beam", "base", "flipped", "yaw"])?;
        let value = node.required("beam")?;
        let Some(beam) = kit.beams.iter().position(|beam| beam.name == value.text()) else {
            let near = nearest(value.text(), kit.beams.iter().map(|beam| beam.name.as_str()));
            let found = shorten(value.text());
            return Err(value.fault(GoalProblem::UnknownBeam { found, nearest: near.map(str::to_string) }));
        };
        let beam_name = kit.beams[beam].name.clone();
        if let Some(first) = components.iter().find(|component| component.beam == beam) {
            let first = first.span.clone();
            let problem = GoalProblem::DuplicateBeam { beam: beam_name };
            return Err(value.fault(problem).also(first, "first here"));
        }
        let flipped = node.optional("flipped").map_or(Ok(false), |value| value.flag())?;
        let yaw = node.optional("yaw");
        let degrees = yaw.as_ref().map(|value| value.number(-360.0..=360.0, "degrees")).transpose()?;
        let is_base = node.optional("base").map_or(Ok(false), |value| value.flag())?;
        if is_base {
            if let Some(first) = base {
                let first = &components[first];
                let problem =
                    GoalProblem::TwoBases { first: kit.beams[first.beam].name.clone(), second: beam_name };
                return Err(node.fault(problem).also(first.span.clone(), "the first base"));
            }
            // Only a kit with the start poses of its beams defines the clamped one.
            if kit.beams[beam].start.is_some() {
                let clamped = kit.beams.iter().find(|beam| beam.start.is_none());
                let problem = GoalProblem::BaseNotClamped {
                    found: beam_name,
                    clamped: clamped.map(|beam| beam.name.clone()),
                };
                return Err(node.fault(problem));
            }
            if let Some(value) = yaw {
                return Err(value.fault(GoalProblem::BaseYaw));
            }
            base = Some(components.len());
        }
        components.push(Component { beam, flipped, yaw: degrees.map(f64::to_radians), span: node.span() });
    }
    if components.len() > MAX_BEAMS {
        return Err(nodes[MAX_BEAMS].fault(GoalProblem::TooManyBeams { found: components.len() }));
    }
    match base {
        Some(base) => Ok((components, base)),
        None => Err(root.fault(GoalProblem::NoBase)),
    }
}
