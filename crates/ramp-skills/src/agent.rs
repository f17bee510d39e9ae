//! The baseline agent: plans, executes the plan action by action, detects faults and re-plans from its
//! updated belief. `plans` makes its plans, `repair` sets right what stands wrong before the first one, and
//! `take_apart` takes a frame apart.

mod apart;
mod plans;
mod repair;
mod take_apart;

use std::sync::Arc;
use std::time::Instant;

use ramp_assembly::{Assembly, Task};
use ramp_kit::source::{MAX_SENTENCE, plain, to_name};
use ramp_motion::PathPlanner;
use ramp_planner::{CoarseAction, Domains, FineAction, Item, MotionFact, Plan, State};
use ramp_robot::arm::ArmModel;
use ramp_robot::{Account, Action, Agent, Event, EventKind, Retry, Robot, RobotError, Track};
use ramp_world::Start;

use crate::belief::OwnFinder;
use crate::cell::{InsertionPath, Workcell};
use crate::change::{Change, Choice};
use crate::clear;
use crate::fault::{Fault, SkillError};
use crate::hand::Hand;
use crate::history::{History, Work};
use crate::parameters::Parameters;
use crate::recognition::Swap;
use crate::recovery::{check_holes, check_pegs, note_fault, recover};
use crate::replaced::Replaced;
use crate::skill::{Call, Effect};
use crate::table::{SkillTable, baseline};

/// A planner of one's own: from a state, and the events so far, to a plan, or the reason why there is none.
pub type OwnPlanner<'a> = Box<dyn FnMut(&State, &[Event]) -> Result<Plan, String> + 'a>;

/// The baseline agent.
pub struct Baseline<'a> {
    pub(crate) assembly: &'a Assembly,
    pub(crate) arm: &'a ArmModel,
    pub(crate) domains: &'a Domains,
    seed: u64,
    task: Task,
    track: Option<Track>,
    pub(crate) start: Start,
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
    /// The finder of parts, if not its own.
    finder: Option<OwnFinder>,
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
    /// Beams that stood in each other's places were taken out.
    pub(crate) swapped: bool,
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
            task: Task::Build,
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
            finder: None,
            planner: None,
            learned: Vec::new(),
            told: Vec::new(),
            not_rehearsed: Vec::new(),
            history: History::default(),
            work: None,
            fetching: None,
            step: None,
            swapped: false,
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

    /// Tells it the task. Without that it builds the frame.
    #[must_use]
    pub fn with_task(mut self, task: Task) -> Baseline<'a> {
        self.task = task;
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

    /// Executes this given plan and no other, with the usual check of the holes before each peg, and of what
    /// lies on a beam before that is taken. If the plan fails, the agent gives up. `sha256` is the hash, in
    /// hex, of the file or folder of the plan: it becomes part of the agent's name in results.
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

    /// Finds parts in images with this finder, on tracks that give images. `name` becomes part of the agent's
    /// name in results.
    #[must_use]
    pub fn with_finder(mut self, finder: OwnFinder, name: &str) -> Baseline<'a> {
        self.replaced.finder = Some(name.to_string());
        self.name = self.replaced.name();
        self.finder = Some(finder);
        self
    }

    /// The first plan, once there is one.
    pub fn plan(&self) -> Option<&Plan> {
        self.plan.as_ref()
    }

    /// A work cell with nothing built in it.
    pub(crate) fn cell<'p, 'r>(&self, planner: &'p PathPlanner, robot: &'r mut dyn Robot) -> Workcell<'p, 'r>
    where
        'a: 'p,
    {
        let hand = Hand::new(robot, self.arm, &self.parameters);
        self.cell_of(self.assembly, planner, hand)
    }

    /// A work cell for a frame of the same kit, which may be another one than the goal.
    pub(crate) fn cell_of<'p, 'r>(
        &self,
        assembly: &'p Assembly,
        planner: &'p PathPlanner,
        hand: Hand<'r>,
    ) -> Workcell<'p, 'r>
    where
        'a: 'p,
    {
        let parameters = self.parameters.clone();
        let mut cell =
            Workcell::with_hand(assembly, self.arm, planner, hand, self.seed, parameters, &self.start);
        if let Some(track) = self.track {
            cell.belief.parts.eyes.on_track(track);
        }
        if let Some(finder) = &self.finder {
            cell.belief.parts.eyes.find_with(Arc::clone(finder));
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

    /// Runs a planner, and counts its time as planning.
    pub(crate) fn timed<T>(&mut self, plan: impl FnOnce() -> T) -> T {
        let begin = Instant::now();
        let plan = plan();
        self.account.planning += begin.elapsed().as_secs_f64();
        plan
    }

    /// Takes a plan as the first.
    pub(crate) fn begins_with(&mut self, plan: &Plan) {
        self.account.coarse = plan.steps.len();
        self.account.fine = plan.steps.iter().map(|step| step.fine.len()).sum();
        self.plan = Some(plan.clone());
    }

    /// Goes on with another plan.
    pub(crate) fn replans(&mut self, cell: &mut Workcell, plan: &Plan) {
        self.account.replans += 1;
        cell.record(EventKind::Replan { coarse: plan.steps.len() });
    }

    /// Nothing more can be done.
    pub(crate) fn give_up(&mut self, cell: &mut Workcell, why: &str) {
        cell.record(Fault::GaveUp { why: why.to_string() });
        self.report(cell);
        self.failure = Some(plain(why, MAX_SENTENCE - 1));
    }

    /// Builds the frame. Gives the beams that stand in the places of others, if there are any: they have to
    /// go before it begins.
    fn work(&mut self, cell: &mut Workcell) -> Result<Vec<Swap>, RobotError> {
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
                    return Ok(Vec::new());
                }
            }
            self.report(cell);
        }
        for round in 0.. {
            let seen = match round {
                0 => cell.look_first(),
                _ => cell.belief.parts.update(&mut cell.hand).map_err(SkillError::from),
            };
            note_fault(cell, seen)?;
            if round == 0 {
                let swaps = self.begin(cell, &mut lost)?;
                self.report(cell);
                if !swaps.is_empty() {
                    return Ok(swaps);
                }
            }
            let mut planned = self.next_plan(cell, &lost);
            if let (0, Err(why)) = (round, &planned)
                && cell.progress() > 1
                && !self.given
            {
                let text = format!("the frame is taken apart until a plan leads on from there, since {why}");
                cell.record(EventKind::Note { text: plain(&text, MAX_SENTENCE - 1) });
                self.report(cell);
                self.take_apart_until_planned(cell, &lost)?;
                planned = self.next_plan(cell, &lost);
            }
            let plan = match planned {
                Ok(plan) => plan,
                Err(why) => {
                    self.give_up(cell, &why);
                    return Ok(Vec::new());
                }
            };
            match round {
                0 => self.begins_with(&plan),
                _ => self.replans(cell, &plan),
            }
            // Of beams that stand already the new plan says nothing: for them the old one holds.
            self.learn_paths(cell, &plan);
            self.history.follows(&plan);
            let done = self.run_plan(cell, &plan).and_then(|()| self.check_pegs(cell));
            match done {
                Ok(()) if self.history.resumes(&cell.belief.fastened(), cell.progress()) => {}
                Ok(()) => return Ok(Vec::new()),
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
        Ok(Vec::new())
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
            // A robot that has stopped for good says so again at the next call.
            match &change {
                Change::Pause => {
                    let waited = cell.hand.wait(self.parameters.agent.pause);
                    let _ = waited.and_then(|()| Ok(cell.belief.parts.update(&mut cell.hand)?));
                }
                Change::Aside { beam } => {
                    if let Err(why) = self.lay_aside(cell, beam, work.about()) {
                        self.history.refused(&why);
                        continue;
                    }
                }
                _ => {}
            }
            let state = self.state(cell, lost).map_err(|error| error.to_string())?;
            match self.make_plan(cell, state) {
                Ok(plan) => return Ok(plan),
                Err(why) => {
                    let why = format!("no plan: {why}");
                    cell.record(EventKind::Note { text: plain(&why, MAX_SENTENCE - 1) });
                    self.history.refused(&why);
                }
            }
        }
        Err(self.history.account())
    }

    /// Takes over how a plan brings beams to their places.
    pub(crate) fn learn_paths(&self, cell: &mut Workcell, plan: &Plan) {
        for entry in &plan.entries {
            if let Some(beam) = cell.assembly.beam_index(&entry.beam) {
                cell.belief.paths.insert(beam, InsertionPath::from(entry));
            }
        }
    }

    /// The planner's input about the world.
    pub(crate) fn state(&self, cell: &Workcell, lost: &[String]) -> Result<State, SkillError> {
        let name = |beam: usize| self.assembly.beams[beam].beam.name.clone();
        let base = self.assembly.base;
        let mut fastened = cell.belief.fastened();
        // A plan takes what is left for later for done: with a peg that is lost, or else with the last one.
        let standing = |beam: usize| beam == base || cell.belief.standing.contains(&beam);
        for connection in self.history.later() {
            let sides = self.assembly.connection_index(connection).map(|it| &self.assembly.connections[it]);
            let stands = sides.is_some_and(|it| standing(it.female.beam) && standing(it.male.beam));
            if !stands || fastened.iter().any(|(done, _)| done == connection) {
                continue;
            }
            let is_free = |peg: &&String| fastened.iter().all(|(_, other)| other != *peg);
            let kept = self.assembly.kit.pegs.iter().rev().map(|peg| &peg.name);
            if let Some(peg) = lost.iter().chain(kept).find(is_free).cloned() {
                fastened.push((connection.clone(), peg));
            }
        }
        Ok(State {
            in_assembly: cell
                .belief
                .standing
                .iter()
                .filter(|beam| **beam != base)
                .map(|beam| name(*beam))
                .collect(),
            fastened,
            misaligned: cell.belief.swung()?.into_iter().map(name).collect(),
            lost_pegs: lost.to_vec(),
            deep: cell.belief.deep.iter().map(|beam| name(*beam)).collect(),
            ..State::default()
        })
    }

    /// Executes a plan for the frame of the work cell.
    pub(crate) fn run_plan(&mut self, cell: &mut Workcell, plan: &Plan) -> Result<(), SkillError> {
        for (index, step) in plan.steps.iter().enumerate() {
            let rest = &plan.steps[index..];
            self.step = Some((index + 1, step.coarse.to_string()));
            if let CoarseAction::PickUp { item: Item::Peg(_) } = &step.coarse {
                let next = rest.iter().find_map(|step| match &step.coarse {
                    CoarseAction::Fasten { connection, .. } => cell.assembly.connection_index(connection),
                    _ => None,
                });
                if let Some(connection) = next {
                    self.work = Some(Work::holes(&cell.assembly.connections[connection].name));
                    check_holes(&self.skills, cell, connection)?;
                }
            }
            for action in &step.fine {
                if self.history.skips(action, cell.progress()) {
                    continue;
                }
                if let FineAction::PickUp { item: Item::Beam(beam), .. } = action {
                    clear::uncover(&self.skills, cell, &plan.entries, beam)?;
                }
                let event = Action::of(action);
                cell.record(EventKind::ActionBegun(event.clone()));
                self.report(cell);
                self.fetching = match action {
                    FineAction::PickUp { item: Item::Peg(peg), .. } => Some(peg.clone()),
                    _ => None,
                };
                let call = Call { action, plan: &plan.steps, step: index };
                self.work = Some(Work::action(&call, cell.assembly));
                if let Err(error) = self.skills.execute(cell, &call) {
                    self.learn(cell, &call, &error);
                    return Err(error);
                }
                cell.remember_standing(&self.touched(cell.assembly, &call));
                cell.record(EventKind::ActionEnded(event));
                self.report(cell);
            }
        }
        Ok(())
    }

    /// Looks whether the seated pegs hold both of their beams; a given plan goes on as it is.
    fn check_pegs(&mut self, cell: &mut Workcell) -> Result<(), SkillError> {
        let checked = if self.given { Ok(()) } else { check_pegs(cell) };
        if let Err(SkillError::Fault(Fault::Misaligned { connection, .. })) = &checked {
            self.work = Some(Work::holes(connection));
        }
        checked
    }

    /// The beams of the assembly that an action has worked on, by index, according to what its skill expects.
    fn touched(&self, assembly: &Assembly, call: &Call) -> Vec<usize> {
        let expects = self.skills.get(call.kind()).map_or(&[][..], |skill| skill.expects());
        let mut beams = Vec::new();
        for effect in expects {
            match effect {
                Effect::BeamStands | Effect::BeamAtPlace | Effect::BeamAligned | Effect::BeamDeep => {
                    beams.extend(call.beam(assembly).ok());
                }
                Effect::PegSeated => {
                    let connection = call.connection(assembly).ok();
                    let sides = connection.map(|index| &assembly.connections[index]);
                    beams.extend(sides.into_iter().flat_map(|sides| [sides.female.beam, sides.male.beam]));
                }
                Effect::HoldsPart | Effect::HandEmpty | Effect::BeamOut | Effect::PegOut => {}
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
        loop {
            let result = match self.task {
                Task::Build => self.work(&mut cell),
                Task::TakeApart => self.take_apart(&mut cell).map(|()| Vec::new()),
            };
            cell.tell_complaints();
            self.report(&mut cell);
            let failed = cell.belief.parts.eyes.failed();
            if let (Err(RobotError::CameraStopped { .. }), Some(why)) = (&result, failed) {
                self.failure = Some(plain(why, MAX_SENTENCE - 1));
                return Ok(());
            }
            let swaps = result?;
            if swaps.is_empty() {
                return Ok(());
            }
            let hand = self.take_out_swapped(&swaps, &planner, cell.hand)?;
            cell = self.cell_of(self.assembly, &planner, hand);
        }
    }
}
