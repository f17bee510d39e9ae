//! The survey of a finished frame: the wrist camera visits every connection, and all that it sees of a part
//! becomes one estimate of the part's pose. It measures what stands, for a referee, and changes nothing.
//! Without tags each part is looked for where the goal has it, up to some millimetres off; then beams with
//! the same joints are told apart from their sides.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point3, Vector3};
use ramp_assembly::Assembly;
use ramp_kit::Beam;
use ramp_kit::joint::FEMALE_HEIGHT;
use ramp_motion::PathPlanner;
use ramp_robot::arm::ArmModel;
use ramp_robot::{Robot, RobotError, Track};
use ramp_vision::Lying;
use ramp_world::Start;

use crate::Pose;
use crate::belief::estimate::{Estimate, covariance};
use crate::belief::surroundings::{Expected, Surroundings};
use crate::belief::{beside, is_clearly_better};
use crate::cell::Workcell;
use crate::fault::SkillError;
use crate::parameters::Parameters;

/// Images of each camera that are taken over each point.
const LOOKS: usize = 3;
/// How far a part without a tag may be from its place in the goal to be found, and the clamped beam, 1 σ, m;
/// and the distance over which a turn makes as much of a difference, m. Chosen: a peg that is off by more
/// would not count.
const OFF: f64 = 3.0e-3;
const CLAMPED: f64 = 0.1e-3;
const LEVER: f64 = 0.2;
/// Largest distance from its place at which a part is taken for itself, m.
const FAR: f64 = 12.0e-3;

/// Measures the poses (in the world) of the parts that stand, by name, with the hand empty. A part that was
/// not seen is absent. On a track that gives poses, these are read.
///
/// # Errors
/// The robot's.
pub fn survey(
    assembly: &Assembly,
    arm: &ArmModel,
    track: Track,
    robot: &mut dyn Robot,
    seed: u64,
) -> Result<BTreeMap<String, Pose>, RobotError> {
    if !track.gives_images() {
        return Ok(robot.read_parts()?.into_iter().map(|reading| (reading.part, reading.x_wp)).collect());
    }
    let planner = PathPlanner::new(arm);
    let parameters = Parameters::baseline();
    let mut cell = Workcell::new(assembly, arm, &planner, robot, seed, parameters, Start::moved());
    cell.belief.parts.eyes.on_track(track);
    let mut seen: BTreeMap<String, Estimate> = BTreeMap::new();
    match visit_all(&mut cell, &mut seen) {
        Err(SkillError::Robot(error)) => Err(error),
        // From where the hand could not go, nothing is seen.
        _ => Ok(seen.into_iter().map(|(part, estimate)| (part, estimate.x)).collect()),
    }
}

/// Shows the wrist camera the sheet's tag, which calibrates it, then the hole of every connection, and of
/// each beam there the tag that is nearest.
fn visit_all(cell: &mut Workcell, seen: &mut BTreeMap<String, Estimate>) -> Result<(), SkillError> {
    cell.calibrate()?;
    let (assembly, x_wa) = (cell.assembly, cell.belief.x_wa());
    for connection in &assembly.connections {
        look_at(cell, x_wa * assembly.p_a_hole(connection.female), seen)?;
    }
    let mut shown = BTreeSet::new();
    for joint in assembly.connections.iter().flat_map(|connection| [connection.female, connection.male]) {
        let placed = &assembly.beams[joint.beam];
        let hole = placed.beam.p_b_hole(joint.joint);
        let Some(tag) = cell.belief.parts.eyes.nearest_tag(&placed.beam.name, &hole) else { continue };
        // Two joints of a beam may be nearest to one tag.
        if joint.beam != assembly.base && shown.insert((joint.beam, tag.coords.map(f64::to_bits).data.0)) {
            look_at(cell, x_wa * placed.x_ab * tag, seen)?;
        }
    }
    tell_apart(cell, seen)
}

/// Without tags, beams with the same joints in the same places look nearly alike: each that stands is
/// compared with the others from its sides. One that looks like another one is taken for that one.
fn tell_apart(cell: &mut Workcell, seen: &mut BTreeMap<String, Estimate>) -> Result<(), SkillError> {
    if cell.belief.parts.eyes.tags() {
        return Ok(());
    }
    let (assembly, found) = (cell.assembly, seen.clone());
    let clamped = &assembly.beams[assembly.base].beam.name;
    let mut others: BTreeMap<String, String> = BTreeMap::new();
    for placed in assembly.beams.iter().filter(|placed| placed.beam.name != *clamped) {
        let (beam, x_wb) = (&placed.beam, cell.belief.x_wa() * placed.x_ab);
        let nearly = |other: &&Beam| other.has_joints_of(beam) && !other.has_shape_of(beam);
        let kit = cell.kit;
        for other in kit.beams.iter().filter(|other| other.name != *clamped).filter(nearly) {
            if found.contains_key(&beam.name) && is_another(cell, [beam, other], &x_wb)? {
                others.insert(beam.name.clone(), other.name.clone());
            }
        }
    }
    // One that was seen in its own place is nowhere else.
    let is_there = |beam: &String| found.contains_key(beam) && !others.contains_key(beam);
    let others: Vec<_> = others.iter().filter(|(_, other)| !is_there(other)).collect();
    seen.retain(|name, _| others.iter().all(|(beam, _)| *beam != name));
    for (beam, other) in others {
        if let Some(estimate) = found.get(beam) {
            seen.insert(other.clone(), estimate.clone());
        }
    }
    Ok(())
}

/// Whether images from the sides of a beam, which the goal has at `x_wb` (world), show another one in its
/// place.
fn is_another(cell: &mut Workcell, beams: [&Beam; 2], x_wb: &Pose) -> Result<bool, SkillError> {
    let points = [0.5, 0.0, 1.0].map(|share| x_wb * Point3::new(share * beams[0].span(), 0.0, 0.0));
    let names = beams.map(|beam| beam.name.as_str());
    let [mut off, mut other] = [0.0; 2];
    for point in beside(x_wb.rotation * Vector3::x(), points) {
        cell.visit(&point)?;
        cell.hand.expose()?;
        let surroundings = expected(cell);
        if let Some(more) = cell.belief.parts.eyes.compare(&mut cell.hand, &surroundings, names)? {
            [off, other] = [off + more[0], other + more[1]];
        }
        if is_clearly_better(off, other) || is_clearly_better(other, off) {
            break;
        }
    }
    Ok(is_clearly_better(other, off))
}

/// The built goal, as far as it has to be known to find its parts. Tags say themselves which part is where.
fn expected(cell: &Workcell) -> Surroundings {
    if cell.belief.parts.eyes.tags() {
        return Surroundings::default();
    }
    let (assembly, x_wa) = (cell.assembly, cell.belief.x_wa());
    let lying = |part: &str, x: &Pose| Lying {
        part: part.to_string(),
        height: x.translation.z,
        flipped: (x.rotation * Vector3::z()).z < 0.0,
        sigma: [OFF, OFF / LEVER],
    };
    let part = |part: &str, x: Pose, off: f64| Expected {
        part: part.to_string(),
        estimate: Estimate { x, covariance: covariance([off; 3], [off / LEVER; 3]) },
        held: false,
        lying: Some(lying(part, &x)),
        anywhere: false,
        places: Vec::new(),
        glimpsed: None,
    };
    let beams = assembly.beams.iter().enumerate().map(|(index, placed)| {
        part(&placed.beam.name, x_wa * placed.x_ab, if index == assembly.base { CLAMPED } else { OFF })
    });
    let pegs = assembly.connections.iter().zip(assembly.built_with()).map(|(connection, peg)| {
        let hole = x_wa * assembly.p_a_hole(connection.female);
        part(peg, Pose::translation(hole.x, hole.y, hole.z + FEMALE_HEIGHT / 2.0), OFF)
    });
    Surroundings { parts: beams.chain(pegs).collect(), holders: Vec::new(), width: cell.hand.seen.width }
}

/// Brings the wrist camera over a point of the world, and takes images there.
fn look_at(
    cell: &mut Workcell,
    aim: Point3<f64>,
    seen: &mut BTreeMap<String, Estimate>,
) -> Result<(), SkillError> {
    cell.visit(&aim)?;
    for _ in 0..LOOKS {
        cell.hand.expose()?;
    }
    for _ in 0..LOOKS {
        let surroundings = expected(cell);
        for sighting in cell.belief.parts.eyes.look(&mut cell.hand, &surroundings)? {
            let goal = surroundings.parts.iter().find(|it| it.part == sighting.part);
            let off = |x: &Pose| (sighting.estimate.x.translation.vector - x.translation.vector).norm();
            if goal.is_some_and(|it| off(&it.estimate.x) > FAR) {
                continue;
            }
            match seen.get_mut(&sighting.part) {
                Some(estimate) => estimate.fuse(&sighting.estimate),
                None => {
                    seen.insert(sighting.part, sighting.estimate);
                }
            }
        }
    }
    Ok(())
}
