//! What every skill works with: the parts, the goal, the arm, the hand, and what is believed of the assembly.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use nalgebra::{Point2, Point3};
use ramp_assembly::{Assembly, JointRef};
use ramp_kit::Kit;
use ramp_motion::PathPlanner;
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;
use ramp_robot::{Cause, Event, EventKind, Robot};

use crate::belief::Belief;
use crate::grasp::BeamGrasp;
use crate::hand::Hand;
use crate::insertion_path::InsertionPath;
use crate::parameters::Parameters;

/// A point of a part: its name, and the point in its frame, m.
pub type Point = (String, Point3<f64>);

/// How a beam stands in the assembly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// Where its ends are on the table, m in the world.
    pub ends: [Point2<f64>; 2],
    /// How well that is known: standard deviation, m.
    pub deviation: f64,
}

/// What every skill works with.
pub struct Workcell<'a, 'r> {
    /// The parts.
    pub kit: &'a Kit,
    /// The goal.
    pub assembly: &'a Assembly,
    /// The arm.
    pub arm: &'a ArmModel,
    /// The motion planner.
    pub planner: &'a PathPlanner,
    /// The hand.
    pub hand: Hand<'r>,
    /// Where the parts are.
    pub belief: Belief,
    /// Beams that stand in the assembly, by index, the base among them.
    pub standing: Vec<usize>,
    /// Those of them that stand deeper than their place, by index, until they are slid forward.
    pub deep: Vec<usize>,
    /// Connections that are pinned, by index, and by which peg.
    pub pinned: Vec<(usize, String)>,
    /// Connections whose peg has come to stand on the male, by index: their holes are further apart than they
    /// seem.
    pub apart: Vec<usize>,
    /// How beams get to their places, by index: as the plan says.
    pub paths: BTreeMap<usize, InsertionPath>,
    /// How beams are to be gripped for which the usual grasp would not do, by name.
    pub grasps: BTreeMap<String, BeamGrasp>,
    /// Random numbers for the motion planner.
    pub stream: Stream,
    /// The numbers of the skills.
    pub parameters: Arc<Parameters>,
    /// Events that are not yet reported.
    pub events: Vec<Event>,
    /// It has been told that the wrist sensor is off.
    pub force_told: bool,
    /// How the beams of the assembly stood when the hand last left them, by index.
    pub stood: BTreeMap<usize, Stand>,
}

impl<'a, 'r> Workcell<'a, 'r> {
    /// A work cell with nothing built in it but the clamped beam. `seed` feeds the motion planner's random
    /// numbers.
    pub fn new(
        assembly: &'a Assembly,
        arm: &'a ArmModel,
        planner: &'a PathPlanner,
        robot: &'r mut dyn Robot,
        seed: u64,
        parameters: Arc<Parameters>,
    ) -> Workcell<'a, 'r> {
        Workcell {
            kit: &assembly.kit,
            assembly,
            arm,
            planner,
            hand: Hand::new(robot, arm, &parameters),
            belief: Belief::new(assembly, &parameters),
            standing: vec![assembly.base],
            deep: Vec::new(),
            pinned: Vec::new(),
            apart: Vec::new(),
            paths: BTreeMap::new(),
            grasps: BTreeMap::new(),
            stream: Stream::new(seed, "motion"),
            parameters,
            events: Vec::new(),
            force_told: false,
            stood: BTreeMap::new(),
        }
    }

    /// Records an event at the present robot time.
    pub fn record(&mut self, kind: impl Into<EventKind>) {
        self.events.push(Event::new(self.hand.time(), kind.into().plain()));
    }

    /// Records the cause of a disturbance, the part that it affects, and the evidence for it.
    pub fn diagnose<'p>(
        &mut self,
        cause: Cause,
        part: impl Into<Option<&'p str>>,
        evidence: impl fmt::Display,
    ) {
        let part = part.into().map(str::to_string);
        self.record(EventKind::Diagnosis { cause, part, evidence: evidence.to_string() });
    }

    /// The middle of a part.
    pub fn middle(&self, part: &str) -> Point {
        let x = self.kit.beam(part).map_or(0.0, |beam| beam.span() / 2.0);
        (part.to_string(), Point3::new(x, 0.0, 0.0))
    }

    /// The hole of a joint of the assembly.
    pub fn hole(&self, joint: JointRef) -> Point {
        let beam = &self.assembly.beams[joint.beam].beam;
        (beam.name.clone(), beam.p_b_hole(joint.joint))
    }
}
