//! Is a step of a plan done? Asked of the truth.

use nalgebra::Point3;
use ramp_assembly::JointRef;
use ramp_kit::Pose;
use ramp_kit::joint::CLEARANCE;
use ramp_robot::Robot;
use ramp_twin::{Setup, Twin};

use super::task::{Aim, Task};
use super::world::{NamedTruth, far_end, open_joints, pegs_in};

/// Holes that are to be pinned are no further apart along the table, m: the cone of a peg still pulls them
/// together.
pub const PEGGABLE: f64 = 1.6e-3;
/// Their heights differ by no more than this, m: the play of a male in a female on both sides, and as much
/// again for a beam that hangs or leans in it.
pub const LEVEL: f64 = 4.0 * CLEARANCE;
/// A beam that is to stand deeper than its place may be off by this along its way, m: the next beam needs no
/// more.
const DEEP: f64 = 3.0e-3;
/// A beam that was laid down may be off its place by this, m: another beam goes through it all the same.
const LAID: f64 = 4.0e-3;
/// A peg that was picked up is this much higher than it stood, m, and the tip of the hand is this near to its
/// head, m.
pub(super) const LIFTED: [f64; 2] = [30.0e-3, 30.0e-3];

/// The difference between the truth and the goal of a task; `None` when the task is done and nothing was
/// spoilt. `places` is where all parts were at the start.
pub fn missing(setup: &Setup, task: &Task, places: &[(String, Pose)], twin: &Twin) -> Option<String> {
    let world = NamedTruth::of(setup, twin);
    let seated = pegs_in(setup, twin);
    let out = task.build.pinned.iter().find(|(connection, peg)| seated[*connection].as_deref() != Some(peg));
    if let Some((connection, peg)) = out {
        return Some(format!("{peg} no longer pins {}", world.assembly.connections[*connection].name));
    }
    match &task.aim {
        Aim::Held { peg } => {
            let before = places.iter().find(|(name, _)| name == peg).map(|(_, x_wp)| *x_wp)?;
            let now = world.part(peg);
            let [risen, away] = LIFTED;
            let tip = twin.observe().x_wt.translation.vector;
            let held = now.translation.z - before.translation.z > risen
                && (tip - now.translation.vector).norm() < away;
            (!held).then(|| format!("{peg} is not in the hand"))
        }
        Aim::Pinned { connection } => {
            let name = &world.assembly.connections[*connection].name;
            seated[*connection].is_none().then(|| format!("no peg pins {name}"))
        }
        Aim::Placed { connections } => connections.iter().find_map(|index| {
            let connection = &world.assembly.connections[*index];
            let (male, female) = (connection.male, connection.female);
            apart(&world, male, &world.hole(male), female, &world.hole(female))
        }),
        Aim::Deep { beam, shift } => {
            let shift = world.x_wa.rotation * shift;
            let back = shift.normalize();
            // The joint that is in its female; the others are short of theirs.
            open_joints(task, &world, *beam).into_iter().find_map(|(mine, theirs)| {
                let hole = world.hole(mine);
                let off = (hole - (world.hole(theirs) + shift)).dot(&back);
                if off.abs() > DEEP {
                    let name = world.name(mine);
                    return Some(format!("{name} is {:.1} mm from as deep as it should be", off.abs() * 1e3));
                }
                apart(&world, mine, &(hole - shift - back * off), theirs, &world.hole(theirs))
            })
        }
        Aim::Laid { beam } => {
            let placed = &world.assembly.beams[*beam].beam;
            let x_wb = world.part(&placed.name);
            [0.0, placed.span()].into_iter().find_map(|x| {
                let p = Point3::new(x, 0.0, 0.0);
                let off = (x_wb * p - world.nominal(*beam, &p)).norm();
                (off > LAID).then(|| format!("{} lies {:.1} mm from its place", placed.name, off * 1e3))
            })
        }
        Aim::Straight { beam } => {
            let open = open_joints(task, &world, *beam);
            if !open.is_empty() {
                return open.into_iter().find_map(|(mine, theirs)| {
                    apart(&world, mine, &world.hole(mine), theirs, &world.hole(theirs))
                });
            }
            let placed = &world.assembly.beams[*beam].beam;
            let p = Point3::new(far_end(task, world.assembly, *beam), 0.0, 0.0);
            let off = (world.part(&placed.name) * p - world.nominal(*beam, &p)).xy().norm();
            (off > PEGGABLE)
                .then(|| format!("the end of {} is {:.2} mm from its place", placed.name, off * 1e3))
        }
    }
}

/// The reason why a peg cannot pin two holes.
fn apart(
    world: &NamedTruth,
    mine: JointRef,
    hole: &Point3<f64>,
    theirs: JointRef,
    other: &Point3<f64>,
) -> Option<String> {
    let off = hole - other;
    let (along, height) = (off.xy().norm(), off.z.abs());
    let (mine, theirs) = (world.name(mine), world.name(theirs));
    if along > PEGGABLE {
        return Some(format!("{mine} is {:.2} mm beside {theirs}", along * 1e3));
    }
    (height > LEVEL).then(|| format!("{mine} is {:.2} mm above or below {theirs}", height * 1e3))
}
