//! Is a step of a plan done? Asked of the truth.

use nalgebra::{Point3, Vector3};
use ramp_assembly::{Assembly, JointRef};
use ramp_kit::Pose;
use ramp_kit::joint::CLEARANCE;
use ramp_robot::Robot;
use ramp_twin::{Setup, Truth, Twin};

use super::Task;
use super::start::pegs_in;

/// Holes that are to be pinned are no further apart along the table, m: the cone of a peg still pulls them together.
pub const PEGGABLE: f64 = 1.6e-3;
/// Their heights differ by no more than this, m: the play of a male in a female on both sides, and as much again for a
/// beam that hangs or leans in it.
pub const LEVEL: f64 = 4.0 * CLEARANCE;
/// A beam that is to stand deeper than its place may be off by this along its way, m: the next beam needs no more.
const DEEP: f64 = 3.0e-3;
/// A beam that was laid down may be off its place by this, m: another beam goes through it all the same.
const LAID: f64 = 4.0e-3;
/// A peg that was picked up is this much higher than it stood, m, and the tip of the hand is this near to its head, m.
const LIFTED: [f64; 2] = [30.0e-3, 30.0e-3];

/// What is to be true after a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Aim {
    /// This peg is in the hand, out of its holder.
    Held {
        /// Its name.
        peg: String,
    },
    /// A peg pins this connection, by the referee's rule.
    Pinned {
        /// Index into [`Assembly::connections`].
        connection: usize,
    },
    /// A peg can pin these connections.
    Placed {
        /// Indices into [`Assembly::connections`].
        connections: Vec<usize>,
    },
    /// This beam stands deeper than its place, by so much.
    Deep {
        /// Index into [`Assembly::beams`].
        beam: usize,
        /// From its place, axes of the assembly frame, m.
        shift: Vector3<f64>,
    },
    /// This beam lies at its place with nothing to hold it.
    Laid {
        /// Index into [`Assembly::beams`].
        beam: usize,
    },
    /// The joints of this beam that are not pinned are where a peg can pin them; without any, its far end is at its place.
    Straight {
        /// Index into [`Assembly::beams`].
        beam: usize,
    },
}

/// The truth with names.
pub(super) struct World<'t> {
    pub assembly: &'t Assembly,
    pub x_wa: Pose,
    names: Vec<&'t str>,
    truth: Truth,
}

impl<'t> World<'t> {
    pub(super) fn of(setup: &Setup<'t>, twin: &'t Twin) -> World<'t> {
        World {
            assembly: setup.assembly,
            x_wa: setup.kit.x_wa(),
            names: twin.part_names().collect(),
            truth: twin.truth(),
        }
    }

    /// Where a part is; at the origin where there is none of that name.
    pub(super) fn part(&self, name: &str) -> Pose {
        let index = self.names.iter().position(|other| *other == name);
        index.and_then(|index| self.truth.x_wp.get(index)).copied().unwrap_or_default()
    }

    /// Where a hole is.
    pub(super) fn hole(&self, joint: JointRef) -> Point3<f64> {
        let beam = &self.assembly.beams[joint.beam].beam;
        self.part(&beam.name) * beam.p_b_hole(joint.joint)
    }

    /// Where a point of a beam (m, in its frame) would be at its place.
    pub(super) fn nominal(&self, beam: usize, p_b: &Point3<f64>) -> Point3<f64> {
        self.x_wa * self.assembly.beams[beam].x_ab * p_b
    }

    fn name(&self, joint: JointRef) -> &str {
        self.assembly.joint_name(joint)
    }
}

/// What the truth lacks of a task that was to be done; `None` when it is done and nothing was spoilt. `places` is where all
/// parts were at the start.
pub(super) fn missing(setup: &Setup, task: &Task, places: &[(String, Pose)], twin: &Twin) -> Option<String> {
    let world = World::of(setup, twin);
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

/// What is wrong with two holes that a peg is to pin.
fn apart(
    world: &World,
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

/// The joints of a beam that meet those of beams that stand at their places, and that no peg pins, each with the other.
pub(super) fn open_joints(task: &Task, world: &World, beam: usize) -> Vec<(JointRef, JointRef)> {
    let build = &task.build;
    let assembly = world.assembly;
    let connections = assembly.connections.iter().enumerate();
    let open = connections.filter(|(index, _)| build.pinned.iter().all(|(pinned, _)| pinned != index));
    open.filter_map(|(_, connection)| assembly.sides(connection, beam))
        .filter(|(_, theirs)| build.stands_at_its_place(theirs.beam) || theirs.beam == assembly.base)
        .collect()
}

/// Distance from j1, m, of the end of a beam that is further from the joint that a peg pins; without one, the last.
pub(super) fn far_end(task: &Task, assembly: &Assembly, beam: usize) -> f64 {
    let placed = &assembly.beams[beam].beam;
    match task.build.anchor(assembly, beam) {
        Some(joint) if placed.joints[joint.joint].offset > placed.span() / 2.0 => 0.0,
        _ => placed.span(),
    }
}
