//! What the rules are told of the goal, the kit and the state: ground facts.
//!
//! Every rule file begins with the list of the facts that it reads. Lengths in them are whole micrometres, because
//! clingo knows whole numbers only.

use crate::state::Known;
use crate::term::Term;
use ramp_assembly::{Assembly, JointRef};
use ramp_kit::{Beam, Kit, Pose};

/// The beams and connections of a goal, for the order and for the coarse actions.
pub(crate) fn goal(assembly: &Assembly) -> Vec<Term> {
    let mut facts = Vec::new();
    for placed in &assembly.beams {
        facts.push(Term::new("beam", [placed.beam.name.as_str().into()]));
        joints(&mut facts, &placed.beam);
    }
    facts.push(Term::new("base", [beam_name(assembly, assembly.base)]));
    for index in 0..assembly.connections.len() {
        connection(&mut facts, assembly, index);
        facts.push(Term::new("rank", [connection_name(assembly, index), index.into()]));
    }
    facts
}

/// The proven order, and what stands already.
pub(crate) fn order(facts: &mut Vec<Term>, assembly: &Assembly, known: &Known) {
    for (rank, insertion) in assembly.insertions.iter().enumerate() {
        facts.push(Term::new("proven", [beam_name(assembly, insertion.beam), rank.into()]));
    }
    for beam in (0..assembly.beams.len()).filter(|&beam| known.stands[beam]) {
        facts.push(Term::new("placed", [beam_name(assembly, beam)]));
    }
}

/// The coarse fluents of a state: the hand is empty and over the sheet, and so is all that is not built in.
pub(crate) fn state(assembly: &Assembly, known: &Known) -> Vec<Term> {
    let mut fluents = vec![Term::new("at", [Term::new("input", [])])];
    for beam in 0..assembly.beams.len() {
        let name = beam_name(assembly, beam);
        if known.misaligned[beam] {
            fluents.push(Term::new("misaligned", [name.clone()]));
        }
        fluents.push(match known.stands[beam] {
            true => Term::new("in_assembly", [name]),
            false => Term::new("on_sheet", [Term::new("beam", [name])]),
        });
    }
    for connection in 0..assembly.connections.len() {
        let name = connection_name(assembly, connection);
        fluents.push(match known.pinned[connection] {
            true => Term::new("pinned", [name]),
            false => Term::new("on_sheet", [Term::new("peg", [name])]),
        });
    }
    fluents
}

/// One beam as the fine actions see it: its joints, its links and how far away they are, and what it meets.
pub(crate) fn beam(facts: &mut Vec<Term>, assembly: &Assembly, kit: &Kit, index: usize) {
    let placed = &assembly.beams[index];
    joints(facts, &placed.beam);
    let x_wb_goal = kit.x_wa() * placed.x_ab;
    let x_wb_start = kit.x_wb_start(&placed.beam);
    for link in &placed.beam.links {
        let name = Term::from(link.name.as_str());
        let [low, high] = link.grasp;
        let span = [name.clone(), beam_name(assembly, index), micrometres(low), micrometres(high)];
        facts.push(Term::new("link", span));
        let x_bg = Pose::translation(0.5 * (low + high), 0.0, 0.0);
        let reach = |when: &str, x_wb: &Pose| {
            let p_wg = (x_wb * x_bg).translation;
            let radius = micrometres(p_wg.x.hypot(p_wg.y));
            Term::new("reach", [name.clone(), Term::new(when, []), radius])
        };
        facts.push(reach("goal", &x_wb_goal));
        facts.extend(x_wb_start.iter().map(|x_wb| reach("start", x_wb)));
    }
    for (index, _) in partners(assembly, index) {
        connection(facts, assembly, index);
    }
}

/// The connections of a beam, each with the beam at its other side, by index.
pub(crate) fn partners(assembly: &Assembly, beam: usize) -> impl Iterator<Item = (usize, usize)> {
    assembly
        .connections
        .iter()
        .enumerate()
        .filter_map(move |(index, connection)| Some((index, assembly.sides(connection, beam)?.1.beam)))
}

fn joints(facts: &mut Vec<Term>, beam: &Beam) {
    for joint in &beam.joints {
        let (name, of) = (joint.name.as_str().into(), beam.name.as_str().into());
        // The rules know the types; a name of theirs has no hyphens.
        let kind = Term::new(&joint.kind.name().replace('-', "_"), []);
        facts.push(Term::new("joint", [name, of, micrometres(joint.offset), kind]));
    }
}

fn connection(facts: &mut Vec<Term>, assembly: &Assembly, index: usize) {
    let connection = &assembly.connections[index];
    let joint = |joint: JointRef| Term::from(assembly.joint_name(joint));
    let (female, male) = (connection.female, connection.male);
    let sides =
        [beam_name(assembly, female.beam), joint(female), beam_name(assembly, male.beam), joint(male)];
    let [f, j, m, k] = sides;
    facts.push(Term::new("connection", [connection_name(assembly, index), f, j, m, k]));
}

fn beam_name(assembly: &Assembly, index: usize) -> Term {
    assembly.beams[index].beam.name.as_str().into()
}

fn connection_name(assembly: &Assembly, index: usize) -> Term {
    assembly.connections[index].name.as_str().into()
}

/// Metres as whole micrometres.
fn micrometres(length: f64) -> Term {
    Term::Number((length * 1e6).round() as i64)
}
