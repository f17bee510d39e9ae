//! The baseline agent: plans, executes the plan action by action, detects faults and re-plans from its
//! updated belief.

use std::sync::Arc;
use std::time::Instant;

use ramp_assembly::Assembly;
use ramp_kit::source::{MAX_SENTENCE, plain, to_name};
use ramp_motion::{MotionError, PathPlanner};
use ramp_planner::{CoarseAction, Domains, FineAction, Item, MotionFact, Plan, PlanError, State};
use ramp_robot::arm::ArmModel;
use ramp_robot::{Account, Action, Agent, Event, EventKind, Retry, Robot, RobotError, Track};
use ramp_world::Start;

use crate::cell::{InsertionPath, Workcell};
use crate::clear;
use crate::fault::{Fault, SkillError};
use crate::history::{Change, Choice, History, Work};
use crate::parameters::Parameters;
use crate::recognition::take_over;
use crate::recovery::{check_holes, note_fault, recover};
use crate::rehearsal::{Rehearsal, Scene, UnusualGrasp, plan_with_motion};
use crate::replaced::Replaced;
use crate::skill::{Call, Effect};
use crate::table::{SkillTable, baseline};

/// A planner of one's own: from a state, and the events so far, to a plan, or the reason why there is none.
pub type OwnPlanner<'a> = Box<dyn FnMut(&State, &[Event]) -> Result<Plan, String> + 'a>;

/// The baseline agent.
pub struct Baseline<'a> {
    assembly: &'a Assembly,
    pub(crate) arm: &'a ArmModel,
    domains: &'a Domains,
    seed: u64,
    track: Option<Track>,
    start: Start,
    parameters: Arc<Parameters>,
    pub(crate) skills: SkillTable,
    replaced: Replaced,
    /// Its name in results.
    name: String,
    account: Account,
    plan: Option<Plan>,
    /// A given plan that it executes.
    fixed: Option<Plan>,
    /// That plan was carried out: there is no other.
    given: bool,
    /// The maker of its plans, if not its own planner.
    planner: Option<OwnPlanner<'a>>,
    /// Limits of the arm that skills have found.
    learned: Vec<MotionFact>,
    /// Limits of the arm that events have reported.
    told: Vec<MotionFact>,
    /// Skills that an event has reported as not rehearsed, by name.
    not_rehearsed: Vec<String>,
    /// The attempts so far, and the choices that are left.
    history: History,
    /// The work that has begun.
    work: Option<Work>,
    /// The peg that is being fetched: one that cannot be gripped is not tried again.
    fetching: Option<String>,
    /// The step of the plan that is carried out: its number from 1, and its words.
    step: Option<(usize, String)>,
    /// The reason for giving up.
    failure: Option<String>,
    on_event: Box<dyn FnMut(&Event) + 'a>,
}

impl<'a> Baseline<'a> {
    /// An agent for one goal. `seed` feeds the motion planner's random numbers.
    pub fn new(assembly: &'a Assembly, arm: &'a ArmModel, domains: &'a Domains, seed: u64) -> Baseline<'a> {
        let parameters = Parameters::baseline();
        let skills = baseline(&parameters);
        let replaced = Replaced { domain: domains.replaced(), ..Replaced::default() };
        Baseline {
            assembly,
            arm,
            domains,
            seed,
            track: None,
            start: Start::moved().clone(),
            parameters,
            skills,
            name: replaced.name(),
            replaced,
            account: Account::default(),
            plan: None,
            fixed: None,
            given: false,
            planner: None,
            learned: Vec::new(),
            told: Vec::new(),
            not_rehearsed: Vec::new(),
            history: History::default(),
            work: None,
            fetching: None,
            step: None,
            failure: None,
            on_event: Box::new(|_| {}),
        }
    }

    /// Calls `listener` for every event as it happens, for a progress display.
    #[must_use]
    pub fn with_listener(mut self, listener: impl FnMut(&Event) + 'a) -> Baseline<'a> {
        self.on_event = Box::new(listener);
        self
    }

    /// Tells it the track. Without that it asks for poses first, which a track with images refuses: such an
    /// episode counts on no board.
    #[must_use]
    pub fn on_track(mut self, track: Track) -> Baseline<'a> {
        self.track = Some(track);
        self
    }

    /// Tells it the start, whose numbers are its prior knowledge of the places of the parts. Without that it
    /// expects the start `moved`.
    #[must_use]
    pub fn from_start(mut self, start: &Start) -> Baseline<'a> {
        self.start = start.clone();
        self
    }

    /// Its version in results.
    pub const VERSION: &'static str = env!("CARGO_PKG_VERSION");

    /// Takes the numbers of a parameter file, whose hash becomes part of the agent's name in results. The
    /// skills become the baseline's with these numbers: call it before [`Baseline::with_skills`].
    #[must_use]
    pub fn with_parameters(mut self, parameters: Arc<Parameters>) -> Baseline<'a> {
        self.replaced.parameters.clone_from(&parameters.sha256);
        self.name = self.replaced.name();
        self.skills = baseline(&parameters);
        self.parameters = parameters;
        self
    }

    /// Takes the skills from another table. The agent's name in results lists the skills that are not the
    /// baseline's.
    ///
    /// ```
    /// # use ramp_skills::{Baseline, SkillTable, skill::Skill};
    /// # use ramp_robot::Agent;
    /// fn own<'a>(baseline: Baseline<'a>, skill: impl Skill + 'static) -> Baseline<'a> {
    ///     baseline.with_skills(SkillTable::default().with(skill))
    /// }
    /// ```
    #[must_use]
    pub fn with_skills(mut self, skills: SkillTable) -> Baseline<'a> {
        self.replaced.skills = skills.replaced().map(to_name).collect();
        self.name = self.replaced.name();
        self.skills = skills;
        self
    }

    /// Executes this given plan and no other, with the usual check of the holes before each peg. If the plan
    /// fails, the agent gives up. `sha256` is the hash, in hex, of the file or folder of the plan: it becomes
    /// part of the agent's name in results.
    #[must_use]
    pub fn with_plan(mut self, plan: Plan, sha256: &str) -> Baseline<'a> {
        self.replaced.plan = Some(sha256.to_string());
        self.name = self.replaced.name();
        self.fixed = Some(plan);
        self
    }

    /// Asks this planner for its plans, at the start and whenever it plans again. Its time counts as
    /// planning. `name` becomes part of the agent's name in results.
    #[must_use]
    pub fn with_planner(mut self, planner: OwnPlanner<'a>, name: &str) -> Baseline<'a> {
        self.replaced.planner = Some(name.to_string());
        self.name = self.replaced.name();
        self.planner = Some(planner);
        self
    }

    /// The first plan, once there is one.
    pub fn plan(&self) -> Option<&Plan> {
        self.plan.as_ref()
    }

    /// Plans from a state, given the limits of the arm there. If no such plan is left, the goal is built as
    /// far as possible without them.
    fn make_plan(&mut self, cell: &mut Workcell, mut state: State) -> Result<Plan, String> {
        let begin = Instant::now();
        state.motion = self.learned.iter().chain(self.history.facts()).cloned().collect();
        state.lost_pegs.extend_from_slice(self.history.aside());
        let plan = match &mut self.planner {
            Some(planner) => planner(&state, &self.account.events),
            None => self.own_plan(cell, state).map_err(|error| error.to_string()),
        };
        self.account.planning += begin.elapsed().as_secs_f64();
        plan
    }

    /// The plan of its own planner: rehearsed with all limits that skills have found, else without them, else
    /// by the rules alone if no limit stands against the work that failed. The history's facts always hold.
    fn own_plan(&mut self, cell: &mut Workcell, mut state: State) -> Result<Plan, PlanError> {
        loop {
            let error = match self.rehearsed_plan(cell, &state) {
                Err(error @ PlanError::Motion { .. }) => error,
                done => return done,
            };
            cell.record(EventKind::Note { text: plain(&error.to_string(), MAX_SENTENCE - 1) });
            state.motion = self.history.facts().to_vec();
            if self.learned.is_empty() {
                cell.grasps.clear();
                let plan = ramp_planner::plan(self.assembly, &state, self.domains)?;
                let against = self.rehearsal(cell, &state).check(&plan).err();
                return if against.is_some_and(|fact| self.history.failed_at(&fact)) {
                    Err(error)
                } else {
                    Ok(plan)
                };
            }
            self.learned.clear();
        }
    }

    /// The rehearsal of a plan from where everything is believed to be.
    fn rehearsal<'c>(&self, cell: &'c Workcell, state: &State) -> Rehearsal<'c>
    where
        'a: 'c,
    {
        let kit = &self.assembly.kit;
        let parts = kit.beams.iter().map(|beam| &beam.name).chain(kit.pegs.iter().map(|peg| &peg.name));
        let believed: Vec<_> =
            parts.filter_map(|name| Some((name.clone(), cell.belief.parts.pose(name).ok()?))).collect();
        let scene = Scene::nominal(self.assembly, self.arm, cell.planner, self.parameters.clone(), state);
        Rehearsal::new(scene, self.skills.clone())
            .from_here(believed.clone(), cell.hand.joints(), self.seed)
            .with_holders(cell.belief.parts.holders(kit))
            .without_grasps(self.history.grasps().clone())
            .without_unseen(self.start.scatter.as_ref().map(|_| &believed[..]))
    }

    /// A plan that the rehearsal accepts.
    fn rehearsed_plan(&mut self, cell: &mut Workcell, state: &State) -> Result<Plan, PlanError> {
        let rehearsed = plan_with_motion(self.assembly, state, self.domains, || self.rehearsal(cell, state))?;
        for fact in rehearsed.facts {
            if !self.told.contains(&fact) {
                cell.record(EventKind::motion(&fact));
                self.told.push(fact);
            }
        }
        for (beam, UnusualGrasp { grasp, because }) in &rehearsed.grasps {
            if cell.grasps.get(beam) != Some(grasp) {
                let (beam, because) = (beam.clone(), because.to_string());
                let (s, reverse) = (grasp.s, grasp.reverse);
                cell.record(EventKind::UnusualGrasp { beam, s, reverse, because });
            }
        }
        for skill in &rehearsed.not_rehearsed {
            if !self.not_rehearsed.contains(skill) {
                cell.record(EventKind::NotRehearsed { skill: skill.clone() });
                self.not_rehearsed.push(skill.clone());
            }
        }
        cell.grasps = rehearsed.grasps.into_iter().map(|(beam, it)| (beam, it.grasp)).collect();
        Ok(rehearsed.plan)
    }

    /// Records the arm's limit that the error of an action shows.
    fn learn(&mut self, cell: &mut Workcell, call: &Call, error: &SkillError) {
        let unable = match error {
            // The first motion away from the current pose does not affect the plan's feasibility.
            SkillError::Motion(error) => *error != MotionError::Blocked("start"),
            SkillError::Fault(fault) => matches!(fault, Fault::NoGrasp { .. }),
            SkillError::Robot(_) => false,
        };
        if !unable {
            return;
        }
        let skill = self.skills.get(call.kind());
        let Some(cannot) = skill.and_then(|skill| skill.blame(call)) else { return };
        let fact = MotionFact { cannot, past: None, because: plain(&error.to_string(), MAX_SENTENCE - 1) };
        if !self.learned.contains(&fact) {
            cell.record(EventKind::motion(&fact));
            self.told.push(fact.clone());
            self.learned.push(fact);
        }
    }

    /// A work cell with nothing built in it.
    pub(crate) fn cell<'p, 'r>(&self, planner: &'p PathPlanner, robot: &'r mut dyn Robot) -> Workcell<'p, 'r>
    where
        'a: 'p,
    {
        let parameters = self.parameters.clone();
        let mut cell =
            Workcell::new(self.assembly, self.arm, planner, robot, self.seed, parameters, &self.start);
        if let Some(track) = self.track {
            cell.belief.parts.eyes.on_track(track);
        }
        cell
    }

    /// Hands new events on to the listener and into the account.
    pub(crate) fn report(&mut self, cell: &mut Workcell) {
        for event in cell.journal.events.drain(..) {
            (self.on_event)(&event);
            self.account.events.push(event);
        }
    }

    /// Nothing more can be done.
    fn give_up(&mut self, cell: &mut Workcell, why: &str) {
        cell.record(Fault::GaveUp { why: why.to_string() });
        self.report(cell);
        self.failure = Some(plain(why, MAX_SENTENCE - 1));
    }

    fn work(&mut self, cell: &mut Workcell) -> Result<(), RobotError> {
        let mut lost: Vec<String> = Vec::new();
        if let Some(scatter) = self.start.scatter.clone() {
            let plan = || match &self.fixed {
                Some(plan) => Ok(plan.clone()),
                None => ramp_planner::plan(self.assembly, &State::default(), self.domains),
            };
            match clear::prepare(&self.skills, cell, &scatter, plan)? {
                Ok(unusable) => lost = unusable,
                Err(why) => {
                    self.give_up(cell, &why);
                    return Ok(());
                }
            }
            self.report(cell);
        }
        for round in 0.. {
            let seen = cell.belief.parts.update(&mut cell.hand);
            note_fault(cell, seen.map_err(SkillError::from))?;
            if round == 0 {
                take_over(&self.skills, cell, &mut lost)?;
                self.report(cell);
            }
            let plan = match self.next_plan(cell, &lost) {
                Ok(plan) => plan,
                Err(why) => {
                    self.give_up(cell, &why);
                    return Ok(());
                }
            };
            if round == 0 {
                self.account.coarse = plan.steps.len();
                self.account.fine = plan.steps.iter().map(|step| step.fine.len()).sum();
                self.plan = Some(plan.clone());
            } else {
                self.account.replans += 1;
                cell.record(EventKind::Replan { coarse: plan.steps.len() });
            }
            // Of beams that stand already the new plan says nothing: for them the old one holds.
            self.learn_paths(cell, &plan);
            self.history.follows(&plan);
            match self.run_plan(cell, &plan) {
                Ok(()) => return Ok(()),
                Err(SkillError::Robot(error)) => return Err(error),
                Err(error) => {
                    cell.record(error.fault());
                    self.report(cell);
                    if let Some(work) = self.work.take() {
                        self.history.failed(&work, &error.to_string(), cell.progress());
                    }
                    recover(&self.skills, cell, self.fetching.take().as_deref(), &mut lost)?;
                    self.report(cell);
                }
            }
        }
        Ok(())
    }

    /// The plan to carry out next. One that follows a failure differs from the plans before in a named way.
    ///
    /// # Errors
    /// The reason for which there is none, for a person.
    fn next_plan(&mut self, cell: &mut Workcell, lost: &[String]) -> Result<Plan, String> {
        if let Some(plan) = self.fixed.take() {
            self.given = true;
            return Ok(plan);
        }
        let failed = self.history.last();
        if self.given {
            let (step, action) = self.step.take().unwrap_or_default();
            return Err(format!(
                "the given plan failed at step {step}, {action}: {} (--check-motion checks a plan before the arm \
                 moves)",
                failed.unwrap_or_default()
            ));
        }
        if failed.is_none() {
            let state = self.state(cell, lost).map_err(|error| error.to_string())?;
            return self.make_plan(cell, state).map_err(|error| format!("no plan: {error}"));
        }
        if cell.hand.time() > self.parameters.agent.latest {
            return Err(format!("no time is left for another plan; {}", self.history.account()));
        }
        while let Some((work, change)) = self.history.change(&Choice::of(cell, lost)) {
            cell.record(Retry::new("plan", work.about()).because(format!("{}, {change}", work.step())));
            if change == Change::Pause {
                // A robot that has stopped for good says so again at the next call.
                let waited = cell.hand.wait(self.parameters.agent.pause);
                let _ = waited.and_then(|()| Ok(cell.belief.parts.update(&mut cell.hand)?));
            }
            let state = self.state(cell, lost).map_err(|error| error.to_string())?;
            match self.make_plan(cell, state) {
                Ok(plan) => return Ok(plan),
                Err(why) => {
                    cell.record(EventKind::Note {
                        text: plain(&format!("no plan: {why}"), MAX_SENTENCE - 1),
                    });
                    self.history.refused(&why);
                }
            }
        }
        Err(self.history.account())
    }

    /// Takes over how a plan brings beams to their places.
    pub(crate) fn learn_paths(&self, cell: &mut Workcell, plan: &Plan) {
        for entry in &plan.entries {
            if let Some(beam) = self.assembly.beam_index(&entry.beam) {
                cell.belief.paths.insert(beam, InsertionPath::from(entry));
            }
        }
    }

    /// The planner's input about the world.
    fn state(&self, cell: &Workcell, lost: &[String]) -> Result<State, SkillError> {
        let name = |beam: usize| self.assembly.beams[beam].beam.name.clone();
        let base = self.assembly.base;
        Ok(State {
            in_assembly: cell
                .belief
                .standing
                .iter()
                .filter(|beam| **beam != base)
                .map(|beam| name(*beam))
                .collect(),
            fastened: cell
                .belief
                .pinned
                .iter()
                .map(|(index, peg)| (self.assembly.connections[*index].name.clone(), peg.clone()))
                .collect(),
            misaligned: cell.belief.swung()?.into_iter().map(name).collect(),
            lost_pegs: lost.to_vec(),
            deep: cell.belief.deep.iter().map(|beam| name(*beam)).collect(),
            ..State::default()
        })
    }

    /// Executes a plan.
    pub(crate) fn run_plan(&mut self, cell: &mut Workcell, plan: &Plan) -> Result<(), SkillError> {
        for (index, step) in plan.steps.iter().enumerate() {
            let rest = &plan.steps[index..];
            self.step = Some((index + 1, step.coarse.to_string()));
            if let CoarseAction::PickUp { item: Item::Peg(_) } = &step.coarse {
                let next = rest.iter().find_map(|step| match &step.coarse {
                    CoarseAction::Fasten { connection, .. } => self.assembly.connection_index(connection),
                    _ => None,
                });
                if let Some(connection) = next {
                    self.work = Some(Work::holes(&self.assembly.connections[connection].name));
                    check_holes(&self.skills, cell, connection)?;
                }
            }
            for action in &step.fine {
                if self.history.skips(action, cell.progress()) {
                    continue;
                }
                let event = Action::of(action);
                cell.record(EventKind::ActionBegun(event.clone()));
                self.report(cell);
                self.fetching = match action {
                    FineAction::PickUp { item: Item::Peg(peg), .. } => Some(peg.clone()),
                    _ => None,
                };
                let call = Call { action, plan: &plan.steps, step: index };
                self.work = Some(Work::action(&call, self.assembly));
                if let Err(error) = self.skills.execute(cell, &call) {
                    self.learn(cell, &call, &error);
                    return Err(error);
                }
                cell.remember_standing(&self.touched(&call));
                cell.record(EventKind::ActionEnded(event));
                self.report(cell);
            }
        }
        Ok(())
    }

    /// The beams of the assembly that an action has worked on, by index, according to what its skill expects.
    fn touched(&self, call: &Call) -> Vec<usize> {
        let expects = self.skills.get(call.kind()).map_or(&[][..], |skill| skill.expects());
        let mut beams = Vec::new();
        for effect in expects {
            match effect {
                Effect::BeamStands | Effect::BeamAtPlace | Effect::BeamAligned => {
                    beams.extend(call.beam(self.assembly).ok());
                }
                Effect::PegSeated => {
                    let connection = call.connection(self.assembly).ok();
                    let sides = connection.map(|index| &self.assembly.connections[index]);
                    beams.extend(sides.into_iter().flat_map(|sides| [sides.female.beam, sides.male.beam]));
                }
                Effect::HoldsPart | Effect::HandEmpty => {}
            }
        }
        beams
    }
}

impl Agent for Baseline<'_> {
    fn name(&self) -> (&str, &str) {
        (&self.name, Self::VERSION)
    }

    fn file_hash(&self) -> Option<&str> {
        self.parameters.sha256.as_deref()
    }

    fn account(&self) -> Account {
        self.account.clone()
    }

    fn failure(&self) -> Option<String> {
        self.failure.clone()
    }

    fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError> {
        let planner = PathPlanner::new(self.arm);
        let mut cell = self.cell(&planner, robot);
        let result = self.work(&mut cell);
        cell.tell_complaints();
        self.report(&mut cell);
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ramp_planner::{Area, End, Grasp, Impossible, InTheWay, Place, Target};

    /// Events have the text of the planner, made from their data alone.
    #[test]
    fn an_action_and_a_motion_fact_read_in_an_event_as_in_a_plan() {
        let [beam, joint, link] = ["b4", "b4j1", "b4l2"].map(|name| move || name.to_string());
        let areas = [Area::Input, Area::Intermediate, Area::Assembly].map(Place::Above);
        let places = [
            Place::Input(Item::Peg("p1".into())),
            Place::Approach(Target::Connection("C1".into())),
            Place::Target(Target::Beam(beam())),
        ];
        let moves = areas.into_iter().chain(places).map(|to| FineAction::Move { to });
        let mut actions: Vec<FineAction> = moves.collect();
        actions.extend([
            FineAction::PickUp { item: Item::Beam(beam()), grasp: Grasp::Link(link()) },
            FineAction::PickUp { item: Item::Peg("p1".into()), grasp: Grasp::Head },
            FineAction::PutDown { item: Item::Beam(beam()) },
            FineAction::AssembleSquare { beam: beam(), joint: joint() },
            FineAction::AssembleAngled { beam: beam(), joint: joint() },
            FineAction::AssembleThrough {
                beam: beam(),
                joint: joint(),
                through: vec![joint(), "b4j2".into()],
            },
            FineAction::AssembleDeep { beam: beam(), joint: joint() },
            FineAction::AssembleCap { beam: beam(), joints: vec![joint(), "b4j2".into()] },
            FineAction::LayDown { beam: beam() },
            FineAction::Slide { beam: beam(), link: link() },
            FineAction::Regrasp { beam: beam(), link: link() },
            FineAction::Push { beam: beam(), link: link() },
            FineAction::Fasten {
                connection: "C1".into(),
                female: "b7j1".into(),
                male: joint(),
                peg: "p1".into(),
            },
        ]);
        for action in &actions {
            assert_eq!(Action::of(action).to_string(), action.to_string());
        }
        let fact = |cannot, past| MotionFact { cannot, past, because: "the fingers would touch b3".into() };
        for fact in [
            fact(Impossible::Grasp { beam: beam(), link: link(), at: End::Start }, None),
            fact(
                Impossible::Grasp { beam: beam(), link: link(), at: End::Place },
                Some(InTheWay::Stands("b3".into())),
            ),
            fact(Impossible::Insert { beam: beam(), path: "x".into() }, Some(InTheWay::OnSheet("b3".into()))),
            fact(Impossible::Fasten { connection: "C1".into() }, None),
        ] {
            let event = EventKind::motion(&fact);
            assert_eq!((event.name(), event.to_string()), ("motion", fact.to_string()));
        }
    }
}
