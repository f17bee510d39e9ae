//! The baseline agent: plans, runs the plan action by action, notices what goes wrong and plans again from what it
//! then believes.

use std::collections::BTreeMap;
use std::time::Instant;

use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_motion::PathPlanner;
use ramp_planner::{
    CoarseAction, CoarseStep, Domains, FineAction, Grasp, Item, Place, Plan, PlanError, State, Target,
};
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;
use ramp_robot::{Account, Agent, Event, Robot, RobotError};

use crate::belief::Belief;
use crate::fault::{Fault, SkillError};
use crate::hand::Hand;
use crate::insert::PEGGABLE;
use crate::transport::{Way, Workcell};

/// How often the agent plans again before it gives up.
const REPLANS: usize = 6;
/// How well two holes must be known to tell whether a peg goes in, m.
const KNOWN: f64 = 0.3e-3;
/// A peg further than this from its place in the holder is not fetched any more, m: in its hole it can be 3 mm off.
const STRAYED: f64 = 6.0e-3;

/// The baseline.
pub struct Baseline<'a> {
    kit: &'a Kit,
    assembly: &'a Assembly,
    pub(crate) arm: &'a ArmModel,
    domains: &'a Domains,
    seed: u64,
    account: Account,
    plan: Option<Plan>,
    /// The peg that is being fetched: one that cannot be gripped is not tried again.
    fetching: Option<String>,
    /// Why it gave up.
    failure: Option<String>,
    on_event: Box<dyn FnMut(&Event) + 'a>,
}

impl<'a> Baseline<'a> {
    /// An agent for one goal. `seed` feeds the motion planner's random numbers.
    pub fn new(
        kit: &'a Kit,
        assembly: &'a Assembly,
        arm: &'a ArmModel,
        domains: &'a Domains,
        seed: u64,
    ) -> Baseline<'a> {
        Baseline {
            kit,
            assembly,
            arm,
            domains,
            seed,
            account: Account::default(),
            plan: None,
            fetching: None,
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

    /// The first plan, once there is one.
    pub fn plan(&self) -> Option<&Plan> {
        self.plan.as_ref()
    }

    fn make_plan(&mut self, state: &State) -> Result<Plan, PlanError> {
        let begin = Instant::now();
        let plan = ramp_planner::plan(self.assembly, self.kit, state, self.domains);
        self.account.planning += begin.elapsed().as_secs_f64();
        plan
    }

    /// A work cell with nothing built in it.
    pub(crate) fn cell<'p, 'r>(&self, planner: &'p PathPlanner, robot: &'r mut dyn Robot) -> Workcell<'p, 'r>
    where
        'a: 'p,
    {
        Workcell {
            kit: self.kit,
            assembly: self.assembly,
            arm: self.arm,
            planner,
            hand: Hand::new(robot),
            belief: Belief::new(self.kit, self.assembly),
            standing: vec![self.assembly.base],
            deep: Vec::new(),
            pinned: Vec::new(),
            ways: BTreeMap::new(),
            stream: Stream::new(self.seed, "motion"),
            events: Vec::new(),
            force_told: false,
            stood: BTreeMap::new(),
        }
    }

    /// Hands new events on to the listener and into the account.
    pub(crate) fn report(&mut self, cell: &mut Workcell) {
        for event in cell.events.drain(..) {
            (self.on_event)(&event);
            self.account.events.push(event);
        }
    }

    /// Nothing more can be done.
    fn give_up(&mut self, cell: &mut Workcell, why: String) {
        cell.note("fault", why.clone());
        self.report(cell);
        self.failure = Some(why);
    }

    fn work(&mut self, cell: &mut Workcell) -> Result<(), RobotError> {
        let mut lost: Vec<String> = Vec::new();
        let mut last = String::new();
        for round in 0..=REPLANS {
            cell.belief.update(&mut cell.hand)?;
            let plan = self
                .state(cell, &lost)
                .map_err(|error| error.to_string())
                .and_then(|state| self.make_plan(&state).map_err(|error| format!("no plan: {error}")));
            let plan = match plan {
                Ok(plan) => plan,
                Err(why) => {
                    self.give_up(cell, why);
                    return Ok(());
                }
            };
            if round == 0 {
                self.account.coarse = plan.steps.len();
                self.account.fine = plan.steps.iter().map(|step| step.fine.len()).sum();
                self.plan = Some(plan.clone());
            } else {
                self.account.replans += 1;
                cell.note("replan", format!("{} coarse actions", plan.steps.len()));
            }
            // Of beams that stand already the new plan says nothing: for them the old one holds.
            self.learn_ways(cell, &plan);
            match self.run_plan(cell, &plan) {
                Ok(()) => return Ok(()),
                Err(SkillError::Robot(error)) => return Err(error),
                Err(error) => {
                    last = error.to_string();
                    cell.note("fault", last.clone());
                    self.report(cell);
                    self.recover(cell, &mut lost)?;
                }
            }
        }
        self.give_up(cell, format!("gave up after {REPLANS} new plans: {last}"));
        Ok(())
    }

    /// Takes over how a plan brings beams to their places.
    pub(crate) fn learn_ways(&self, cell: &mut Workcell, plan: &Plan) {
        for entry in &plan.entries {
            if let Some(beam) = self.assembly.beam_index(&entry.beam) {
                let (direction, distance, depth) = (entry.direction.into(), entry.distance, entry.depth);
                cell.ways.insert(beam, Way { direction, distance, depth });
            }
        }
    }

    /// What the planner is told about the world.
    fn state(&self, cell: &Workcell, lost: &[String]) -> Result<State, SkillError> {
        let name = |beam: usize| self.assembly.beams[beam].beam.name.clone();
        let base = self.assembly.base;
        Ok(State {
            in_assembly: cell.standing.iter().filter(|beam| **beam != base).map(|beam| name(*beam)).collect(),
            fastened: cell
                .pinned
                .iter()
                .map(|(index, peg)| (self.assembly.connections[*index].name.clone(), peg.clone()))
                .collect(),
            misaligned: cell.swung()?.into_iter().map(name).collect(),
            lost_pegs: lost.to_vec(),
            deep: cell.deep.iter().map(|beam| name(*beam)).collect(),
            ..State::default()
        })
    }

    pub(crate) fn run_plan(&mut self, cell: &mut Workcell, plan: &Plan) -> Result<(), SkillError> {
        for (index, step) in plan.steps.iter().enumerate() {
            let rest = &plan.steps[index..];
            if let CoarseAction::PickUp { item: Item::Peg(_) } = &step.coarse {
                self.check_before_peg(cell, rest)?;
            }
            for action in &step.fine {
                cell.note("start", action.to_string());
                self.report(cell);
                self.fetching = match action {
                    FineAction::PickUp { item: Item::Peg(peg), .. } => Some(peg.clone()),
                    _ => None,
                };
                self.act(cell, action, rest)?;
                cell.remember_standing(&self.touched(action));
                cell.note("done", action.to_string());
                self.report(cell);
            }
        }
        Ok(())
    }

    /// The beams of the assembly that an action works on, by index.
    fn touched(&self, action: &FineAction) -> Vec<usize> {
        match action {
            FineAction::AssembleSquare { beam, .. }
            | FineAction::AssembleAngled { beam, .. }
            | FineAction::AssembleThrough { beam, .. }
            | FineAction::AssembleDeep { beam, .. }
            | FineAction::AssembleCap { beam, .. }
            | FineAction::LayDown { beam }
            | FineAction::Slide { beam, .. }
            | FineAction::Push { beam, .. } => self.assembly.beam_index(beam).into_iter().collect(),
            FineAction::Fasten { connection, .. } => {
                let index = self.assembly.connection_index(connection);
                let sides = index.map(|index| &self.assembly.connections[index]);
                sides.map(|sides| vec![sides.female.beam, sides.male.beam]).unwrap_or_default()
            }
            _ => Vec::new(),
        }
    }

    /// Before a peg is fetched: would it go in? A peg pulls two holes together that are up to 1.7 mm apart, and
    /// stands on the male when they are further.
    fn check_before_peg(&mut self, cell: &mut Workcell, rest: &[CoarseStep]) -> Result<(), SkillError> {
        let next = rest.iter().find_map(|step| match &step.coarse {
            CoarseAction::Fasten { connection, .. } => self.assembly.connection_index(connection),
            _ => None,
        });
        next.map_or(Ok(()), |index| self.check(cell, index))
    }

    /// Looks at the holes of a connection, and pushes its beams until a peg would go in.
    pub(crate) fn check(&mut self, cell: &mut Workcell, index: usize) -> Result<(), SkillError> {
        let connection = &self.assembly.connections[index];
        let holes = [cell.hole(connection.female), cell.hole(connection.male)];
        cell.see(&holes, KNOWN)?;
        cell.diagnose_standing();
        let offset = cell.belief.offset(self.assembly, connection)?;
        if offset <= PEGGABLE {
            return Ok(());
        }
        let misaligned =
            |offset: f64| Fault::Misaligned { connection: connection.name.clone(), offset_mm: offset * 1e3 };
        cell.note("fault", misaligned(offset).to_string());
        self.report(cell);
        // Beams that have swung about their only peg drag along what is joined to them: they are put right first,
        // then the two beams themselves.
        let mut beams = cell.swung()?;
        let sides = [connection.female.beam, connection.male.beam];
        beams.extend(sides.into_iter().filter(|beam| *beam != self.assembly.base));
        for beam in beams {
            cell.rise()?;
            cell.push_by_nearest_link(beam)?;
            cell.rise()?;
            cell.see(&holes, KNOWN)?;
            cell.remember_standing(&[beam]);
            if cell.belief.offset(self.assembly, connection)? <= PEGGABLE {
                return Ok(());
            }
        }
        Err(misaligned(cell.belief.offset(self.assembly, connection)?).into())
    }

    /// Carries out one fine action; `rest` is the plan from its coarse action on.
    fn act(
        &mut self,
        cell: &mut Workcell,
        action: &FineAction,
        rest: &[CoarseStep],
    ) -> Result<(), SkillError> {
        let no_skill = || Fault::NoSkill { action: action.to_string() };
        let beam = |name: &str| self.assembly.beam_index(name).ok_or_else(no_skill);
        let connection = |name: &str| self.assembly.connection_index(name).ok_or_else(no_skill);
        match action {
            FineAction::Move { to } => match to {
                Place::Above(_) => cell.rise(),
                Place::Input(item) => cell.hover(item.name(), link_for(item, rest)),
                // With an empty hand the skill that follows finds its own way.
                Place::Approach(_) | Place::Target(_) if cell.hand.held.is_none() => cell.rise(),
                Place::Approach(Target::Beam(name)) => cell.approach_beam(beam(name)?),
                Place::Approach(Target::Connection(name)) => cell.approach_hole(connection(name)?),
                Place::Target(_) => Ok(()),
            },
            FineAction::PickUp { item, grasp } => {
                let link = match grasp {
                    Grasp::Link(link) => Some(link.as_str()),
                    Grasp::Head => None,
                };
                cell.pick_up(item.name(), link)
            }
            FineAction::PutDown { .. } => cell.put_back(),
            FineAction::AssembleSquare { beam: name, .. } => cell.assemble(beam(name)?, false),
            // Along the beam's own way, which is a straight line here, too.
            FineAction::AssembleAngled { beam: name, .. }
            | FineAction::AssembleThrough { beam: name, .. } => cell.assemble(beam(name)?, false),
            FineAction::AssembleDeep { beam: name, .. } => cell.assemble(beam(name)?, false),
            FineAction::LayDown { beam: name } => cell.lay_down(beam(name)?),
            FineAction::Slide { beam: name, link } => {
                cell.rise()?;
                cell.slide(beam(name)?, link)
            }
            FineAction::Regrasp { beam: name, link } => cell.regrasp(beam(name)?, link),
            FineAction::AssembleCap { beam: name, .. } => cell.assemble(beam(name)?, true),
            FineAction::Fasten { connection: name, .. } => cell.fasten(connection(name)?),
            FineAction::Push { beam: name, link } => {
                cell.rise()?;
                cell.push(beam(name)?, link)
            }
        }
    }

    /// Pushes beams that lie loose in the assembly and were carried off back to their places. The planner knows beams by
    /// what they meet, and such a beam meets nothing yet.
    fn put_right(&self, cell: &mut Workcell) -> Result<(), SkillError> {
        for beam in cell.carried_off()? {
            cell.rise()?;
            cell.push_by_nearest_link(beam)?;
            cell.rise()?;
            cell.remember_standing(&[beam]);
        }
        Ok(())
    }

    /// After a fault: put back what is held, or let it go where it is, rise, and look which pegs are still where a
    /// hand can fetch them.
    fn recover(&mut self, cell: &mut Workcell, lost: &mut Vec<String>) -> Result<(), RobotError> {
        for mend in [Workcell::put_back, Workcell::release, Workcell::rise] {
            match mend(cell) {
                Err(SkillError::Robot(error)) => return Err(error),
                Err(error) => cell.note("fault", error.to_string()),
                Ok(()) => {}
            }
        }
        cell.belief.update(&mut cell.hand)?;
        match self.put_right(cell) {
            Err(SkillError::Robot(error)) => return Err(error),
            Err(error) => cell.note("fault", error.to_string()),
            Ok(()) => {}
        }
        for peg in &self.kit.pegs {
            if cell.pinned.iter().any(|(_, name)| *name == peg.name) {
                continue;
            }
            let Ok(Some(connection)) = cell.fallen_into(&peg.name) else { continue };
            let name = &self.assembly.connections[connection].name;
            cell.note("retry", format!("{} has fallen into the hole of {name}", peg.name));
            match cell.press_home(connection, &peg.name) {
                Err(SkillError::Robot(error)) => return Err(error),
                Err(error) => cell.note("fault", error.to_string()),
                Ok(()) => {}
            }
        }
        let refused = self.fetching.take();
        for peg in &self.kit.pegs {
            let pinned = cell.pinned.iter().any(|(_, name)| *name == peg.name);
            let upright = cell.belief.pose(&peg.name).is_ok_and(|x_wp| {
                let in_holder = self.kit.x_wp_start(peg).is_some_and(|start| {
                    (start.translation.vector - x_wp.translation.vector).norm() < STRAYED
                });
                in_holder && (x_wp.rotation * nalgebra::Vector3::z()).z > 0.99
            });
            let usable = upright && refused.as_ref() != Some(&peg.name);
            if !pinned && !usable && !lost.contains(&peg.name) {
                cell.note("fault", Fault::Lost { peg: peg.name.clone() }.to_string());
                lost.push(peg.name.clone());
            }
        }
        self.report(cell);
        Ok(())
    }
}

/// The link by which the plan next picks up an item.
fn link_for<'p>(item: &Item, rest: &'p [CoarseStep]) -> Option<&'p str> {
    rest.iter().flat_map(|step| &step.fine).find_map(|action| match action {
        FineAction::PickUp { item: other, grasp: Grasp::Link(link) } if other == item => Some(link.as_str()),
        _ => None,
    })
}

impl Agent for Baseline<'_> {
    fn name(&self) -> (&str, &str) {
        ("baseline", env!("CARGO_PKG_VERSION"))
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
        self.report(&mut cell);
        result
    }
}
