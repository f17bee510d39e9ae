//! The work cell that every skill works with: belief, hand, motion planner and journal.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use nalgebra::Vector2;
use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_motion::PathPlanner;
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;
use ramp_robot::{Cause, Event, EventKind, Robot};
use ramp_world::Start;

use super::assembly_belief::AssemblyBelief;
use super::journal::Journal;
use crate::grasp::BeamGrasp;
use crate::hand::Hand;
use crate::parameters::Parameters;

/// The work cell that every skill works with.
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
    /// The assembly as the agent believes it.
    pub belief: AssemblyBelief<'a>,
    /// Grasps of beams for which the usual one would not do, by name.
    pub grasps: BTreeMap<String, BeamGrasp>,
    /// The last grasp of each beam, by name.
    pub gripped: BTreeMap<String, BeamGrasp>,
    /// Links of standing beams by which a push did not bring them to their places, by the beam's index.
    pub pushed_by: BTreeMap<usize, Vec<String>>,
    /// Places of the table where a beam was laid down and could not be taken again, m.
    pub laid_at: Vec<Vector2<f64>>,
    /// Height of the tip over a beam's grasp at which the ribs really are in its slots, found by contact, m:
    /// the error of the arm against its table. `None` before a grasp has shown it.
    pub height_off: Option<f64>,
    /// Random numbers for the motion planner.
    pub stream: Stream,
    /// The numbers of the skills.
    pub parameters: Arc<Parameters>,
    /// Events, and observations with which later ones are compared.
    pub journal: Journal,
}

impl<'a, 'r> Workcell<'a, 'r> {
    /// A work cell with nothing built in it but the clamped beam. `seed` feeds the motion planner's random
    /// numbers, and `start` is what is known of the places of the parts.
    pub fn new(
        assembly: &'a Assembly,
        arm: &'a ArmModel,
        planner: &'a PathPlanner,
        robot: &'r mut dyn Robot,
        seed: u64,
        parameters: Arc<Parameters>,
        start: &Start,
    ) -> Workcell<'a, 'r> {
        let hand = Hand::new(robot, arm, &parameters);
        Workcell::with_hand(assembly, arm, planner, hand, seed, parameters, start)
    }

    /// The same with the hand of another work cell, which is moving: it goes on from there.
    pub fn with_hand(
        assembly: &'a Assembly,
        arm: &'a ArmModel,
        planner: &'a PathPlanner,
        hand: Hand<'r>,
        seed: u64,
        parameters: Arc<Parameters>,
        start: &Start,
    ) -> Workcell<'a, 'r> {
        Workcell {
            kit: &assembly.kit,
            assembly,
            arm,
            planner,
            hand,
            belief: AssemblyBelief::new(assembly, arm, &parameters, start),
            grasps: BTreeMap::new(),
            gripped: BTreeMap::new(),
            pushed_by: BTreeMap::new(),
            laid_at: Vec::new(),
            height_off: None,
            stream: Stream::new(seed, "motion"),
            parameters,
            journal: Journal::default(),
        }
    }

    /// Beams that stand and pegs that are seated.
    pub fn progress(&self) -> usize {
        self.belief.standing.len() + self.belief.pinned.len()
    }

    /// Records an event at the present robot time.
    pub fn record(&mut self, kind: impl Into<EventKind>) {
        self.journal.events.push(Event::new(self.hand.time(), kind.into().plain()));
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
}
