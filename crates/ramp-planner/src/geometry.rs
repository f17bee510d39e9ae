//! Geometric input of the planner besides the [`Paths`]: possible push-backs of beams, and possible
//! grasps.

use crate::motion::{End, Motion};
use nalgebra::{Point3, UnitQuaternion, Vector3};
use ramp_assembly::block::{ALL_AXES, FROM_ABOVE, TOUCH};
use ramp_assembly::paths::{DOWN, FINGER, Paths, Way, middle, usable};
use ramp_assembly::sweep::Solid;
use ramp_assembly::{Assembly, Connection, Pose};
use ramp_kit::joint::{BODY_WIDTH, HEAD_WIDTH};
use ramp_kit::shape::{Cuboid, Shape, beam_shapes, peg_head};
use ramp_kit::{Holder, Link};

/// Margin of a push-back, m: it covers the arm's error on both sides.
const SHUTTLE_MARGIN: f64 = 5.0e-3;
/// Smallest overlap of a male's section with its female while pushed back, m.
const SHOULDER: f64 = 2.0e-3;
/// Reach of the hand with the gripper pointing down, m.
const RADIUS: f64 = 0.78;
/// Space of a released finger, m: ranges across the beam, and up from its axis.
const FINGERS: [[[f64; 2]; 2]; 1] = [[[11.0e-3, 30.0e-3], [-2.0e-3, 60.0e-3]]];
/// Space of the fingertip and its carrier beside a beam on the sheet, m: ranges across the beam,
/// and up from its axis. It includes room for parts that are off their outlines.
const OPEN_FINGERS: [[[f64; 2]; 2]; 2] =
    [[[11.0e-3, 32.0e-3], [-2.0e-3, 38.0e-3]], [[24.0e-3, 42.0e-3], [36.0e-3, 55.0e-3]]];

/// A beam that can be pushed back through an open joint until another one has been put on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shuttle {
    pub beam: usize,
    pub cap: usize,
    /// Its depth, m.
    pub depth: f64,
}

/// The geometry of an assembly, computed once.
pub(crate) struct Geometry<'a> {
    assembly: &'a Assembly,
    pub paths: &'a Paths,
    pub shuttles: Vec<Shuttle>,
    /// Known limits of the arm and the hand.
    pub motion: Motion,
}

impl<'a> Geometry<'a> {
    pub(crate) fn new(assembly: &'a Assembly, motion: Motion) -> Geometry<'a> {
        let paths = &assembly.paths;
        let mut geometry = Geometry { assembly, paths, shuttles: Vec::new(), motion };
        geometry.shuttles = geometry.find_shuttles();
        geometry
    }

    fn solid(&self, beam: usize) -> &Solid {
        &self.paths.solids()[beam]
    }

    /// The insertion path of a beam past the placed ones, with its length, m: that of the proven
    /// order if it is clear, else the first clear one. `laid` prefers the path from above.
    pub(crate) fn way(&self, beam: usize, stands: &[bool], laid: bool) -> Option<(&Way, f64)> {
        let proven = self.assembly.insertions.iter().find(|insertion| insertion.beam == beam);
        let usual = |way: &Way| proven.is_some_and(|i| i.direction.dot(&way.direction) > 1.0 - 1e-6);
        let ways = self.paths.ways(beam);
        let mut order: Vec<usize> = (0..ways.len()).collect();
        order.sort_by_key(|&index| (laid != (ways[index].name == DOWN), !usual(&ways[index]), index));
        order.into_iter().filter(|&index| self.motion.allows_path(beam, index, stands)).find_map(|index| {
            let distance = self.paths.distance(beam, index, |other| stands[other])?;
            Some((&ways[index], distance))
        })
    }

    // Push-back

    fn find_shuttles(&self) -> Vec<Shuttle> {
        let mut shuttles = Vec::new();
        for cap in &self.assembly.connections {
            let (beam, joint) = (cap.male.beam, cap.male.joint);
            let placed = &self.assembly.beams[beam];
            if [beam, cap.female.beam].contains(&self.assembly.base)
                || !placed.beam.joints[joint].kind.is_end()
            {
                continue;
            }
            let along = placed.x_ab.rotation * Vector3::x();
            let back = if joint == 0 { along } else { -along };
            let ends = self.assembly.connections.iter().filter(|c| {
                c.male.beam == beam && c.male.joint != joint && placed.beam.joints[c.male.joint].kind.is_end()
            });
            for through in ends {
                if let Some(depth) = self.depth(beam, cap.female.beam, through, &back) {
                    shuttles.push(Shuttle { beam, cap: cap.female.beam, depth });
                }
            }
        }
        shuttles
    }

    /// The push-back of a beam that clears another one, m; `None` when none exists.
    fn depth(&self, beam: usize, cap: usize, through: &Connection, back: &Vector3<f64>) -> Option<f64> {
        let covers = self.solid(beam).ranges(self.solid(cap), back, 0.0, FROM_ABOVE);
        let depth = covers.first().filter(|cover| cover[0] <= 0.0)?[1] + SHUTTLE_MARGIN;
        // Its section must stay in the joint on which it rests, otherwise it drops.
        let male = self.assembly.beams[beam].beam.joints[through.male.joint].kind;
        let across = self.assembly.beams[through.female.beam].x_ab.rotation * Vector3::x();
        let straight = (1.0 - across.dot(back).powi(2)).sqrt().max(0.1);
        let most = male.sleeve() + BODY_WIDTH / 2.0 / straight - SHOULDER;
        let others = (0..self.assembly.beams.len()).filter(|&other| other != beam && other != cap);
        let free = others.filter(|&other| self.solid(beam).may_meet(self.solid(other), back)).all(|other| {
            let hits = self.solid(beam).ranges(self.solid(other), back, TOUCH, ALL_AXES);
            hits.iter().all(|hit| hit[0] > depth)
        });
        (depth <= most && free).then_some(depth)
    }

    // Grasps

    /// Whether a hand can grasp a link at the beam's start pose. For a beam without a start pose
    /// only its shape counts, because no arm has to reach it.
    pub(crate) fn graspable_at_start(&self, beam: usize, link: &Link, stands: &[bool]) -> bool {
        if !self.motion.allows_grasp(beam, &link.name, End::Start, stands) {
            return false;
        }
        let beam = &self.assembly.beams[beam].beam;
        let Some(x_wb) = self.assembly.kit.x_wb_start(beam) else { return usable(link) };
        if !usable(link) || !reaches(&x_wb, link) {
            return false;
        }
        let beside = self.beside_at_start(&beam.name);
        has_room(link, &x_wb, &OPEN_FINGERS, |finger| {
            beside.iter().any(|solid| finger.overlaps(solid, TOUCH))
        })
    }

    /// The parts on the sheet beside a beam, in the world: the other beams, the holders and the
    /// pegs in them.
    fn beside_at_start(&self, beam: &str) -> Vec<Solid> {
        let others = self.assembly.kit.beams.iter().filter(|other| other.name != beam);
        let others = others
            .filter_map(|other| Some(Solid::new(&beam_shapes(other), &self.assembly.kit.x_wb_start(other)?)));
        let holders = self.assembly.kit.holders.iter().map(|holder| {
            let at = self.assembly.kit.sheet_to_world(holder.centre);
            Solid::new(&Holder::blocks().map(Shape::Solid), &Pose::translation(at.x, at.y, at.z))
        });
        let pegs = self.assembly.kit.pegs.iter().filter_map(|peg| self.assembly.kit.x_wp_start(peg));
        let pegs = pegs.map(|x_wp| Solid::new(&[Shape::Solid(peg_head())], &x_wp));
        others.chain(holders).chain(pegs).collect()
    }

    /// Whether a hand can grasp a link at the beam's goal pose, with other beams placed and pegs
    /// inserted.
    pub(crate) fn graspable_at_place(
        &self,
        beam: usize,
        link: &Link,
        stands: &[bool],
        pinned: &[bool],
    ) -> bool {
        let placed = &self.assembly.beams[beam];
        let near = placed.beam.start.is_none() || reaches(&(self.assembly.kit.x_wa() * placed.x_ab), link);
        if !usable(link) || !near || !self.motion.allows_grasp(beam, &link.name, End::Place, stands) {
            return false;
        }
        let beams = (0..stands.len()).filter(|&other| other != beam && stands[other]);
        let beams: Vec<&Solid> = beams.map(|other| self.solid(other)).collect();
        let pegs = self.assembly.connections.iter().zip(pinned).filter(|(_, pinned)| **pinned);
        let heads: Vec<Solid> = pegs
            .map(|(connection, _)| {
                let hole = self.assembly.p_a_hole(connection.male);
                let half = HEAD_WIDTH / 2.0;
                let head = Cuboid::new([-half, half], [-half, half], [0.0, 60.0e-3]);
                Solid::new(&[Shape::Solid(head)], &Pose::translation(hole.x, hole.y, hole.z))
            })
            .collect();
        has_room(link, &placed.x_ab, &FINGERS, |finger| {
            beams.iter().copied().chain(&heads).any(|solid| finger.overlaps(solid, TOUCH))
        })
    }
}

/// The same pose without the flip of the beam.
fn upright(x_ab: &Pose) -> Pose {
    let along = x_ab.rotation * Vector3::x();
    let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), along.y.atan2(along.x));
    Pose::from_parts(x_ab.translation, yaw)
}

/// Whether a position on a link exists where both fingers, given as ranges across the beam and up
/// from its axis, m, are free of collisions.
fn has_room(link: &Link, x: &Pose, pieces: &[[[f64; 2]; 2]], meets: impl Fn(&Solid) -> bool) -> bool {
    let [low, high] = [link.grasp[0] + FINGER, link.grasp[1] - FINGER];
    let steps = ((high - low) / 1e-3) as usize;
    (0..=steps).any(|step| {
        let s = low + step as f64 * 1e-3;
        [-1.0, 1.0].into_iter().all(|side| {
            pieces.iter().all(|[across, up]| {
                let finger = Cuboid::new([s - 10.0e-3, s + 10.0e-3], across.map(|y| side * y), *up);
                !meets(&Solid::new(&[Shape::Solid(finger)], &upright(x)))
            })
        })
    })
}

fn reaches(x_wb: &Pose, link: &Link) -> bool {
    let p = x_wb * Point3::new(middle(link), 0.0, 0.0);
    p.x.hypot(p.y) <= RADIUS
}
