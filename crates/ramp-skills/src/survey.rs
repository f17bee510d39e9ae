//! The survey of a finished frame: the wrist camera visits every connection, and all that it sees of a part
//! becomes one estimate of the part's pose. It measures what stands, for a referee, and changes nothing.

use std::collections::BTreeMap;

use ramp_assembly::Assembly;
use ramp_motion::PathPlanner;
use ramp_robot::arm::ArmModel;
use ramp_robot::{Robot, RobotError, Track};
use ramp_world::Start;

use crate::Pose;
use crate::belief::estimate::Estimate;
use crate::cell::Workcell;
use crate::fault::SkillError;
use crate::parameters::Parameters;

/// Images of each camera that are taken over each connection.
const LOOKS: usize = 3;

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
    if track != Track::Tags {
        return Ok(robot.read_parts()?.into_iter().map(|reading| (reading.part, reading.x_wp)).collect());
    }
    let planner = PathPlanner::new(arm);
    let parameters = Parameters::baseline();
    let mut cell = Workcell::new(assembly, arm, &planner, robot, seed, parameters, Start::moved());
    cell.belief.parts.eyes.on_track(track);
    let mut seen: BTreeMap<String, Estimate> = BTreeMap::new();
    let outcome = visit_all(&mut cell, &mut seen);
    match outcome {
        Err(SkillError::Robot(error)) => Err(error),
        // From where the hand could not go, nothing is seen.
        _ => Ok(seen.into_iter().map(|(part, estimate)| (part, estimate.x)).collect()),
    }
}

/// Shows the wrist camera the sheet's tag, which calibrates it, and then every connection.
fn visit_all(cell: &mut Workcell, seen: &mut BTreeMap<String, Estimate>) -> Result<(), SkillError> {
    cell.calibrate()?;
    for connection in &cell.assembly.connections {
        let hole = cell.belief.x_wa() * cell.assembly.p_a_hole(connection.female);
        cell.visit(&hole)?;
        for _ in 0..LOOKS {
            cell.hand.expose()?;
        }
        for _ in 0..LOOKS {
            for sighting in cell.belief.parts.eyes.look(&mut cell.hand, &[])? {
                match seen.get_mut(&sighting.part) {
                    Some(estimate) => estimate.fuse(&sighting.estimate),
                    None => {
                        seen.insert(sighting.part, sighting.estimate);
                    }
                }
            }
        }
    }
    Ok(())
}
