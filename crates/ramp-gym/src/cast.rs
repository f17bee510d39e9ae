//! Which parts a task needs: a scene cut to them steps two to three times as fast as the whole one.

use std::collections::BTreeSet;

use ramp_abilities::manipulation::{Aim, Cast};
use ramp_assembly::Assembly;
use ramp_planner::{CoarseAction, Item};
use ramp_twin::SceneOptions;

use crate::tasks::Step;

/// Memory for contacts and constraints of a cut scene, MiB: of one in which nothing is pinned, and for each
/// peg that pins. A seated peg has 20 contacts, and while a start settles all of them are at work at once.
const CUT_MEMORY: [u32; 2] = [32, 32];
/// The same of a whole scene: what the twin has.
const WHOLE_MEMORY: u32 = 512;

/// The parts that a step needs: what stands, what pins it, and what the step itself works with, a peg with
/// the holder in which it stands.
pub fn cut(assembly: &Assembly, step: &Step) -> Cast {
    let beam = |index: &usize| assembly.beams[*index].beam.name.clone();
    let mut only: Vec<String> = step.task.build.standing.iter().map(beam).collect();
    only.extend(step.task.build.pinned.iter().map(|(_, peg)| peg.clone()));
    for action in step.plan.steps.iter().map(|step| &step.coarse) {
        let (CoarseAction::PickUp { item } | CoarseAction::PutDown { item }) = action else {
            match action {
                CoarseAction::Assemble { beam }
                | CoarseAction::LayDown { beam }
                | CoarseAction::AssembleDeep { beam }
                | CoarseAction::Slide { beam }
                | CoarseAction::Regrasp { beam }
                | CoarseAction::Push { beam } => only.push(beam.clone()),
                CoarseAction::Fasten { peg, .. } => only.push(peg.clone()),
                _ => {}
            }
            continue;
        };
        match item {
            Item::Beam(beam) => only.push(beam.clone()),
            Item::Peg(peg) => only.push(peg.clone()),
        }
    }
    let [none, each] = CUT_MEMORY;
    let memory = (none + each * step.task.build.pinned.len() as u32).min(WHOLE_MEMORY);
    Cast { only: Some(only), options: SceneOptions { looks: false, memory } }
}

/// The parts of the frame that stands before a step, without those that the step moves: the part that it
/// works with, and beams that the part aligns.
pub fn standing(assembly: &Assembly, step: &Step) -> BTreeSet<String> {
    let beam = |index: &usize| assembly.beams[*index].beam.name.clone();
    let mut standing: BTreeSet<String> = step.task.build.standing.iter().map(beam).collect();
    standing.extend(step.task.build.pinned.iter().map(|(_, peg)| peg.clone()));
    for action in step.plan.steps.iter().map(|step| &step.coarse) {
        if let CoarseAction::Slide { beam } | CoarseAction::Regrasp { beam } | CoarseAction::Push { beam } =
            action
        {
            standing.remove(beam);
        }
    }
    // A peg aligns the beam that it pins; a beam aligns those that it joins.
    let connection = |index: &usize| &assembly.connections[*index];
    let moved: Vec<usize> = match &step.task.aim {
        Aim::Pinned { connection: index } => vec![connection(index).male.beam],
        Aim::Placed { connections } => {
            connections.iter().flat_map(|it| [connection(it).male.beam, connection(it).female.beam]).collect()
        }
        _ => Vec::new(),
    };
    moved.iter().for_each(|index| {
        standing.remove(&beam(index));
    });
    standing
}

/// All parts of the kit.
pub fn whole() -> Cast {
    Cast { only: None, options: SceneOptions { looks: false, memory: WHOLE_MEMORY } }
}
