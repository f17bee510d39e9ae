//! Input of the rules: the goal, the kit and the state as ground facts.
//!
//! `docs/src/reference/action-language.md` lists them. Lengths are rounded to millimetres, because
//! the rules only support integers.

use crate::geometry::Geometry;
use ramp_action_language::Term;
use ramp_assembly::paths::middle;
use ramp_assembly::{Assembly, Connection, JointRef};
use ramp_kit::JointType;

/// The beams and connections of a goal and the insertion paths of the beams, for the order and the
/// coarse domain.
pub(crate) fn coarse(assembly: &Assembly, geometry: &Geometry) -> Vec<Term> {
    let mut facts = Vec::new();
    let beam = |index: usize| beam_name(assembly, index);
    let mut ways: Vec<&str> = Vec::new();
    for (index, placed) in assembly.beams.iter().enumerate() {
        facts.push(Term::new("beam", [beam(index)]));
        if index == assembly.base {
            facts.push(Term::new("base", [beam(index)]));
            continue;
        }
        if !placed.beam.stands_at_assembled_height() {
            facts.push(Term::new("low", [beam(index)]));
        }
        let links = &placed.beam.links;
        let (stands, pinned) = (vec![false; assembly.beams.len()], vec![false; assembly.connections.len()]);
        let start = |link| geometry.graspable_at_start(index, link, &stands);
        let place = |link| geometry.graspable_at_place(index, link, &stands, &pinned);
        if !links.iter().any(|link| start(link) && place(link))
            && links.iter().any(start)
            && links.iter().any(place)
        {
            facts.push(Term::new("awkward", [beam(index)]));
        }
        for other in geometry.motion.grasps_barred_by(index) {
            let mut alone = stands.clone();
            alone[other] = true;
            let graspable = |link| geometry.graspable_at_place(index, link, &alone, &pinned);
            if !links.iter().any(graspable) {
                facts.push(Term::new("bars", [beam(other), beam(index)]));
            }
        }
        for (number, way) in geometry.paths.ways(index).iter().enumerate() {
            if !ways.contains(&way.name) {
                ways.push(way.name);
            }
            if geometry.motion.closed_by(index, number).any(|past| past.is_none()) {
                continue;
            }
            facts.push(Term::new("entry", [beam(index), way.name.into()]));
            for past in geometry.motion.closed_by(index, number).flatten() {
                let fact = if past.stands { "blocked" } else { "waits" };
                facts.push(Term::new(fact, [beam(index), way.name.into(), beam(past.beam)]));
            }
            for other in geometry.paths.blocked(index, number) {
                facts.push(Term::new("blocked", [beam(index), way.name.into(), beam(other)]));
            }
        }
    }
    facts.extend(ways.into_iter().map(|way| Term::new("way", [way.into()])));
    for (index, connection) in assembly.connections.iter().enumerate() {
        let name = connection_name(assembly, index);
        let (female, male) = (connection.female, connection.male);
        facts.push(Term::new("connection", [name.clone()]));
        facts.push(Term::new("joins", [name.clone(), beam(female.beam), beam(male.beam)]));
        facts.push(Term::new("joins", [name.clone(), beam(male.beam), beam(female.beam)]));
        facts.push(Term::new("enters", [beam(male.beam), beam(female.beam)]));
        if !kind(assembly, male).is_end() {
            facts.push(Term::new("passes", [beam(male.beam), beam(female.beam)]));
        }
        if is_tight(assembly, index) {
            facts.push(Term::new("tight", [name]));
        }
    }
    for &(connection, past) in &geometry.motion.fastenings {
        if let Some(past) = past.filter(|past| past.stands) {
            facts.push(Term::new("hides", [beam(past.beam), connection_name(assembly, connection)]));
        }
    }
    for shuttle in &geometry.shuttles {
        facts.push(Term::new("shuttle", [beam(shuttle.beam), beam(shuttle.cap)]));
    }
    facts
}

/// Whether the female of a connection holds the male within a play of 1.3°. A long one and one at
/// an end of its beam do not.
pub(crate) fn is_tight(assembly: &Assembly, connection: usize) -> bool {
    let form = kind(assembly, assembly.connections[connection].female).form();
    !form.male && !form.end && form.cavity < 1.5 * JointType::ThruF.form().cavity
}

/// The parts of some beams, for the fine domain, in addition to the coarse facts. Beams that the
/// hand moves have all joints with their measures and their possible grasps; the others only the
/// joints that meet them. Placed beams and pegs restrict the grasps.
pub(crate) fn fine(
    assembly: &Assembly,
    geometry: &Geometry,
    beams: &[usize],
    handled: &dyn Fn(usize) -> bool,
    stands: &[bool],
    pinned: &[bool],
) -> Vec<Term> {
    let mut facts = Vec::new();
    let among = |connection: &&Connection| {
        [connection.male.beam, connection.female.beam].iter().all(|beam| beams.contains(beam))
    };
    let mates: Vec<JointRef> =
        assembly.connections.iter().filter(among).flat_map(|it| [it.male, it.female]).collect();
    for &index in beams {
        let placed = &assembly.beams[index];
        let beam = beam_name(assembly, index);
        let last = placed.beam.joints.len().saturating_sub(1);
        let mm = |length: f64| Term::Number((length * 1e3).round() as i64);
        for (number, joint) in placed.beam.joints.iter().enumerate() {
            if !handled(index) && !mates.contains(&JointRef { beam: index, joint: number }) {
                continue;
            }
            let name = Term::from(joint.name.as_str());
            facts.push(Term::new("joint", [name.clone()]));
            facts.push(Term::new("component", [name.clone(), beam.clone()]));
            if joint.kind.is_male() && !joint.kind.is_end() {
                facts.push(Term::new("through_joint", [name.clone()]));
            }
            if number == 0 || number == last {
                facts.push(Term::new("tip", [name.clone()]));
            }
            for (other_number, other) in placed.beam.joints.iter().enumerate().filter(|_| handled(index)) {
                let other_name = Term::from(other.name.as_str());
                let apart = mm((joint.offset - other.offset).abs());
                facts.push(Term::new("apart", [name.clone(), other_name.clone(), apart]));
                if number > other_number {
                    facts.push(Term::new("later", [name.clone(), other_name]));
                }
            }
        }
        for link in placed.beam.links.iter().filter(|_| handled(index)) {
            let name = Term::from(link.name.as_str());
            facts.push(Term::new("link", [name.clone()]));
            facts.push(Term::new("component", [name.clone(), beam.clone()]));
            for joint in &placed.beam.joints {
                let distance = mm((middle(link) - joint.offset).abs());
                facts.push(Term::new("distance", [name.clone(), joint.name.as_str().into(), distance]));
            }
            let leverage = mm((middle(link) - placed.beam.span() / 2.0).abs());
            facts.push(Term::new("leverage", [name.clone(), leverage]));
            if geometry.graspable_at_start(index, link, stands) {
                facts.push(Term::new("graspable", [name.clone(), Term::new("start", [])]));
            }
            if geometry.graspable_at_place(index, link, stands, pinned) {
                facts.push(Term::new("graspable", [name.clone(), Term::new("place", [])]));
            }
        }
        if !placed.is_square() {
            facts.push(Term::new("slanted", [beam]));
        }
    }
    for (index, connection) in assembly.connections.iter().enumerate() {
        if !among(&connection) {
            continue;
        }
        let joint = |joint: JointRef| Term::from(assembly.joint_name(joint));
        facts.push(Term::new(
            "mates",
            [connection_name(assembly, index), joint(connection.male), joint(connection.female)],
        ));
    }
    facts
}

fn kind(assembly: &Assembly, joint: JointRef) -> JointType {
    assembly.beams[joint.beam].beam.joints[joint.joint].kind
}

/// The connections of a beam, each with the beam at its other side, by index.
pub(crate) fn partners(assembly: &Assembly, beam: usize) -> impl Iterator<Item = (usize, usize)> {
    assembly
        .connections
        .iter()
        .enumerate()
        .filter_map(move |(index, connection)| Some((index, assembly.sides(connection, beam)?.1.beam)))
}

pub(crate) fn beam_name(assembly: &Assembly, index: usize) -> Term {
    assembly.beams[index].beam.name.as_str().into()
}

pub(crate) fn connection_name(assembly: &Assembly, index: usize) -> Term {
    assembly.connections[index].name.as_str().into()
}

/// `beam("b4")`, an item.
pub(crate) fn beam_item(assembly: &Assembly, index: usize) -> Term {
    Term::new("beam", [beam_name(assembly, index)])
}

/// `peg("C1")`, the peg of a connection.
pub(crate) fn peg_item(assembly: &Assembly, index: usize) -> Term {
    Term::new("peg", [connection_name(assembly, index)])
}
