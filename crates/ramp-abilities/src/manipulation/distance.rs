//! How far the truth is from the aim of a task: for rewards and for curves, never for a verdict.

use nalgebra::{Point3, Vector3};
use ramp_assembly::JointRef;
use ramp_kit::Pose;
use ramp_kit::joint::FEMALE_HEIGHT;
use ramp_robot::Robot;
use ramp_twin::{Setup, Twin};

use super::judge::LIFTED;
use super::task::{Aim, Task};
use super::world::{NamedTruth, far_end, open_joints};

/// How far a task is from done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// From where a point is to be to where it is, axes of the world, m: of the point that is furthest off.
    pub off: Vector3<f64>,
}

impl Progress {
    /// Straight, m.
    pub fn distance(&self) -> f64 {
        self.off.norm()
    }

    fn of(off: Vector3<f64>) -> Progress {
        Progress { off }
    }

    fn further(self, other: Progress) -> Progress {
        if other.distance() > self.distance() { other } else { self }
    }
}

/// How far the truth is from the aim. `places` is where all parts were at the start; a peg that a task is to
/// seat is named by `peg`.
pub fn progress(
    setup: &Setup,
    task: &Task,
    places: &[(String, Pose)],
    peg: Option<&str>,
    twin: &Twin,
) -> Progress {
    let world = NamedTruth::of(setup, twin);
    match &task.aim {
        Aim::Held { peg } => {
            let now = world.part(peg);
            let before = places.iter().find(|(name, _)| name == peg).map_or(now, |(_, x_wp)| *x_wp);
            let tip = twin.observe().x_wt.translation.vector;
            // It is to be in the hand, and above where it was.
            let lacking = (LIFTED[0] - (now.translation.z - before.translation.z)).max(0.0);
            let mut off = now.translation.vector - tip;
            off.z = -off.z.abs().max(lacking);
            Progress::of(off)
        }
        Aim::Pinned { connection } => {
            let Some(peg) = peg else { return Progress::default() };
            let hole = world.hole(world.assembly.connections[*connection].female);
            let plate = hole.coords + Vector3::z() * (FEMALE_HEIGHT / 2.0);
            Progress::of(world.part(peg).translation.vector - plate)
        }
        Aim::Placed { connections } => {
            let apart = connections.iter().map(|index| {
                let connection = &world.assembly.connections[*index];
                Progress::of(world.hole(connection.male) - world.hole(connection.female))
            });
            apart.fold(Progress::default(), Progress::further)
        }
        Aim::Deep { beam, shift } => {
            let shift = world.x_wa.rotation * shift;
            let joints = open_joints(task, &world, *beam);
            let off = |(mine, theirs): (JointRef, JointRef)| {
                Progress::of(world.hole(mine) - (world.hole(theirs) + shift))
            };
            joints.into_iter().map(off).fold(Progress::default(), Progress::further)
        }
        Aim::Laid { beam } => {
            let placed = &world.assembly.beams[*beam].beam;
            let x_wb = world.part(&placed.name);
            let ends = [0.0, placed.span()].map(|x| {
                let p = Point3::new(x, 0.0, 0.0);
                Progress::of(x_wb * p - world.nominal(*beam, &p))
            });
            ends.into_iter().fold(Progress::default(), Progress::further)
        }
        Aim::Straight { beam } => {
            let open = open_joints(task, &world, *beam);
            if !open.is_empty() {
                let off = |(mine, theirs)| Progress::of(world.hole(mine) - world.hole(theirs));
                return open.into_iter().map(off).fold(Progress::default(), Progress::further);
            }
            let placed = &world.assembly.beams[*beam].beam;
            let p = Point3::new(far_end(task, world.assembly, *beam), 0.0, 0.0);
            let off = world.part(&placed.name) * p - world.nominal(*beam, &p);
            Progress::of(Vector3::new(off.x, off.y, 0.0))
        }
    }
}
