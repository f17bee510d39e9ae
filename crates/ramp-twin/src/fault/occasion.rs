//! The moments at which a fault may strike, found in the true state: a part is gripped, lifted or inserted,
//! the fingers close on it, or the hand leaves the assembly.

use std::sync::Arc;

use mujoco_rs::prelude::*;
use nalgebra::{Point3, Vector3};
use ramp_kit::Pose;

use super::kind::FaultKind;
use crate::engine::body_pose;
use crate::pieces;
use crate::scene::Scene;
use crate::setup::Setup;
use ramp_robot::PERIOD;

/// A beam is in its place up to this, m and rad.
const IN_PLACE: (f64, f64) = (15.0e-3, 6.0 / 180.0 * std::f64::consts::PI);
/// Height above the place of its grasp at which a held part counts as lifted, m.
const LIFTED: f64 = 15.0e-3;
/// Time for which both fingers must touch a part until it counts as gripped, s.
const GRIPPED: f64 = 0.1;
/// Time for which they must not until it counts as released, s.
const LET_GO: f64 = 0.2;
/// Distance to a beam within which a held part counts as inserted, m: the gap between male and female joint
/// is 0.3 mm on each side, and printed faces are off by up to 0.1 mm each.
const ENTERED: f64 = 0.5e-3;
/// Least speed of a part that counts as inserted, m/s.
const INSERTING: f64 = 5.0e-3;
/// The hand works at a beam below this height of the tip, m, and is away above the other.
const HEIGHTS: [f64; 2] = [0.10, 0.12];
/// Horizontal distance from the joints of a beam within which the hand works at it, m, and is not away from
/// it.
const NEAR: f64 = 0.10;
/// Speed at which the fingers are closing, m/s.
const CLOSING: f64 = 1.0e-3;

type Data = MjData<Arc<MjModel>>;

/// A part of the twin as a fault sees it.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub name: String,
    pub body: usize,
    pub is_peg: bool,
    /// The holder a peg starts in.
    pub holder: Option<String>,
}

/// A beam of the goal.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    /// Index into the parts.
    pub part: usize,
    pub clamped: bool,
    /// Its target pose in the world.
    pub x_wb: Pose,
    /// Its holes, and the middles of its links, in its own frame, m.
    pub holes: Vec<Point3<f64>>,
    pub links: Vec<Point3<f64>>,
}

/// The bodies of parts, holders and fingers in MuJoCo's model. They do not change during an episode.
#[derive(Clone, Debug)]
pub(super) struct Bodies {
    pub parts: Vec<Part>,
    pub placed: Vec<Placed>,
    pub holders: Vec<(String, usize)>,
    pub fingers: [usize; 2],
    /// Body of each geom, and part of each body.
    geom_body: Vec<usize>,
    body_part: Vec<Option<usize>>,
    /// The geoms of each part that touch others, each with the radius of the sphere around it, m.
    solids: Vec<Vec<(usize, f64, [i32; 2])>>,
}

impl Bodies {
    /// The bodies of a scene.
    pub fn new(setup: &Setup, scene: &Scene) -> Bodies {
        let model = &scene.model;
        let [_, left, right] = scene.hand_bodies;
        let parts: Vec<Part> = scene
            .parts
            .iter()
            .map(|(name, body)| Part {
                name: name.clone(),
                body: *body,
                is_peg: setup.assembly.kit.peg(name).is_some(),
                holder: scene.in_holder.get(name).cloned(),
            })
            .collect();
        let part = |id: &i32| pieces::part_of(model, *id as usize);
        let geom_body: Vec<usize> = model.geom_bodyid().iter().map(part).collect();
        let mut body_part = vec![None; geom_body.iter().max().map_or(0, |last| last + 1)];
        for (index, part) in parts.iter().enumerate() {
            if let Some(slot) = body_part.get_mut(part.body) {
                *slot = Some(index);
            }
        }
        let mut solids = vec![Vec::new(); parts.len()];
        let touches = model.geom_contype().iter().zip(model.geom_conaffinity());
        for (geom, (own, others)) in touches.enumerate() {
            if let Some(part) = body_part[geom_body[geom]].filter(|_| own | others != 0) {
                solids[part].push((geom, model.geom_rbound()[geom], [*own, *others]));
            }
        }
        let placed = setup
            .assembly
            .beams
            .iter()
            .enumerate()
            .filter_map(|(index, placed)| {
                let beam = &placed.beam;
                Some(Placed {
                    part: parts.iter().position(|part| part.name == beam.name)?,
                    clamped: index == setup.assembly.base,
                    x_wb: setup.assembly.kit.x_wa() * placed.x_ab,
                    holes: (0..beam.joints.len()).map(|joint| beam.p_b_hole(joint)).collect(),
                    links: beam
                        .links
                        .iter()
                        .map(|link| Point3::new((link.grasp[0] + link.grasp[1]) / 2.0, 0.0, 0.0))
                        .collect(),
                })
            })
            .collect();
        Bodies {
            parts,
            placed,
            holders: scene.holders.clone(),
            fingers: [left, right],
            geom_body,
            body_part,
            solids,
        }
    }

    /// Pose of a part in the world.
    pub fn pose(&self, data: &Data, part: usize) -> Pose {
        body_pose(data, self.parts[part].body)
    }

    /// Whether a beam of the goal stands in its place.
    pub fn in_place(&self, data: &Data, placed: &Placed) -> bool {
        let x_wb = self.pose(data, placed.part);
        (x_wb.translation.vector - placed.x_wb.translation.vector).norm() < IN_PLACE.0
            && x_wb.rotation.angle_to(&placed.x_wb.rotation) < IN_PLACE.1
    }

    /// The beams that stand in the assembly and are neither clamped nor held, as indices into
    /// [`Bodies::placed`].
    pub fn standing(&self, data: &Data, held: Option<usize>) -> Vec<usize> {
        (0..self.placed.len())
            .filter(|&index| {
                let placed = &self.placed[index];
                !placed.clamped && Some(placed.part) != held && self.in_place(data, placed)
            })
            .collect()
    }

    /// The point, m in the world, at which a part is within [`ENTERED`] of a beam that stands in the
    /// assembly: the middle between the two.
    fn entered(&self, data: &mut Data, part: usize) -> Option<Point3<f64>> {
        for placed in self.placed.iter().filter(|placed| placed.part != part) {
            if !placed.clamped && !self.in_place(data, placed) {
                continue;
            }
            for (one, reach, [is, meets]) in &self.solids[part] {
                for (other, radius, [are, met]) in &self.solids[placed.part] {
                    if is & met == 0 && are & meets == 0 {
                        continue;
                    }
                    let centre = |geom: usize| Vector3::from(data.geom_xpos()[geom]);
                    if (centre(*one) - centre(*other)).norm() > reach + radius + ENTERED {
                        continue;
                    }
                    let mut ends = [0.0; 6];
                    if data.geom_distance(*one, *other, ENTERED, Some(&mut ends)) < ENTERED {
                        let [x, y, z, to_x, to_y, to_z] = ends;
                        return Some(nalgebra::center(&Point3::new(x, y, z), &Point3::new(to_x, to_y, to_z)));
                    }
                }
            }
        }
        None
    }

    /// The holes of a beam that have a peg in them, in its frame, m.
    pub fn pins(&self, data: &Data, placed: &Placed) -> Vec<Point3<f64>> {
        let x_wb = self.pose(data, placed.part);
        let pegs: Vec<Vector3<f64>> = (0..self.parts.len())
            .filter(|&part| self.parts[part].is_peg)
            .map(|part| self.pose(data, part).translation.vector)
            .collect();
        placed
            .holes
            .iter()
            .filter(|hole| {
                let p = (x_wb * **hole).coords;
                pegs.iter().any(|peg| (peg - p).xy().norm() < 6.0e-3 && (peg - p).z.abs() < 25.0e-3)
            })
            .copied()
            .collect()
    }

    /// Horizontal distance of a point from a beam's joints and links, m.
    fn distance(&self, data: &Data, placed: &Placed, p_w: &Vector3<f64>) -> f64 {
        let x_wb = self.pose(data, placed.part);
        let away = |p_b: &Point3<f64>| ((x_wb * p_b).coords - p_w).xy().norm();
        placed.holes.iter().chain(&placed.links).map(away).fold(f64::INFINITY, f64::min)
    }
}

/// The part between the fingers.
#[derive(Clone, Debug)]
struct Grip {
    part: usize,
    /// Height at which it was gripped, m.
    height: f64,
    /// Time for which both fingers have touched it, and time since they last did, s.
    held: f64,
    missed: f64,
    lifted: bool,
    inserted: bool,
    before: Vector3<f64>,
}

/// A moment at which a fault may strike.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Occasion {
    /// A part was gripped, lifted, or the fingers closed on it.
    Part(usize),
    /// The hand left the assembly, in which beams stand.
    Left,
    /// A held part moves into a beam: where the two are nearest to each other, m, and the direction of its
    /// motion, both in the world.
    Inserted { part: usize, p_w: Point3<f64>, direction: Vector3<f64> },
}

/// Watches for the occasions of one kind of fault.
#[derive(Clone, Debug)]
pub(super) struct Watch {
    kind: FaultKind,
    grip: Option<Grip>,
    /// Time since a finger last touched a part, s.
    untouched: f64,
    /// Whether the hand has worked at the assembly since it was last away.
    worked: bool,
}

impl Watch {
    pub fn new(kind: FaultKind) -> Watch {
        Watch { kind, grip: None, untouched: LET_GO, worked: false }
    }

    /// Number of control periods between two checks: one for a kind that needs the exact moment.
    pub fn every(&self) -> u64 {
        if self.kind == FaultKind::GripperWeak { 1 } else { 10 }
    }

    /// The part between the fingers.
    pub fn held(&self) -> Option<usize> {
        self.grip.as_ref().map(|grip| grip.part)
    }

    /// Checks the world; returns an occasion when it has come. `fingers` is the speed at which they open,
    /// m/s.
    pub fn look(&mut self, bodies: &Bodies, data: &mut Data, x_wt: &Pose, fingers: f64) -> Option<Occasion> {
        let passed = self.every() as f64 * PERIOD;
        // Parts that each finger touches.
        let mut touched: [Vec<usize>; 2] = [Vec::new(), Vec::new()];
        for contact in data.contact() {
            let touching = contact.geom.map(|geom| {
                usize::try_from(geom).ok().and_then(|geom| bodies.geom_body.get(geom)).copied().unwrap_or(0)
            });
            for (one, other) in [(touching[0], touching[1]), (touching[1], touching[0])] {
                let Some(part) = bodies.body_part.get(other).copied().flatten() else { continue };
                if let Some(finger) = bodies.fingers.iter().position(|finger| *finger == one) {
                    touched[finger].push(part);
                }
            }
        }
        let closed = self.closing(&touched, fingers, passed);
        let gripped = self.grip(bodies, data, &touched, passed);
        let lifted = self.lifted(bodies, data);
        match self.kind {
            FaultKind::PegDropped | FaultKind::PegTilted | FaultKind::HolderShifted => {
                lifted.filter(|part| bodies.parts[*part].is_peg).map(Occasion::Part)
            }
            FaultKind::BeamSlipped | FaultKind::BeamTurned => {
                lifted.filter(|part| !bodies.parts[*part].is_peg).map(Occasion::Part)
            }
            FaultKind::BeamBumped => self.left(bodies, data, x_wt).then_some(Occasion::Left),
            FaultKind::Jam => self.inserted(bodies, data, passed),
            FaultKind::GripperWeak => closed.map(Occasion::Part),
            FaultKind::CameraFrozen | FaultKind::ForceDrift => gripped.map(Occasion::Part),
            FaultKind::PegMissing | FaultKind::TagCovered => None,
        }
    }

    /// The part that a closing finger touches first.
    fn closing(&mut self, touched: &[Vec<usize>; 2], fingers: f64, passed: f64) -> Option<usize> {
        let part = touched.iter().flatten().next().copied();
        let before = self.untouched;
        self.untouched = if part.is_some() { 0.0 } else { self.untouched + passed };
        part.filter(|_| before >= LET_GO && fingers < -CLOSING)
    }

    /// Follows what both fingers touch; the part in the look in which it counts as gripped.
    fn grip(
        &mut self,
        bodies: &Bodies,
        data: &Data,
        touched: &[Vec<usize>; 2],
        passed: f64,
    ) -> Option<usize> {
        let both = |part: usize| touched.iter().all(|one| one.contains(&part));
        let mut gripped = None;
        if let Some(grip) = &mut self.grip {
            if both(grip.part) {
                let before = grip.held;
                grip.held += passed;
                grip.missed = 0.0;
                gripped = (before < GRIPPED && grip.held >= GRIPPED).then_some(grip.part);
            } else {
                grip.missed += passed;
                if grip.missed > LET_GO {
                    self.grip = None;
                }
            }
        } else if let Some(part) = touched[0].iter().copied().find(|part| both(*part)) {
            let p_w = bodies.pose(data, part).translation.vector;
            self.grip = Some(Grip {
                part,
                height: p_w.z,
                held: passed,
                missed: 0.0,
                lifted: false,
                inserted: false,
                before: p_w,
            });
        }
        gripped
    }

    /// The held part in the look in which it counts as lifted.
    fn lifted(&mut self, bodies: &Bodies, data: &Data) -> Option<usize> {
        let grip =
            self.grip.as_mut().filter(|grip| grip.held >= GRIPPED && grip.missed == 0.0 && !grip.lifted)?;
        grip.lifted = bodies.pose(data, grip.part).translation.z - grip.height > LIFTED;
        grip.lifted.then_some(grip.part)
    }

    /// The held part in the look in which it first moves into a beam of the assembly.
    fn inserted(&mut self, bodies: &Bodies, data: &mut Data, passed: f64) -> Option<Occasion> {
        let grip = self.grip.as_mut()?;
        let p_w = bodies.pose(data, grip.part).translation.vector;
        let velocity = (p_w - grip.before) / passed;
        grip.before = p_w;
        let direction = velocity.try_normalize(INSERTING).filter(|_| grip.lifted && !grip.inserted)?;
        let p_w = bodies.entered(data, grip.part)?;
        grip.inserted = true;
        Some(Occasion::Inserted { part: grip.part, p_w, direction })
    }

    /// Whether the hand works at a beam.
    pub fn is_back(&self, bodies: &Bodies, data: &Data, beam: usize, x_wt: &Pose) -> bool {
        let p_w = x_wt.translation.vector;
        let placed = bodies.placed.iter().find(|placed| placed.part == beam);
        p_w.z < HEIGHTS[0] && placed.is_some_and(|placed| bodies.distance(data, placed, &p_w) < NEAR)
    }

    /// Whether the hand has just left an assembly in which beams stand.
    fn left(&mut self, bodies: &Bodies, data: &Data, x_wt: &Pose) -> bool {
        let p_w = x_wt.translation.vector;
        let standing = bodies.standing(data, self.held());
        let nearest = standing
            .iter()
            .map(|&index| bodies.distance(data, &bodies.placed[index], &p_w))
            .fold(f64::INFINITY, f64::min);
        if p_w.z < HEIGHTS[0] && nearest < NEAR {
            self.worked = true;
        }
        let left = self.worked && p_w.z > HEIGHTS[1] && nearest > NEAR && !standing.is_empty();
        self.worked &= !left;
        left
    }
}
