//! The order of joints and links along a beam, which the file defines by parents and children.

use super::problem::{KitProblem, Node, Result, Text};
use ramp_source::{nearest, shorten};
use std::collections::{HashMap, HashSet};

/// A joint or link as in the file, before the beam is put in order.
pub(super) struct Raw<'a> {
    pub(super) node: Node<'a>,
    pub(super) name: String,
    pub(super) parent: Option<Text<'a>>,
    pub(super) child: Option<Text<'a>>,
}

impl<'a> Raw<'a> {
    /// `other` is the kind of its neighbours: `link` for a joint, `joint` for a link.
    pub(super) fn read(node: Node<'a>, name: String, other: &'static str) -> Result<Raw<'a>> {
        let mut raw = Raw { node, name, parent: None, child: None };
        for neighbour in node.children(&["parent", "child"])? {
            neighbour.check_attributes(&[other])?;
            let value = neighbour.required(other)?;
            let (slot, role) = match neighbour.tag() {
                "parent" => (&mut raw.parent, "parent"),
                _ => (&mut raw.child, "child"),
            };
            if let Some(first) = slot {
                let first = first.span();
                let problem = KitProblem::Branch { from: raw.name.clone(), role };
                return Err(neighbour.fault(problem).also(first, "the first"));
            }
            *slot = Some(value);
        }
        Ok(raw)
    }

    /// The neighbour that it names as its parent or child.
    pub(super) fn neighbour(&self, role: &str) -> Option<&Text<'a>> {
        if role == "parent" { self.parent.as_ref() } else { self.child.as_ref() }
    }
}

/// The joints and links of one beam, as in the file.
pub(super) struct Chain<'c, 'a> {
    pub(super) beam: &'c str,
    pub(super) joints: &'c [Raw<'a>],
    pub(super) links: &'c [Raw<'a>],
}

impl Chain<'_, '_> {
    /// Checks that every joint and link names existing neighbours that name it in return.
    pub(super) fn check(&self) -> Result<()> {
        for link in self.links {
            for role in ["parent", "child"] {
                if link.neighbour(role).is_none() {
                    return Err(link.node.fault(KitProblem::OpenLink { link: link.name.clone(), role }));
                }
            }
        }
        self.check_side(self.joints, self.links, "link")?;
        self.check_side(self.links, self.joints, "joint")
    }

    fn check_side(&self, own: &[Raw<'_>], others: &[Raw<'_>], expected: &'static str) -> Result<()> {
        let by_name: HashMap<&str, &Raw<'_>> = others.iter().map(|raw| (raw.name.as_str(), raw)).collect();
        for raw in own {
            for (role, back) in [("parent", "child"), ("child", "parent")] {
                let Some(value) = raw.neighbour(role) else { continue };
                let names_us = |other: &Raw<'_>| other.neighbour(back).is_some_and(|b| b.text() == raw.name);
                match by_name.get(value.text()) {
                    Some(other) if names_us(other) => {}
                    Some(other) => {
                        let (from, to) = (raw.name.clone(), other.name.clone());
                        return Err(value.fault(KitProblem::OneSided { from, role, to }));
                    }
                    None => {
                        // The neighbour that names us in return is a better suggestion than any
                        // similar name.
                        let in_return = others.iter().find(|other| names_us(other)).map(|o| o.name.as_str());
                        let similar =
                            || nearest(value.text(), others.iter().map(|other| other.name.as_str()));
                        return Err(value.fault(KitProblem::UnknownNeighbour {
                            from: raw.name.clone(),
                            role,
                            expected,
                            found: shorten(value.text()),
                            beam: self.beam.to_string(),
                            nearest: in_return.or_else(similar).map(str::to_string),
                        }));
                    }
                }
            }
        }
        Ok(())
    }

    /// The joints from the first to the last with the links between them, as indices.
    pub(super) fn order(&self, node: Node<'_>) -> Result<(Vec<usize>, Vec<usize>)> {
        let beam = self.beam.to_string();
        let Some(first) = self.joints.iter().position(|joint| joint.parent.is_none()) else {
            return Err(node.fault(KitProblem::Loop { beam }));
        };
        let index = |raws: &[Raw<'_>]| -> HashMap<String, usize> {
            raws.iter().enumerate().map(|(index, raw)| (raw.name.clone(), index)).collect()
        };
        let (joint_at, link_at) = (index(self.joints), index(self.links));
        let (mut joints, mut links) = (vec![first], Vec::new());
        let mut reached = HashSet::from([first]);
        let mut at = first;
        while let Some(&link) = self.joints[at].child.as_ref().and_then(|child| link_at.get(child.text())) {
            let Some(&next) = self.links[link].child.as_ref().and_then(|child| joint_at.get(child.text()))
            else {
                break;
            };
            // Neighbours name each other and the first has no parent, so this walk visits no joint
            // twice; the check guarantees that it ends.
            if !reached.insert(next) {
                return Err(node.fault(KitProblem::Loop { beam }));
            }
            links.push(link);
            joints.push(next);
            at = next;
        }
        match (0..self.joints.len()).find(|index| !reached.contains(index)) {
            None => Ok((joints, links)),
            Some(lost) => {
                let (first, joint) = (self.joints[first].name.clone(), self.joints[lost].name.clone());
                Err(self.joints[lost].node.fault(KitProblem::Split { beam, first, joint }))
            }
        }
    }
}
