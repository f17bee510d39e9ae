//! The survey of a finished frame: the wrist camera visits every connection, and all that it sees of a part
//! becomes one estimate of the part's pose. It measures what stands, for a referee, and changes nothing.
//! Without tags each part is looked for where the goal has it, up to some millimetres off.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point3, Vector3};
use ramp_assembly::Assembly;
use ramp_kit::joint::FEMALE_HEIGHT;
use ramp_motion::PathPlanner;
use ramp_robot::arm::ArmModel;
use ramp_robot::{Robot, RobotError, Track};
use ramp_vision::Lying;
use ramp_world::Start;

use crate::Pose;
use crate::belief::estimate::{Estimate, covariance};
use crate::belief::surroundings::{Expected, Surroundings};
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
    Ok(())
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
