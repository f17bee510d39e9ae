//! The scene of a rehearsal: parts, arm and hand at the current step of the plan. Skills read it to outline
//! their motions.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_kit::joint::FEMALE_HEIGHT;
use ramp_motion::{Checker, Joints, Obstacle, Pace, PathPlanner, TimeLaw};
use ramp_planner::{Entry, State};
use ramp_robot::arm::ArmModel;

use super::outline::{Done, InHand};
use crate::Pose;
use crate::belief::obstacles::{beam_boxes, held_boxes, holder_boxes, peg_boxes};
use crate::belief::outlines;
use crate::grasp::{BEAM_WIDTH, Grasp, PEG_HEIGHT, PEG_WIDTH, beam_grasps, peg_grasps, point_on, senses};
use crate::insertion_path::InsertionPath;
use crate::parameters::Parameters;
use crate::way::Way;

/// The scene of a rehearsal: the fixed scene, and the state that each motion changes.
pub struct Scene<'a> {
    /// The parts.
    pub kit: &'a Kit,
    /// The goal.
    pub assembly: &'a Assembly,
    /// The arm.
    pub arm: &'a ArmModel,
    /// The motion planner.
    pub planner: &'a PathPlanner,
    /// The numbers of the skills.
    pub parameters: Arc<Parameters>,
    /// The limits of the arm's motions.
    pub law: TimeLaw,
    /// The insertion paths of the plan, by index of the beam.
    pub paths: BTreeMap<usize, InsertionPath>,
    /// All that motions change.
    pub now: Now,
}

/// All that the motions of a rehearsal change.
#[derive(Clone, Debug)]
pub struct Now {
    /// Poses of the parts in the world, by name.
    pub parts: BTreeMap<String, Pose>,
    /// Beams that stand in the assembly, by index.
    pub standing: BTreeSet<usize>,
    /// Poses of the holders in the world, by name.
    pub holders: Vec<(String, Pose)>,
    /// Pinned connections, by index.
    pub pinned: BTreeSet<usize>,
    /// Joint positions, rad.
    pub q: Joints,
    /// The held part.
    pub held: Option<InHand>,
    /// The motions up to the current step.
    pub done: Vec<Done>,
}

impl<'a> Scene<'a> {
    /// Every part at its nominal pose in a state, and the arm in its home pose.
    pub fn nominal(
        assembly: &'a Assembly,
        arm: &'a ArmModel,
        planner: &'a PathPlanner,
        parameters: Arc<Parameters>,
        state: &State,
    ) -> Scene<'a> {
        let kit = &*assembly.kit;
        let mut parts = BTreeMap::new();
        let standing: BTreeSet<usize> = state
            .in_assembly
            .iter()
            .filter_map(|name| assembly.beam_index(name))
            .chain([assembly.base])
            .collect();
        for beam in &kit.beams {
            let place = assembly.beam_index(&beam.name).filter(|index| standing.contains(index));
            let pose = match place {
                Some(index) => Some(kit.x_wa() * assembly.beams[index].x_ab),
                None => kit.x_wb_start(beam),
            };
            parts.extend(pose.map(|pose| (beam.name.clone(), pose)));
        }
        for peg in &kit.pegs {
            if !state.lost_pegs.contains(&peg.name) {
                parts.extend(kit.x_wp_start(peg).map(|pose| (peg.name.clone(), pose)));
            }
        }
        let travel = &parameters.travel;
        let pace = Pace {
            velocity: travel.held_velocity,
            acceleration: travel.held_acceleration,
            jerk: travel.jerk,
            ramp: travel.ramp,
        };
        let law = TimeLaw::new(arm, &pace);
        let now = Now {
            parts,
            holders: outlines::holders(kit, std::iter::empty()),
            standing,
            pinned: BTreeSet::new(),
            q: Joints::from(arm.home),
            held: None,
            done: Vec::new(),
        };
        let mut scene = Scene { kit, assembly, arm, planner, parameters, law, paths: BTreeMap::new(), now };
        for (connection, peg) in &state.fastened {
            if let Some(index) = assembly.connection_index(connection) {
                let x_wp = scene.x_wp_seated(index);
                scene.now.parts.insert(peg.clone(), x_wp);
                scene.now.pinned.insert(index);
            }
        }
        scene
    }

    /// Takes over the insertion paths of a plan.
    pub fn follow_paths(&mut self, entries: &[Entry]) {
        for entry in entries {
            if let Some(beam) = self.assembly.beam_index(&entry.beam) {
                self.paths.insert(beam, InsertionPath::from(entry));
            }
        }
    }

    /// The pose of a part in the world; `None` for one that was never seen.
    pub fn x_wp(&self, part: &str) -> Option<Pose> {
        self.now.parts.get(part).copied()
    }

    /// The pose of the tip in the world.
    pub fn x_wt(&self) -> Pose {
        self.planner.kinematics.tip(&self.now.q)
    }

    /// The part in the hand, if it is this one.
    pub fn holds(&self, part: &str) -> Option<&InHand> {
        self.now.held.as_ref().filter(|held| held.part == part)
    }

    /// The pose of a beam in the world, `depth` (m) further along its insertion path than its place.
    pub fn x_wb_goal(&self, beam: usize, depth: f64) -> Pose {
        let x_wa = self.kit.x_wa();
        let along = self.paths.get(&beam).map_or(Vector3::zeros(), |path| path.direction * depth);
        Translation3::from(x_wa.rotation * along) * x_wa * self.assembly.beams[beam].x_ab
    }

    /// The pose of a seated peg in the world.
    pub fn x_wp_seated(&self, connection: usize) -> Pose {
        let hole: Point3<f64> =
            self.kit.x_wa() * self.assembly.p_a_hole(self.assembly.connections[connection].female);
        Pose::translation(hole.x, hole.y, hole.z + FEMALE_HEIGHT / 2.0)
    }

    /// The same pose of the tip at travelling height.
    pub fn raised(&self, x_wt: &Pose) -> Pose {
        let mut up = *x_wt;
        up.translation.z = up.translation.z.max(self.parameters.travel.height);
        up
    }

    /// The grasps of a part, a beam by a link, in the order in which the skills try them. None for a part
    /// that was never seen and for a link that the beam does not have.
    pub fn grasps(&self, part: &str, link: Option<&str>) -> Vec<Grasp> {
        let Some(x_wp) = self.x_wp(part) else { return Vec::new() };
        let Parameters { grip, travel, .. } = &*self.parameters;
        let way = |stops: &[Pose]| Way::along(stops, &self.now.q, self.planner, &self.law);
        let Some(beam) = self.kit.beam(part) else { return peg_grasps(&x_wp, grip).to_vec() };
        let link = link.and_then(|name| beam.links.iter().find(|link| link.name == name));
        let goal = self.assembly.beam_index(part).map(|index| self.x_wb_goal(index, 0.0));
        let grasps = link.map(|link| beam_grasps(beam, link, &x_wp, goal.as_ref(), grip, travel, way));
        grasps.unwrap_or_default().into_iter().flatten().map(|(grasp, _)| grasp).collect()
    }

    /// The grasps of a standing beam at the point of a link that is nearest to `wanted` (m from its j1 hole),
    /// the better sense of the hand first. None for a beam that was never seen and for a link that it does
    /// not have.
    pub fn standing_grasps(&self, part: &str, link: Option<&str>, wanted: f64) -> Vec<Grasp> {
        let (Some(x_wb), Some(beam)) = (self.x_wp(part), self.kit.beam(part)) else { return Vec::new() };
        let Some(link) = link.and_then(|name| beam.links.iter().find(|link| link.name == name)) else {
            return Vec::new();
        };
        let Parameters { grip, travel, .. } = &*self.parameters;
        let way = |stops: &[Pose]| Way::along(stops, &self.now.q, self.planner, &self.law);
        senses(point_on(link, wanted, grip), &x_wb, None, grip, travel, way).map(|(grasp, _)| grasp).to_vec()
    }

    /// Boxes of everything but some parts and the held one, in the world.
    pub fn obstacles(&self, without: Option<&str>) -> Vec<Obstacle> {
        let mut obstacles = holder_boxes(&self.now.holders);
        for (name, x) in &self.now.parts {
            if without == Some(name.as_str()) || self.holds(name).is_some() {
                continue;
            }
            match self.kit.beam(name) {
                Some(beam) => obstacles.extend(beam_boxes(beam, x)),
                None => obstacles.extend(peg_boxes(name, x)),
            }
        }
        obstacles
    }

    /// Boxes of the held part, in the tip's frame.
    pub fn held_boxes(&self) -> Vec<Obstacle> {
        self.now.held.as_ref().map_or(Vec::new(), |held| held_boxes(self.kit, &held.part, &held.x_tp))
    }

    /// The check of the arm, with the fingers `width` (m) apart and these boxes in the hand, among others.
    pub fn checker(&self, width: f64, held: Vec<Obstacle>, around: &[Obstacle], margin: f64) -> Checker {
        Checker::new(self.arm, width, held, around, margin)
    }

    /// The pose of a peg in the tip's frame.
    pub fn x_tp_peg() -> Pose {
        Pose::from_parts(
            Translation3::new(0.0, 0.0, PEG_HEIGHT),
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI),
        )
    }

    /// The distance of the fingers that hold a part, m.
    pub fn width(&self, part: &str) -> f64 {
        if self.kit.beam(part).is_some() { BEAM_WIDTH } else { PEG_WIDTH }
    }
}
