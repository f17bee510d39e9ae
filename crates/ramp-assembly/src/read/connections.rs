//! The connections of a goal: each a female and a male of two of its beams.

use super::components::Component;
use super::problem::{GoalProblem, Node, Result};
use crate::assembly::{Connection, JointRef};
use ramp_kit::Kit;
use ramp_source::{nearest, shorten};
use std::collections::HashMap;
use std::ops::Range;

/// A connection as in the file.
pub(super) struct Pair {
    pub(super) connection: Connection,
    pub(super) span: Range<usize>,
}

/// All connections, in the order of the file.
pub(super) fn read_connections(
    root: Node<'_>,
    nodes: &[Node<'_>],
    kit: &Kit,
    components: &[Component],
) -> Result<Vec<Pair>> {
    let mut pairs: Vec<Pair> = Vec::new();
    let mut names: HashMap<String, Range<usize>> = HashMap::new();
    let mut used: HashMap<JointRef, (String, Range<usize>)> = HashMap::new();
    for node in nodes {
        node.check_attributes(&["name"])?;
        let value = node.required("name")?;
        let name = value.name()?.to_string();
        if let Some(first) = names.insert(name.clone(), value.span()) {
            let problem = GoalProblem::DuplicateConnection { name };
            return Err(value.fault(problem).also(first, "first here"));
        }
        let elements = node.children(&["element"])?;
        let [first, second] = elements.as_slice() else {
            let problem = GoalProblem::Elements { connection: name, found: elements.len() };
            // The third element is one too many; with fewer there is only the connection to point
            // at.
            return Err(elements.get(2).unwrap_or(node).fault(problem));
        };
        let mut joints = Vec::new();
        for element in [first, second] {
            let joint = read_element(*element, kit, components)?;
            let value = element.required("joint")?;
            if let Some((first, at)) = used.insert(joint, (name.clone(), value.span())) {
                let problem = GoalProblem::JointTwice { joint: value.text().to_string(), first };
                return Err(value.fault(problem).also(at, "first here"));
            }
            joints.push(joint);
        }
        let (first_joint, second_joint) = (joints[0], joints[1]);
        let joint = |joint: JointRef| &kit.beams[components[joint.beam].beam].joints[joint.joint];
        if first_joint.beam == second_joint.beam {
            let beam = kit.beams[components[first_joint.beam].beam].name.clone();
            return Err(second.fault(GoalProblem::SameBeam { connection: name, beam }));
        }
        let (female, male) = match (joint(first_joint).kind.is_male(), joint(second_joint).kind.is_male()) {
            (false, true) => (first_joint, second_joint),
            (true, false) => (second_joint, first_joint),
            (both, _) => {
                let words = |at: JointRef| format!("`{}` ({})", joint(at).name, joint(at).kind.name());
                let problem = GoalProblem::SameKind {
                    connection: name,
                    kind: if both { "male" } else { "female" },
                    first: words(first_joint),
                    second: words(second_joint),
                };
                return Err(second.fault(problem).also(first.span(), "with this one"));
            }
        };
        pairs.push(Pair { connection: Connection { name, female, male }, span: node.span() });
    }
    if pairs.is_empty() {
        return Err(root.fault(GoalProblem::NoConnections));
    }
    Ok(pairs)
}

/// The joint that an element names.
fn read_element(node: Node<'_>, kit: &Kit, components: &[Component]) -> Result<JointRef> {
    node.check_attributes(&["component", "joint"])?;
    let value = node.required("component")?;
    let known = components.iter().position(|component| kit.beams[component.beam].name == value.text());
    let Some(beam) = known else {
        let found = shorten(value.text());
        if kit.beam(value.text()).is_some() {
            return Err(value.fault(GoalProblem::NotDeclared { beam: found }));
        }
        let names = components.iter().map(|component| kit.beams[component.beam].name.as_str());
        let nearest = nearest(value.text(), names).map(str::to_string);
        return Err(value.fault(GoalProblem::UnknownBeam { found, nearest }));
    };
    let value = node.required("joint")?;
    let own = &kit.beams[components[beam].beam];
    match own.joint_index(value.text()) {
        Some(joint) => Ok(JointRef { beam, joint }),
        None => {
            let owner = kit.beams.iter().find(|beam| beam.joint_index(value.text()).is_some());
            let near = nearest(value.text(), own.joints.iter().map(|joint| joint.name.as_str()));
            Err(value.fault(GoalProblem::UnknownJoint {
                found: shorten(value.text()),
                beam: own.name.clone(),
                owner: owner.map(|beam| beam.name.clone()),
                nearest: near.map(str::to_string),
            }))
        }
    }
}
