//! Goes through a plan with the arm's model before anything moves, and answers what the arm or the hand cannot do.
//!
//! A [`Rehearsal`] begins with where the parts are believed to be, and carries out one coarse action after another with
//! the kinematics and the motion planner alone: a grasp that is reachable and has room, a path there, a path with the
//! part to where its insertion begins, a straight insertion. What cannot be done becomes a [`MotionFact`] for the planner.
//! [`plan_with_motion`] plans and rehearses by turns until a plan passes.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;
use std::sync::Arc;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_kit::joint::{FEMALE_HEIGHT, STEM_LENGTH};
use ramp_motion::{Checker, Joints, MotionError, Obstacle, Pace, PathPlanner, Terms, TimeLaw};
use ramp_planner::{
    CoarseAction, CoarseStep, Domains, End, Entry, FineAction, Grasp, Impossible, InTheWay, Item, MotionFact,
    Place, Plan, PlanError, State, Target,
};
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;

use crate::Pose;
use crate::belief::obstacles::{beam_boxes, held_boxes, holder_boxes, peg_boxes};
use crate::grasp::{
    BEAM_WIDTH, BeamGrasp, PEG_HEIGHT, PEG_WIDTH, beam_grasp, hand_down, peg_grasp, points_on,
};
use crate::parameters::Parameters;
use crate::primitive::travel::Way;

/// The most facts that plan and rehearsal exchange before they give up: each takes away one grasp, path or order.
const MOST_FACTS: usize = 60;

/// A plan that the arm can carry out, and what was learned on the way to it.
#[derive(Clone, Debug)]
pub struct Rehearsed {
    /// The plan.
    pub plan: Plan,
    /// What the arm cannot do, in the order in which it was found; those of the given state come first.
    pub facts: Vec<MotionFact>,
    /// How beams are to be gripped for which the usual grasp would not do, by name.
    pub grasps: BTreeMap<String, UnusualGrasp>,
}

/// A grasp that is taken because the usual one would not do.
#[derive(Clone, Debug, PartialEq)]
pub struct UnusualGrasp {
    /// The grasp.
    pub grasp: BeamGrasp,
    /// Why the usual one would not do.
    pub because: String,
}

/// Why a motion does not exist.
#[derive(Clone, Debug)]
struct Refusal {
    because: String,
    /// What is in the way.
    touched: Option<String>,
    /// How far the motion got: the later refusal of two says more.
    stage: Stage,
}

/// The stages of bringing a beam to its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Stage {
    Grip,
    Reach,
    Approach,
    Insertion,
}

/// A motion through free space that a plan asks for.
#[derive(Clone, Debug)]
pub struct Leg {
    /// Joint positions at its start, rad.
    pub q: Joints,
    /// Pose of the tip at its end, in the world.
    pub x_wt: Pose,
    /// The hand stays level on the way.
    pub level: bool,
    /// How far the gripper is open, m.
    pub open: f64,
    /// Boxes of what the hand holds, in the tip's frame.
    pub held: Vec<Obstacle>,
    /// Boxes of everything else, in the world.
    pub around: Vec<Obstacle>,
}

/// What the arm or the hand does in a rehearsal.
#[derive(Clone, Debug)]
pub enum Done {
    /// A motion through free space, straight or not, that takes so many seconds.
    Free(f64),
    /// A straight motion in contact, m.
    Contact(f64),
    /// The fingers open or close by so many metres, with the tip at rest at a pose in the world.
    Fingers(Pose, f64),
}

/// A plan that is gone through with the arm's model.
pub struct Rehearsal<'a> {
    kit: &'a Kit,
    assembly: &'a Assembly,
    arm: &'a ArmModel,
    planner: &'a PathPlanner,
    parameters: Arc<Parameters>,
    /// Where the parts are, in the world, by name.
    parts: BTreeMap<String, Pose>,
    /// Beams in the assembly, by index.
    standing: BTreeSet<usize>,
    q: Joints,
    /// What was done so far.
    done: Vec<Done>,
    law: TimeLaw,
    stream: Stream,
    grasps: BTreeMap<String, UnusualGrasp>,
    /// The motions asked for so far, where somebody wants to know them.
    legs: Option<Vec<Leg>>,
}

impl<'a> Rehearsal<'a> {
    /// With every part where it nominally is in a state, and the arm in its home pose.
    pub fn nominal(
        assembly: &'a Assembly,
        arm: &'a ArmModel,
        planner: &'a PathPlanner,
        parameters: Arc<Parameters>,
        state: &State,
    ) -> Rehearsal<'a> {
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
        let q = Joints::from(arm.home);
        let (stream, grasps) = (Stream::new(0, "rehearsal"), BTreeMap::new());
        let travel = &parameters.travel;
        let pace = Pace {
            velocity: travel.held_velocity,
            acceleration: travel.held_acceleration,
            jerk: travel.jerk,
            ramp: travel.ramp,
        };
        let law = TimeLaw::new(arm, &pace);
        let mut rehearsal = Rehearsal {
            kit,
            assembly,
            arm,
            planner,
            parameters,
            parts,
            standing,
            q,
            done: Vec::new(),
            law,
            stream,
            grasps,
            legs: None,
        };
        for (connection, peg) in &state.fastened {
            if let Some(index) = assembly.connection_index(connection) {
                let x_wp = rehearsal.seated(index);
                rehearsal.parts.insert(peg.clone(), x_wp);
            }
        }
        rehearsal
    }

    /// With the parts where they are believed to be (poses in the world, by name), and the arm at `q` (rad); other parts stay
    /// where they nominally are. The motion planner draws from the episode's `seed`.
    #[must_use]
    pub fn from_here(
        mut self,
        believed: impl IntoIterator<Item = (String, Pose)>,
        q: Joints,
        seed: u64,
    ) -> Rehearsal<'a> {
        self.parts.extend(believed);
        self.q = q;
        self.stream = Stream::new(seed, "rehearsal");
        self
    }

    /// Goes through a plan; the grasps of beams for which the usual one would not do, by name.
    ///
    /// # Errors
    /// The first thing that the arm or the hand cannot do.
    pub fn check(mut self, plan: &Plan) -> Result<BTreeMap<String, UnusualGrasp>, MotionFact> {
        self.go_through(plan)?;
        Ok(self.grasps)
    }

    /// How long the arm moves through free space and straight to parts and places in a plan, by the motion planner, s. What
    /// the skills do besides takes longer: they look, press, search, open and close.
    ///
    /// # Errors
    /// As [`Rehearsal::check`].
    pub fn seconds(mut self, plan: &Plan) -> Result<f64, MotionFact> {
        self.go_through(plan)?;
        let seconds = |done: &Done| if let Done::Free(seconds) = done { *seconds } else { 0.0 };
        Ok(self.done.iter().map(seconds).sum())
    }

    /// What the arm and the hand do in a plan, timed by `law`. Pushes are left out: they move nothing that stands where it
    /// should.
    ///
    /// # Errors
    /// As [`Rehearsal::check`].
    pub fn done(mut self, plan: &Plan, law: TimeLaw) -> Result<Vec<Done>, MotionFact> {
        self.law = law;
        self.go_through(plan)?;
        Ok(self.done)
    }

    fn go_through(&mut self, plan: &Plan) -> Result<(), MotionFact> {
        for (index, step) in plan.steps.iter().enumerate() {
            self.step(step, &plan.steps[index + 1..], &plan.entries)?;
        }
        Ok(())
    }

    /// How long the way of the hand from one place to another takes if nothing is in the way, s; `None` where the arm does
    /// not reach one of them.
    fn way(&mut self, from: &Place, to: &Place) -> Option<f64> {
        let [from, to] = [from, to].map(|place| self.hand_at(place).map(|x_wt| self.raised(&x_wt)));
        let q = self.planner.posture(&from?);
        let checker = self.checker(self.parameters.grip.peg_open, Vec::new(), &[]);
        let height = self.parameters.travel.height;
        let terms = Terms { height, level: false, checker: &checker, law: &self.law };
        let way = self.planner.plan(&q, &to?, &terms, &mut self.stream);
        Some(way.ok()?.duration())
    }

    /// Where the hand is at a place, in the world.
    fn hand_at(&self, place: &Place) -> Option<Pose> {
        match place {
            Place::Input(Item::Peg(peg)) => Some(peg_grasp(self.parts.get(peg)?, 0)),
            Place::Input(Item::Beam(beam)) => {
                let middle = self.kit.beam(beam)?.span() / 2.0;
                Some(beam_grasp(self.parts.get(beam)?, middle, false))
            }
            Place::Approach(Target::Beam(beam)) | Place::Target(Target::Beam(beam)) => {
                let index = self.assembly.beam_index(beam)?;
                let middle = self.assembly.beams[index].beam.span() / 2.0;
                Some(beam_grasp(&self.goal(index, None, 0.0), middle, false))
            }
            Place::Approach(Target::Connection(name)) | Place::Target(Target::Connection(name)) => {
                let x_wp = self.seated(self.assembly.connection_index(name)?);
                Some(peg_grasp(&x_wp, 0))
            }
            Place::Above(_) => None,
        }
    }

    /// Goes through a plan as far as the arm can; all motions through free space that it asks for, those among them that do
    /// not exist.
    pub fn legs(mut self, plan: &Plan) -> Vec<Leg> {
        self.legs = Some(Vec::new());
        // Where it ends, its motions end.
        let _ = self.go_through(plan);
        self.legs.unwrap_or_default()
    }

    fn step(&mut self, step: &CoarseStep, rest: &[CoarseStep], entries: &[Entry]) -> Result<(), MotionFact> {
        for action in &step.fine {
            match action {
                FineAction::PickUp { item: Item::Beam(beam), grasp: Grasp::Link(link) } => {
                    let Some(index) = self.assembly.beam_index(beam) else { continue };
                    let regrasp = regrasped_by(beam, rest);
                    self.pick_up_beam(index, link, regrasp, entry_of(beam, entries))?;
                }
                FineAction::Fasten { connection, peg, .. } => {
                    if let Some(index) = self.assembly.connection_index(connection) {
                        self.fasten(index, peg)?;
                    }
                }
                FineAction::Push { beam, link } => {
                    if let Some(index) = self.assembly.beam_index(beam) {
                        let done = self.done.len();
                        self.grip_standing(index, link)?;
                        self.done.truncate(done);
                    }
                }
                FineAction::Slide { beam, link } => {
                    if let Some(index) = self.assembly.beam_index(beam) {
                        self.grip_standing(index, link)?;
                    }
                }
                _ => {}
            }
        }
        let placed = match &step.coarse {
            CoarseAction::Assemble { beam }
            | CoarseAction::LayDown { beam }
            | CoarseAction::AssembleDeep { beam } => self.assembly.beam_index(beam),
            _ => None,
        };
        if let Some(beam) = placed {
            self.standing.insert(beam);
            let name = self.assembly.beams[beam].beam.name.clone();
            let depth = entry_of(&name, entries).map_or(0.0, |entry| entry.depth);
            let goal = self.goal(beam, entry_of(&name, entries), depth);
            self.parts.insert(name, goal);
        }
        if let CoarseAction::Slide { beam } = &step.coarse
            && let Some(index) = self.assembly.beam_index(beam)
        {
            let depth = entry_of(beam, entries).map_or(0.0, |entry| entry.depth);
            self.done.push(Done::Contact(depth));
            self.parts.insert(beam.clone(), self.goal(index, None, 0.0));
        }
        Ok(())
    }

    // ---- Beams ------------------------------------------------------------------------------------------------

    /// A beam is picked up by a link, and brought to its place: by the same link, or by another one that it is regrasped by.
    fn pick_up_beam(
        &mut self,
        beam: usize,
        link: &str,
        regrasp: Option<&str>,
        entry: Option<&Entry>,
    ) -> Result<(), MotionFact> {
        let name = self.assembly.beams[beam].beam.name.clone();
        let before = self.now();
        let tried = self.bring(beam, link, regrasp, entry);
        let refusal = match tried {
            Ok(()) => return Ok(()),
            Err(refusal) => refusal,
        };
        let fact = |cannot: Impossible| self.fact(cannot, &refusal);
        if refusal.stage == Stage::Grip {
            return Err(fact(Impossible::Grasp { beam: name, link: link.to_string(), at: End::Start }));
        }
        let last = regrasp.unwrap_or(link);
        // Where no other link would do, either, it is the path that cannot be gone.
        let links = &self.assembly.beams[beam].beam.links;
        let others: Vec<String> =
            links.iter().map(|other| other.name.clone()).filter(|other| other != last).collect();
        let cannot = Impossible::Grasp { beam: name.clone(), link: last.to_string(), at: End::Place };
        let grasp = fact(cannot);
        let Some(entry) = entry else { return Err(grasp) };
        let path = fact(Impossible::Insert { beam: name, path: entry.path.clone() });
        for other in others {
            self.back_to(before);
            // Whether it can be gripped where it starts is another question.
            if self.bring(beam, &other, Some(&other), Some(entry)).is_ok() {
                return Err(grasp);
            }
        }
        Err(path)
    }

    /// Grips a beam where it starts and brings it to its place, the hand at any point of the link and in either sense.
    fn bring(
        &mut self,
        beam: usize,
        link: &str,
        regrasp: Option<&str>,
        entry: Option<&Entry>,
    ) -> Result<(), Refusal> {
        let placed = &self.assembly.beams[beam].beam;
        let (name, before) = (placed.name.clone(), self.now());
        let x_wb = self.parts.get(&name).copied();
        let mut worst: Option<Refusal> = None;
        for grasp in self.candidates(beam, link, x_wb) {
            self.back_to(before);
            if regrasp.is_none_or(|other| other != link) {
                let Some(x_wb) = x_wb else { continue };
                if let Err(refusal) = self.grip(&name, &beam_grasp(&x_wb, grasp.s, grasp.reverse)) {
                    keep(&mut worst, refusal);
                    continue;
                }
            }
            if regrasp.is_some_and(|other| other != link) {
                // By which point it is held at its place is chosen when it lies on the table.
                return regrasp.map_or(Ok(()), |other| self.bring(beam, other, Some(other), entry));
            }
            match self.place(beam, grasp, entry) {
                Ok(()) => {
                    // One that would be gripped sooner does not do.
                    let refusal = worst.filter(|refusal| refusal.stage > Stage::Grip && regrasp.is_none());
                    if let Some(Refusal { because, .. }) = refusal {
                        self.grasps.insert(name, UnusualGrasp { grasp, because });
                    }
                    return Ok(());
                }
                Err(refusal) => keep(&mut worst, refusal),
            }
        }
        self.back_to(before);
        Err(worst.unwrap_or(Refusal {
            because: "the link has no room for the fingers".to_string(),
            touched: None,
            stage: Stage::Grip,
        }))
    }

    /// The hand comes down on a part, open, with the tip at `x_wt`, and lifts it.
    fn grip(&mut self, part: &str, x_wt: &Pose) -> Result<(), Refusal> {
        let open = match self.kit.beam(part) {
            Some(_) => self.parameters.grip.beam_open,
            None => self.parameters.grip.peg_open,
        };
        let above = self.raised(x_wt);
        self.travel(&above, open, Vec::new(), &self.obstacles(&[]), Stage::Grip)?;
        let around = self.obstacles(&[part]);
        let checker = self.checker(open, Vec::new(), &around);
        self.straight(x_wt, &checker, Stage::Grip, "the fingers would touch")?;
        let width = if self.kit.beam(part).is_some() { BEAM_WIDTH } else { PEG_WIDTH };
        self.done.push(Done::Fingers(*x_wt, open - width));
        self.straight(&above, &checker, Stage::Grip, "the hand would touch")
    }

    /// The held beam is brought to its place, and the hand retreats.
    fn place(&mut self, beam: usize, grasp: BeamGrasp, entry: Option<&Entry>) -> Result<(), Refusal> {
        let name = self.assembly.beams[beam].beam.name.clone();
        let goal = self.goal(beam, entry, entry.map_or(0.0, |entry| entry.depth));
        let down = beam_grasp(&goal, grasp.s, grasp.reverse);
        let back = entry.map_or(Vector3::zeros(), |entry| {
            self.kit.x_wa().rotation * Vector3::from(entry.direction) * -(entry.distance + entry.depth)
        });
        let begin = Translation3::from(back + Vector3::z() * self.parameters.insertion.clear) * down;
        let held = held_boxes(self.kit, &name, &(down.inverse() * goal));
        let around = self.obstacles(&[&name]);
        self.travel(&begin, BEAM_WIDTH, held, &around, Stage::Approach)?;
        // Where joints go into each other the boxes of the beams overlap: what counts is the arm and the hand.
        let checker = Checker::new(self.arm, BEAM_WIDTH, Vec::new(), &around, 0.0);
        self.straight(&down, &checker, Stage::Insertion, "on its insertion path the hand would touch")?;
        // For the fingers that open there is room at some point of the link: the planner's geometry knows.
        self.done.push(Done::Fingers(down, self.parameters.grip.beam_release - BEAM_WIDTH));
        self.retreat();
        Ok(())
    }

    /// The grasps of a link in the order in which the skills try them: near the middle of the beam first, and of the two
    /// senses of the hand the one that keeps the joints from their ends, here and at the place, and takes less time.
    fn candidates(&self, beam: usize, link: &str, x_wb: Option<Pose>) -> Vec<BeamGrasp> {
        let placed = &self.assembly.beams[beam].beam;
        let Some(link) = placed.links.iter().find(|candidate| candidate.name == link) else {
            return Vec::new();
        };
        let goal = self.goal(beam, None, 0.0);
        let way = |grasp: &BeamGrasp| {
            let stops = [x_wb, Some(goal)].into_iter().flatten();
            let stops: Vec<Pose> = stops.map(|x_wb| beam_grasp(&x_wb, grasp.s, grasp.reverse)).collect();
            Way::along(&stops, &self.q, self.planner, &self.law)
        };
        let mut grasps = Vec::new();
        for s in points_on(link, placed.span() / 2.0, &self.parameters.grip) {
            let mut senses = [false, true].map(|reverse| {
                let grasp = BeamGrasp { s, reverse };
                (grasp, way(&grasp))
            });
            senses.sort_by(|(_, a), (_, b)| b.compare(a, &self.parameters.travel));
            grasps.extend(senses.map(|(grasp, _)| grasp));
        }
        grasps
    }

    /// A beam that stands is gripped by a link, to be pushed.
    fn grip_standing(&mut self, beam: usize, link: &str) -> Result<(), MotionFact> {
        let placed = &self.assembly.beams[beam].beam;
        let Some(x_wb) = self.parts.get(&placed.name).copied() else { return Ok(()) };
        let mut refused = None;
        for grasp in self.candidates(beam, link, Some(x_wb)) {
            let before = self.now();
            match self.grip(&placed.name, &beam_grasp(&x_wb, grasp.s, grasp.reverse)) {
                Ok(()) => return Ok(()),
                Err(refusal) => refused = refused.or(Some(refusal)),
            }
            self.back_to(before);
        }
        let cannot = Impossible::Grasp { beam: placed.name.clone(), link: link.to_string(), at: End::Place };
        match refused {
            Some(refusal) => Err(self.fact(cannot, &refusal)),
            None => Ok(()),
        }
    }

    // ---- Pegs -------------------------------------------------------------------------------------------------

    /// A peg is fetched and pressed into the hole of a connection.
    fn fasten(&mut self, connection: usize, peg: &str) -> Result<(), MotionFact> {
        let Some(x_wp) = self.parts.get(peg).copied() else { return Ok(()) };
        let before = self.now();
        let seated = self.seated(connection);
        let mut refused: Option<Refusal> = None;
        'grips: for quarter in [0, 2] {
            self.back_to(before);
            let down = peg_grasp(&x_wp, quarter);
            if let Err(refusal) = self.grip(peg, &down) {
                refused = refused.or(Some(refusal));
                continue;
            }
            let gripped = self.now();
            for step in [0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 4.0, -4.0, 5.0, -5.0, 6.0] {
                self.back_to(gripped);
                match self.press(peg, &seated, step * TAU / 12.0) {
                    Ok(()) => {
                        refused = None;
                        break 'grips;
                    }
                    Err(refusal) => keep(&mut refused, refusal),
                }
            }
        }
        match refused {
            None => {
                self.parts.insert(peg.to_string(), seated);
                Ok(())
            }
            Some(refusal) => {
                let name = self.assembly.connections[connection].name.clone();
                Err(self.fact(Impossible::Fasten { connection: name }, &refusal))
            }
        }
    }

    /// The held peg goes to its hole with the hand turned by `turn` (rad) from how it was gripped.
    fn press(&mut self, peg: &str, seated: &Pose, turn: f64) -> Result<(), Refusal> {
        let x = self.planner.kinematics.tip(&self.q).rotation * Vector3::x();
        let rotation = hand_down(x.y.atan2(x.x) + turn);
        let p = seated.translation.vector;
        let down = Pose::from_parts(Translation3::new(p.x, p.y, p.z + PEG_HEIGHT), rotation);
        let over = Translation3::new(0.0, 0.0, STEM_LENGTH + self.parameters.peg_search.over) * down;
        let around = self.obstacles(&[peg]);
        let x_tp = Pose::from_parts(
            Translation3::new(0.0, 0.0, PEG_HEIGHT),
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI),
        );
        let held = held_boxes(self.kit, peg, &x_tp);
        let open = self.parameters.grip.peg_open;
        self.travel(&over, open, held, &around, Stage::Approach)?;
        let checker = Checker::new(self.arm, open, Vec::new(), &around, 0.0);
        self.straight(&down, &checker, Stage::Insertion, "the hand with the peg would touch")?;
        self.done.push(Done::Fingers(down, open - PEG_WIDTH));
        self.retreat();
        Ok(())
    }

    // ---- Motions ----------------------------------------------------------------------------------------------

    /// Through free space to a pose of the tip, the gripper so far open, with what it holds and among what is around.
    fn travel(
        &mut self,
        x_wt: &Pose,
        open: f64,
        held: Vec<Obstacle>,
        around: &[Obstacle],
        stage: Stage,
    ) -> Result<(), Refusal> {
        let level = stage > Stage::Grip;
        if let Some(legs) = &mut self.legs {
            let (held, around) = (held.clone(), around.to_vec());
            legs.push(Leg { q: self.q, x_wt: *x_wt, level, open, held, around });
        }
        let checker = self.checker(open, held, around);
        let terms = Terms { height: self.parameters.travel.height, level, checker: &checker, law: &self.law };
        match self.planner.plan(&self.q, x_wt, &terms, &mut self.stream) {
            Ok(trajectory) => {
                self.q = trajectory.end();
                self.done.push(Done::Free(trajectory.duration()));
                Ok(())
            }
            // How the arm gets away from where it stands says nothing of the plan.
            Err(MotionError::Blocked("start")) => {
                self.q = self.planner.solve(x_wt, &self.q).unwrap_or(self.q);
                Ok(())
            }
            Err(error) => Err(self.refusal(&error, x_wt, &checker, stage)),
        }
    }

    /// Why there is no path to a pose of the tip.
    fn refusal(&self, error: &MotionError, x_wt: &Pose, checker: &Checker, stage: Stage) -> Refusal {
        let solved = self.planner.solve(x_wt, &self.q).ok();
        let touched =
            solved.and_then(|q| checker.touched(&self.planner.kinematics.frames(&q)).map(str::to_string));
        match (error, &touched) {
            (MotionError::Unreachable(_), _) => Refusal {
                because: error.to_string(),
                touched: None,
                stage: if stage == Stage::Grip { Stage::Grip } else { Stage::Reach },
            },
            (_, Some(name)) => Refusal { because: format!("the arm would touch {name}"), touched, stage },
            _ => Refusal { because: error.to_string(), touched, stage },
        }
    }

    /// Straight to a pose of the tip, touching nothing. Where the arm cannot follow from the posture in which it arrived,
    /// it takes another one first, as the skills do.
    fn straight(
        &mut self,
        x_wt: &Pose,
        checker: &Checker,
        stage: Stage,
        would_touch: &str,
    ) -> Result<(), Refusal> {
        let planner = self.planner;
        let leg = planner.straight(&self.q, x_wt).or_else(|| {
            planner
                .posture_for(&planner.kinematics.tip(&self.q), x_wt)
                .and_then(|q| planner.straight(&q, x_wt))
        });
        let Some(leg) = leg else {
            let because = "the arm cannot follow the straight motion".to_string();
            return Err(Refusal { because, touched: None, stage });
        };
        for q in &leg {
            if let Some(name) = checker.touched(&planner.kinematics.frames(q)) {
                let because = format!("{would_touch} {name}");
                return Err(Refusal { because, touched: Some(name.to_string()), stage });
            }
        }
        self.done.push(match stage {
            Stage::Insertion => {
                let here = planner.kinematics.tip(&self.q).translation.vector;
                Done::Contact((x_wt.translation.vector - here).norm())
            }
            _ => Done::Free(self.law.time(&leg).duration()),
        });
        self.q = leg.last().copied().unwrap_or(self.q);
        Ok(())
    }

    /// Where the arm is, rad, and how much was done so far.
    fn now(&self) -> (Joints, usize) {
        (self.q, self.done.len())
    }

    /// What came after is tried in another way.
    fn back_to(&mut self, (q, done): (Joints, usize)) {
        self.q = q;
        self.done.truncate(done);
    }

    /// The hand goes straight up to travelling height, by no path that is planned.
    fn retreat(&mut self) {
        let up = self.raised(&self.planner.kinematics.tip(&self.q));
        if let Some(line) = self.planner.straight(&self.q, &up) {
            self.done.push(Done::Free(self.law.time(&line).duration()));
        }
        self.q = self.planner.solve(&up, &self.q).unwrap_or(self.q);
    }

    fn checker(&self, width: f64, held: Vec<Obstacle>, around: &[Obstacle]) -> Checker {
        Checker::new(self.arm, width, held, around, self.parameters.travel.margin)
    }

    /// Everything but some parts, in the world.
    fn obstacles(&self, without: &[&str]) -> Vec<Obstacle> {
        let mut obstacles = holder_boxes(self.kit);
        for (name, x) in &self.parts {
            if without.contains(&name.as_str()) {
                continue;
            }
            match self.kit.beam(name) {
                Some(beam) => obstacles.extend(beam_boxes(beam, x)),
                None => obstacles.extend(peg_boxes(name, x)),
            }
        }
        obstacles
    }

    /// The same pose of the tip at travelling height.
    fn raised(&self, x_wt: &Pose) -> Pose {
        let mut up = *x_wt;
        up.translation.z = up.translation.z.max(self.parameters.travel.height);
        up
    }

    /// Where a beam is to stand, in the world, `depth` (m) further along its path than its place.
    fn goal(&self, beam: usize, entry: Option<&Entry>, depth: f64) -> Pose {
        let x_wa = self.kit.x_wa();
        let along = entry.map_or(Vector3::zeros(), |entry| Vector3::from(entry.direction) * depth);
        Translation3::from(x_wa.rotation * along) * x_wa * self.assembly.beams[beam].x_ab
    }

    /// Where a peg is when it is seated, in the world.
    fn seated(&self, connection: usize) -> Pose {
        let hole: Point3<f64> =
            self.kit.x_wa() * self.assembly.p_a_hole(self.assembly.connections[connection].female);
        Pose::translation(hole.x, hole.y, hole.z + FEMALE_HEIGHT / 2.0)
    }

    /// What cannot be done, with what is in the way where that is a beam which was put there.
    fn fact(&self, cannot: Impossible, refusal: &Refusal) -> MotionFact {
        let past = refusal.touched.as_deref().and_then(|name| self.assembly.beam_index(name));
        let past = past.filter(|beam| *beam != self.assembly.base).map(|beam| {
            let name = self.assembly.beams[beam].beam.name.clone();
            if self.standing.contains(&beam) { InTheWay::Stands(name) } else { InTheWay::OnSheet(name) }
        });
        MotionFact { cannot, past, because: refusal.because.clone() }
    }
}

/// Keeps the refusal of the motion that got furthest.
fn keep(worst: &mut Option<Refusal>, refusal: Refusal) {
    if worst.as_ref().is_none_or(|other| refusal.stage > other.stage) {
        *worst = Some(refusal);
    }
}

/// How a plan brings a beam to its place.
fn entry_of<'e>(beam: &str, entries: &'e [Entry]) -> Option<&'e Entry> {
    entries.iter().find(|entry| entry.beam == beam)
}

/// By which link a beam is regrasped before it is placed.
fn regrasped_by<'s>(beam: &str, rest: &'s [CoarseStep]) -> Option<&'s str> {
    let placed = |step: &CoarseStep| match &step.coarse {
        CoarseAction::Assemble { beam: placed }
        | CoarseAction::LayDown { beam: placed }
        | CoarseAction::AssembleDeep { beam: placed } => placed == beam,
        _ => false,
    };
    let way = rest.iter().take_while(|step| !placed(step));
    way.flat_map(|step| &step.fine).find_map(|action| match action {
        FineAction::Regrasp { beam: other, link } if other == beam => Some(link.as_str()),
        _ => None,
    })
}

/// Plans for parts that are where they nominally are, and goes through the plan with the arm's model.
///
/// # Errors
/// As [`plan_with_motion`].
pub fn plan_for_arm(
    assembly: &Assembly,
    arm: &ArmModel,
    state: &State,
    domains: &Domains,
) -> Result<Rehearsed, PlanError> {
    let (planner, parameters) = (PathPlanner::new(arm), Parameters::baseline());
    plan_with_motion(assembly, state, domains, || {
        Rehearsal::nominal(assembly, arm, &planner, parameters.clone(), state)
    })
}

/// A plan that was made quicker.
#[derive(Clone, Debug)]
pub struct Quicker {
    /// The plan.
    pub plan: Plan,
    /// How long its motions take, as [`Rehearsal::seconds`] tells, s.
    pub seconds: f64,
    /// How long those of the plan took that it was made from, s.
    pub before: f64,
}

/// Makes a plan quicker that the arm can carry out: parts are where they nominally are in `state`, the ways of the hand
/// between them are timed by the motion planner, and [`ramp_planner::quicker`] exchanges pegs and fastenings. The plan stays
/// as it is where the rehearsal finds the other one slower or impossible.
///
/// # Errors
/// When the state cannot be, or the arm cannot carry out the plan.
pub fn quicker_for_arm(
    assembly: &Assembly,
    arm: &ArmModel,
    state: &State,
    domains: &Domains,
    plan: &Plan,
) -> Result<Quicker, PlanError> {
    let (planner, parameters) = (PathPlanner::new(arm), Parameters::baseline());
    let rehearsal = || Rehearsal::nominal(assembly, arm, &planner, parameters.clone(), state);
    let before = rehearsal().seconds(plan).map_err(|fact| PlanError::Motion {
        goal: assembly.name.clone(),
        why: "the arm cannot carry out the plan".to_string(),
        reasons: fact.to_string(),
    })?;
    let mut ways = rehearsal();
    let mut cost = |from: &Place, to: &Place| {
        ways.way(from, to).map_or(u64::from(u32::MAX), |seconds| (seconds * 1e3).round() as u64)
    };
    let (tried, _) = ramp_planner::quicker(assembly, state, domains, plan, &mut cost)?;
    Ok(match rehearsal().seconds(&tried) {
        Ok(seconds) if seconds < before => Quicker { plan: tried, seconds, before },
        _ => Quicker { plan: plan.clone(), seconds: before, before },
    })
}

/// Plans, and goes through the plan with the arm's model; what the arm cannot do becomes a fact, and the planner plans
/// again, until a plan passes. `rehearsal` gives the world at the beginning.
///
/// # Errors
/// The planner's, when no plan is left; it then says what the arm cannot do.
pub fn plan_with_motion<'a>(
    assembly: &Assembly,
    state: &State,
    domains: &Domains,
    mut rehearsal: impl FnMut() -> Rehearsal<'a>,
) -> Result<Rehearsed, PlanError> {
    let mut state = state.clone();
    loop {
        let plan = ramp_planner::plan(assembly, &state, domains)?;
        match rehearsal().check(&plan) {
            Ok(grasps) => return Ok(Rehearsed { plan, facts: state.motion, grasps }),
            // The same answer again, or too many: the plan is carried out as far as it goes.
            Err(fact) if state.motion.contains(&fact) || state.motion.len() >= MOST_FACTS => {
                let facts = state.motion;
                return Err(PlanError::Motion {
                    goal: assembly.name.clone(),
                    why: "the arm finds no plan that it can carry out".to_string(),
                    reasons: facts.iter().map(MotionFact::to_string).collect::<Vec<_>>().join("; "),
                });
            }
            Err(fact) => state.motion.push(fact),
        }
    }
}
