//! Searches the alternatives of a plan's skills for motions that carry the plan out.
//!
//! An action that takes a part into the hand opens a choice that is settled only when the part has left the
//! hand, or is regrasped: a grasp that is free at the start may be impossible at the place. Within such a
//! hold the search goes depth first, each skill's preferred alternative first. The refusal that got furthest
//! explains a failure.

use std::collections::BTreeMap;

use ramp_assembly::Assembly;
use ramp_motion::{Joints, PathPlanner, TimeLaw};
use ramp_planner::{CoarseStep, FineAction, MotionFact, Plan, State};
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;

use super::blame::{cannot_insert, fact};
use super::outline::{Done, Leg, Motion, Outline, Refusal, Stage};
use super::scene::{Now, Scene};
use super::walk::Walk;
use crate::Pose;
use crate::grasp::BeamGrasp;
use crate::parameters::Parameters;
use crate::skill::{ActionKind, Call, Effect};
use crate::table::SkillTable;

/// A grasp that is taken because the usual one would not do.
#[derive(Clone, Debug, PartialEq)]
pub struct UnusualGrasp {
    /// The grasp.
    pub grasp: BeamGrasp,
    /// The reason why the usual one would not do.
    pub because: String,
}

/// A plan that is gone through with the arm's model.
pub struct Rehearsal<'a> {
    pub(super) scene: Scene<'a>,
    pub(super) skills: SkillTable,
    pub(super) walk: Walk,
    grasps: BTreeMap<String, UnusualGrasp>,
    /// Grasps of beams that are the last choice, by name: they were tried.
    tried: BTreeMap<String, Vec<BeamGrasp>>,
    /// Names of the skills that cannot rehearse, in the order of their first action.
    unknown: Vec<String>,
}

/// A plan's demands on the arm, after the rehearsal.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// Grasps of beams for which the usual one would not do, by name.
    pub grasps: BTreeMap<String, UnusualGrasp>,
    /// Names of the skills that cannot rehearse: their actions count as possible.
    pub not_rehearsed: Vec<String>,
}

/// The step of a plan that the arm or the hand cannot carry out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("step {step}, {action}: {fact}")]
pub struct Stuck {
    /// Number of the coarse step, from 1.
    pub step: usize,
    /// The coarse action in words.
    pub action: String,
    /// The motion that is not possible, with the reason.
    pub fact: MotionFact,
}

impl Stuck {
    /// What a planner can do about it.
    pub fn remedy(&self) -> String {
        self.fact.remedy()
    }
}

/// The action that failed, by its index among the fine actions of the plan, and why.
struct Failure {
    action: usize,
    refusal: Refusal,
}

/// The fine actions of a plan, each with its coarse step.
struct Script<'p> {
    steps: &'p [CoarseStep],
    actions: Vec<(usize, &'p FineAction)>,
}

impl<'p> Script<'p> {
    fn new(plan: &'p Plan) -> Script<'p> {
        let actions = plan.steps.iter().enumerate();
        let actions = actions.flat_map(|(step, it)| it.fine.iter().map(move |action| (step, action)));
        Script { steps: &plan.steps, actions: actions.collect() }
    }

    fn call(&self, index: usize) -> Call<'p> {
        let (step, action) = self.actions[index];
        Call { action, plan: self.steps, step }
    }
}

impl<'a> Rehearsal<'a> {
    /// A rehearsal of these skills that begins with a scene.
    pub fn new(scene: Scene<'a>, skills: SkillTable) -> Rehearsal<'a> {
        let walk = Walk { stream: Stream::new(0, "rehearsal"), legs: None };
        let (grasps, tried) = (BTreeMap::new(), BTreeMap::new());
        Rehearsal { scene, skills, walk, grasps, tried, unknown: Vec::new() }
    }

    /// A rehearsal of the baseline's skills, with every part at its nominal pose in a state.
    pub fn of_baseline(
        assembly: &'a Assembly,
        arm: &'a ArmModel,
        planner: &'a PathPlanner,
        state: &State,
    ) -> Rehearsal<'a> {
        let scene = Scene::nominal(assembly, arm, planner, Parameters::baseline(), state);
        Rehearsal::new(scene, SkillTable::default())
    }

    /// With the parts where they are believed to be (poses in the world, by name), and the arm at `q` (rad);
    /// other parts stay at their nominal poses. The motion planner draws from the episode's `seed`.
    #[must_use]
    pub fn from_here(
        mut self,
        believed: impl IntoIterator<Item = (String, Pose)>,
        q: Joints,
        seed: u64,
    ) -> Rehearsal<'a> {
        self.scene.now.parts.extend(believed);
        self.scene.now.q = q;
        self.walk.stream = Stream::new(seed, "rehearsal");
        self
    }

    /// Without the parts that are not among these, if parts lie anywhere: nobody knows where they are.
    #[must_use]
    pub fn without_unseen(mut self, seen: Option<&[(String, Pose)]>) -> Rehearsal<'a> {
        let is_seen = |part: &str| seen.is_none_or(|seen| seen.iter().any(|(known, _)| known == part));
        self.scene.now.parts.retain(|part, _| is_seen(part));
        self
    }

    /// Without parts that were lost: nobody knows where they are.
    #[must_use]
    pub fn without_lost(mut self, is_lost: impl Fn(&str) -> bool) -> Rehearsal<'a> {
        self.scene.now.parts.retain(|part, _| !is_lost(part));
        self
    }

    /// With these grasps of beams, by name, as the last choice: they were tried.
    #[must_use]
    pub fn without_grasps(mut self, tried: BTreeMap<String, Vec<BeamGrasp>>) -> Rehearsal<'a> {
        self.tried = tried;
        self
    }

    /// With the holders at these poses, by name, instead of on their outlines.
    pub fn with_holders(mut self, holders: Vec<(String, Pose)>) -> Rehearsal<'a> {
        self.scene.now.holders = holders;
        self
    }

    /// Goes through a plan.
    ///
    /// # Errors
    /// The first thing that the arm or the hand cannot do.
    pub fn check(self, plan: &Plan) -> Result<Findings, MotionFact> {
        self.check_steps(plan).map_err(|stuck| stuck.fact)
    }

    /// As [`Rehearsal::check`], with the step of the plan in the error.
    ///
    /// # Errors
    /// The first step that the arm or the hand cannot carry out.
    pub fn check_steps(mut self, plan: &Plan) -> Result<Findings, Box<Stuck>> {
        self.go_through(plan)?;
        Ok(Findings { grasps: self.grasps, not_rehearsed: self.unknown })
    }

    /// Time of the motions of a plan through free space and straight to parts and places, by the motion
    /// planner, s. Looks, presses, searches and the gripper are not in it.
    ///
    /// # Errors
    /// As [`Rehearsal::check`].
    pub fn seconds(mut self, plan: &Plan) -> Result<f64, MotionFact> {
        self.go_through(plan).map_err(|stuck| stuck.fact)?;
        let seconds = |done: &Done| if let Done::Free(seconds) = done { *seconds } else { 0.0 };
        Ok(self.scene.now.done.iter().map(seconds).sum())
    }

    /// All motions of arm and hand in a plan, timed by `law`. Those of actions that only align a beam are
    /// left out: a beam that stands at its place needs none.
    ///
    /// # Errors
    /// As [`Rehearsal::check`].
    pub fn done(mut self, plan: &Plan, law: TimeLaw) -> Result<Vec<Done>, MotionFact> {
        self.scene.law = law;
        self.go_through(plan).map_err(|stuck| stuck.fact)?;
        Ok(self.scene.now.done)
    }

    /// All motions through free space that a plan asks for, as far as the arm can carry it out, those among
    /// them that do not exist.
    pub fn legs(mut self, plan: &Plan) -> Vec<Leg> {
        self.walk.legs = Some(Vec::new());
        // The motions end where the arm is blocked.
        let _ = self.go_through(plan);
        self.walk.legs.unwrap_or_default()
    }

    fn go_through(&mut self, plan: &Plan) -> Result<(), Box<Stuck>> {
        self.scene.follow_paths(&plan.entries);
        let script = Script::new(plan);
        let mut index = 0;
        while index < script.actions.len() {
            let end = self.end_of_choice(&script, index);
            let before = self.scene.now.clone();
            let mut furthest = None;
            if !self.search(&script, index..end, &mut furthest) {
                self.scene.now = before;
                let failure = furthest.unwrap_or(Failure {
                    action: index,
                    refusal: Refusal {
                        because: "the link has no room for the fingers".to_string(),
                        touched: None,
                        stage: Stage::Grasp,
                    },
                });
                match self.explain(plan, &script, index..end, &failure) {
                    Some(fact) => {
                        let step = script.actions[failure.action].0;
                        let action = plan.steps[step].coarse.to_string();
                        return Err(Box::new(Stuck { step: step + 1, action, fact }));
                    }
                    None => self.count_as_possible(&script, index..end),
                }
            }
            index = end;
        }
        Ok(())
    }

    fn expects(&self, call: &Call, effect: Effect) -> bool {
        self.skills.get(call.kind()).is_some_and(|skill| skill.expects().contains(&effect))
    }

    /// The action behind the last one that the choice at `index` decides about.
    fn end_of_choice(&self, script: &Script, index: usize) -> usize {
        if !self.expects(&script.call(index), Effect::HoldsPart) {
            return index + 1;
        }
        for next in index + 1..script.actions.len() {
            let call = script.call(next);
            if self.expects(&call, Effect::HoldsPart) {
                return next;
            }
            if self.expects(&call, Effect::HandEmpty) {
                return next + 1;
            }
        }
        script.actions.len()
    }

    /// Carries out a range of actions, with the first alternatives that lead to its end. False when none
    /// does: `furthest` is then the refusal that got furthest.
    fn search(
        &mut self,
        script: &Script,
        range: std::ops::Range<usize>,
        furthest: &mut Option<Failure>,
    ) -> bool {
        if range.is_empty() {
            return true;
        }
        let call = script.call(range.start);
        let skill = self.skills.get(call.kind());
        let mut alternatives =
            match skill.map_or(Outline::Unknown, |skill| skill.rehearse(&self.scene, &call)) {
                Outline::Alternatives(alternatives) => alternatives,
                Outline::Unknown => {
                    self.note_unknown(&call);
                    vec![Vec::new()]
                }
            };
        let tried = call.part().and_then(|part| self.tried.get(part)).filter(|_| is_pick_up(&call));
        if let Some(tried) = tried {
            alternatives.sort_by_key(|motions| grasp_of(motions).is_some_and(|it| tried.contains(&it)));
        }
        let tried = tried.is_some();
        let before = self.scene.now.clone();
        let mut own: Option<Failure> = None;
        for motions in alternatives {
            self.scene.now = before.clone();
            if let Err(refusal) = self.walk.series(&mut self.scene, &motions) {
                keep(&mut own, Failure { action: range.start, refusal });
                continue;
            }
            let grasp = self.scene.now.held.as_ref().and_then(|held| Some((held.part.clone(), held.grasp?)));
            self.take_effect(&call, &before);
            if self.search(script, range.start + 1..range.end, &mut own) {
                // A grasp that would be taken sooner does not do.
                let sooner = own.filter(|failure| failure.refusal.stage > Stage::Grasp);
                let because = match sooner {
                    Some(failure) => Some(failure.refusal.because),
                    None => tried.then(|| "it failed before".to_string()),
                };
                if let (true, Some((part, grasp)), Some(because)) = (is_pick_up(&call), grasp, because) {
                    self.grasps.insert(part, UnusualGrasp { grasp, because });
                }
                return true;
            }
        }
        if let Some(own) = own {
            keep(furthest, own);
        }
        false
    }

    /// Applies the effects of some actions without a motion.
    fn count_as_possible(&mut self, script: &Script, range: std::ops::Range<usize>) {
        for index in range {
            let (call, before) = (script.call(index), self.scene.now.clone());
            self.note_unknown(&call);
            self.take_effect(&call, &before);
        }
    }

    /// Keeps the name of a skill that cannot rehearse.
    fn note_unknown(&mut self, call: &Call) {
        let name = self.skills.get(call.kind()).map(|skill| skill.name().to_string());
        if let Some(name) = name.filter(|name| !self.unknown.contains(name)) {
            self.unknown.push(name);
        }
    }

    /// Applies the effects of an action that its skill expects.
    fn take_effect(&mut self, call: &Call, before: &Now) {
        let effects = self.skills.get(call.kind()).map(|skill| skill.expects().to_vec()).unwrap_or_default();
        let assembly = self.scene.assembly;
        for effect in effects {
            match effect {
                Effect::BeamStands | Effect::BeamAtPlace | Effect::BeamDeep => {
                    let Ok(beam) = call.beam(assembly) else { continue };
                    let path = self.scene.paths.get(&beam).filter(|_| effect != Effect::BeamAtPlace);
                    let x_wb = self.scene.x_wb_goal(beam, path.map_or(0.0, |path| path.depth));
                    self.scene.now.standing.insert(beam);
                    self.scene.now.parts.insert(assembly.beams[beam].beam.name.clone(), x_wb);
                }
                Effect::PegSeated => {
                    let (Ok(connection), Some(peg)) = (call.connection(assembly), call.part()) else {
                        continue;
                    };
                    let x_wp = self.scene.x_wp_seated(connection);
                    self.scene.now.parts.insert(peg.to_string(), x_wp);
                    self.scene.now.pinned.insert(connection);
                }
                Effect::BeamOut => {
                    if let Ok(beam) = call.beam(assembly) {
                        self.scene.now.standing.remove(&beam);
                    }
                }
                Effect::PegOut => {
                    if let Ok(connection) = call.connection(assembly) {
                        self.scene.now.pinned.remove(&connection);
                    }
                }
                Effect::HandEmpty => self.scene.now.held = None,
                // If the beam is at its place, nothing has to move.
                Effect::BeamAligned => self.scene.now.done.clone_from(&before.done),
                Effect::HoldsPart => {}
            }
        }
    }

    /// The fact for the planner that a failure becomes; `None` where no skill has one.
    fn explain(
        &mut self,
        plan: &Plan,
        script: &Script,
        range: std::ops::Range<usize>,
        failure: &Failure,
    ) -> Option<MotionFact> {
        let mut blamed = (failure.action..range.end).filter_map(|index| {
            let call = script.call(index);
            Some((index, self.skills.get(call.kind())?.blame(&call)?))
        });
        let (index, cannot) = blamed.next()?;
        // A beam that is on its way: would another link do?
        let call = script.call(index);
        let carried = call.action.link().is_none() && range.start < index;
        let entry = plan.entries.iter().find(|entry| carried && Some(entry.beam.as_str()) == call.part());
        let cannot = match entry {
            Some(entry) if !self.another_link_would_do(script, &call, range) => cannot_insert(entry),
            _ => cannot,
        };
        Some(fact(&self.scene, cannot, &failure.refusal))
    }

    /// Would the held beam of a call come to its place, held by another link than the plan's?
    fn another_link_would_do(&mut self, script: &Script, call: &Call, range: std::ops::Range<usize>) -> bool {
        let (Some(part), Some(last)) = (call.part(), call.link()) else { return false };
        let Some(beam) = self.scene.kit.beam(part) else { return false };
        let others: Vec<String> =
            beam.links.iter().map(|link| link.name.clone()).filter(|link| link != last).collect();
        let before = self.scene.now.clone();
        // The grasp at the start is another question.
        let found = others.iter().any(|link| {
            let Some(x_wb) = before.parts.get(part) else { return false };
            self.scene.now = before.clone();
            let grasps = self.scene.grasps(part, Some(link));
            grasps.iter().any(|grasp| {
                self.scene.now = before.clone();
                self.scene.now.held = Some(super::outline::InHand::by(part, x_wb, grasp));
                self.search(script, range.start + 1..range.end, &mut None)
            })
        });
        self.scene.now = before;
        found
    }
}

fn is_pick_up(call: &Call) -> bool {
    call.kind() == ActionKind::PickUp
}

/// The grasp of a beam with which some motions end.
fn grasp_of(motions: &[Motion]) -> Option<BeamGrasp> {
    motions.iter().find_map(|motion| match motion {
        Motion::Hold(held) => held.grasp,
        _ => None,
    })
}

/// Keeps the failure that got furthest; the first of several at the same stage.
fn keep(furthest: &mut Option<Failure>, failure: Failure) {
    if furthest.as_ref().is_none_or(|other| failure.refusal.stage > other.refusal.stage) {
        *furthest = Some(failure);
    }
}
