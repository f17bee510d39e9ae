//! A beam: its joints and links in order, each with its measures.

use super::chain::{Chain, Raw};
use super::measure::{LENGTH, MM, point};
use super::names::Names;
use super::problem::{KitProblem, MAX_JOINTS, Node, Result};
use crate::beam::{Beam, Joint, Link, StartPose};
use crate::joint::Side;
use ramp_source::{nearest, shorten};

pub(super) fn read_beam(node: Node<'_>, names: &mut Names) -> Result<Beam> {
    node.check_attributes(&["name"])?;
    let name = names.take(&node.required("name")?)?;
    let mut start = None;
    let (mut joints, mut links) = (Vec::new(), Vec::new());
    for child in node.children(&["joint", "link", "start"])? {
        match child.tag() {
            "joint" => {
                child.check_attributes(&["name", "part", "marker", "opens"])?;
                let name = names.take(&child.required("name")?)?;
                joints.push(Raw::read(child, name, "link")?);
            }
            "link" => {
                child.check_attributes(&["name", "length"])?;
                let name = names.take(&child.required("name")?)?;
                links.push(Raw::read(child, name, "joint")?);
            }
            _ => {
                if start.is_some() {
                    return Err(child.fault(KitProblem::Twice { element: "start" }));
                }
                child.check_attributes(&["x", "y", "flipped"])?;
                let flipped = child.optional("flipped").map_or(Ok(false), |value| value.flag())?;
                start = Some(StartPose { at: point(child)?, flipped });
            }
        }
    }
    if !(2..=MAX_JOINTS).contains(&joints.len()) {
        return Err(node.fault(KitProblem::JointCount { beam: name, joints: joints.len() }));
    }
    let chain = Chain { beam: &name, joints: &joints, links: &links };
    chain.check()?;
    let order = chain.order(node)?;
    build_beam(&chain, &order, start, names)
}

fn build_beam(
    chain: &Chain<'_, '_>,
    (joint_order, link_order): &(Vec<usize>, Vec<usize>),
    start: Option<StartPose>,
    names: &mut Names,
) -> Result<Beam> {
    let mut joints: Vec<Joint> = Vec::new();
    let mut links: Vec<Link> = Vec::new();
    for (position, &index) in joint_order.iter().enumerate() {
        let raw = &chain.joints[index];
        let part = raw.node.required("part")?;
        let kind = names.part(part.text()).ok_or_else(|| {
            let near = nearest(part.text(), names.part_names()).map(str::to_string);
            part.fault(KitProblem::UnknownPart { found: shorten(part.text()), nearest: near })
        })?;
        let at_end = position == 0 || position + 1 == joint_order.len();
        if kind.is_end() != at_end {
            let place = if at_end { "at the end" } else { "in the middle" };
            return Err(part.fault(KitProblem::WrongPlace {
                joint: raw.name.clone(),
                part: kind.name(),
                place,
            }));
        }
        let opens = match raw.node.optional("opens") {
            None => kind.has_opening().then_some(Side::Left),
            Some(value) if !kind.has_opening() => {
                return Err(value.fault(KitProblem::NoOpening { part: kind.name() }));
            }
            Some(value) => Some(match value.text() {
                "left" => Side::Left,
                "right" => Side::Right,
                _ => return Err(value.bad_choice("left or right")),
            }),
        };
        // An empty marker means none.
        let marker = raw.node.optional("marker").filter(|value| !value.text().is_empty());
        let tag = marker.map(|value| names.take_tag(&value)).transpose()?;
        let mut offset = 0.0;
        if let Some(before) = joints.last() {
            let raw_link = &chain.links[link_order[position - 1]];
            let value = raw_link.node.required("length")?;
            let length = value.number(LENGTH, "mm")? * MM;
            // The part of the extrusion that each joint covers, from the floor of its socket on.
            let least: f64 =
                [before.kind, kind].iter().map(|kind| kind.top_cover() - kind.socket_offset()).sum();
            if length < least - 1e-9 {
                return Err(value.fault(KitProblem::ShortLink {
                    link: raw_link.name.clone(),
                    length: length / MM,
                    least: least / MM,
                }));
            }
            offset = before.offset + before.kind.socket_offset() + length + kind.socket_offset();
            let grasp = [before.offset + before.kind.top_cover(), offset - kind.top_cover()];
            links.push(Link { name: raw_link.name.clone(), length, grasp });
        }
        joints.push(Joint { name: raw.name.clone(), kind, offset, opens, tag });
    }
    Ok(Beam { name: chain.beam.to_string(), joints, links, start })
}
