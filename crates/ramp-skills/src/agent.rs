//! The baseline agent: plans, runs the plan action by action, notices what goes wrong and plans again from what it
//! then believes.

use std::time::Instant;

use ramp_assembly::Assembly;
use ramp_kit::Kit;
use ramp_motion::PathPlanner;
use ramp_planner::{CoarseAction, Domains, FineAction, Item, Place, Plan, PlanError, State, Target};
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;
use ramp_robot::{Account, Agent, Event, Robot, RobotError};

use crate::belief::Belief;
use crate::fault::SkillError;
use crate::hand::Hand;
use crate::insert::PEGGABLE;
use crate::transport::Workcell;

/// How often the agent plans again before it gives up.
const REPLANS: usize = 6;

/// The baseline.
pub struct Baseline<'a> {
    kit: &'a Kit,
    assembly: &'a Assembly,
    arm: &'a ArmModel,
    domains: &'a Domains,
    seed: u64,
    account: Account,
    plan: Option<Plan>,
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

    /// Hands new events on to the listener and into the account.
    fn report(&mut self, cell: &mut Workcell) {
        for event in cell.events.drain(..) {
            (self.on_event)(&event);
            self.account.events.push(event);
        }
    }

    fn work(&mut self, cell: &mut Workcell) -> Result<(), RobotError> {
        let mut lost: Vec<String> = Vec::new();
        for round in 0..=REPLANS {
            let state = self.state(cell, &lost);
            let plan = match self.make_plan(&state) {
                Ok(plan) => plan,
                Err(error) => {
                    cell.note("fault", format!("no plan: {error}"));
                    self.report(cell);
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
            match self.run_plan(cell, &plan) {
                Ok(()) => return Ok(()),
                Err(SkillError::Robot(error)) => return Err(error),
                Err(error) => {
                    cell.note("fault", error.to_string());
                    self.report(cell);
                    self.recover(cell, &mut lost)?;
                }
            }
        }
        cell.note("fault", format!("gave up after {REPLANS} new plans"));
        self.report(cell);
        Ok(())
    }

    /// What the planner is told about the world.
    fn state(&self, cell: &Workcell, lost: &[String]) -> State {
        let base = self.assembly.base;
        let standing = cell.standing.iter().filter(|beam| **beam != base);
        State {
            in_assembly: standing.map(|beam| self.assembly.beams[*beam].beam.name.clone()).collect(),
            fastened: cell
                .pinned
                .iter()
                .map(|(index, peg)| (self.assembly.connections[*index].name.clone(), peg.clone()))
                .collect(),
            misaligned: Vec::new(),
            lost_pegs: lost.to_vec(),
        }
    }

    fn run_plan(&mut self, cell: &mut Workcell, plan: &Plan) -> Result<(), SkillError> {
        for (index, step) in plan.steps.iter().enumerate() {
            if let CoarseAction::PickUp { item: Item::Peg(_) } = &step.coarse {
                self.check_before_peg(cell, &plan.steps[index..])?;
            }
            for action in &step.fine {
                cell.note("start", action.to_string());
                self.report(cell);
                self.act(cell, action)?;
                cell.note("done", action.to_string());
                self.report(cell);
            }
        }
        Ok(())
    }

    /// Before a peg is fetched: would it go in? A peg pulls two holes together that are up to 1.7 mm apart, and
    /// stands on the male when they are further.
    fn check_before_peg(
        &mut self,
        cell: &mut Workcell,
        rest: &[ramp_planner::CoarseStep],
    ) -> Result<(), SkillError> {
        let next = rest.iter().find_map(|step| match &step.coarse {
            CoarseAction::Fasten { connection, .. } => self.assembly.connection_index(connection),
            _ => None,
        });
        let Some(index) = next else { return Ok(()) };
        cell.belief.update(&mut cell.hand)?;
        let connection = &self.assembly.connections[index];
        let offset = cell.belief.offset(self.assembly, connection)?;
        if offset <= PEGGABLE {
            return Ok(());
        }
        cell.note("fault", format!("the holes of {} are {:.2} mm apart", connection.name, offset * 1e3));
        let beam = connection.male.beam;
        if beam == self.assembly.base {
            return Ok(());
        }
        let placed = &self.assembly.beams[beam].beam;
        let links = placed.links.iter().map(|link| link.name.clone()).collect::<Vec<_>>();
        for link in links.iter().rev() {
            cell.rise()?;
            if cell.push(beam, link).is_ok() {
                break;
            }
        }
        self.report(cell);
        Ok(())
    }

    fn act(&mut self, cell: &mut Workcell, action: &FineAction) -> Result<(), SkillError> {
        let beam_index = |name: &str| self.assembly.beam_index(name);
        match action {
            FineAction::Move { to } => match to {
                Place::Above(_) => cell.rise(),
                Place::Input(item) => cell.hover(item.name(), self.link_for(item).as_deref()),
                Place::Approach(Target::Connection(name)) => {
                    match (self.assembly.connection_index(name), &cell.hand.held) {
                        (Some(index), Some(_)) => cell.approach_hole(index),
                        _ => Ok(()),
                    }
                }
                Place::Approach(Target::Beam(name)) => match (beam_index(name), &cell.hand.held) {
                    (Some(index), Some(_)) => cell.approach_beam(index),
                    // With an empty hand the skill that follows finds its own way.
                    _ => cell.rise(),
                },
                Place::Target(_) => Ok(()),
            },
            FineAction::PickUp { item, grasp } => {
                let link = match grasp {
                    ramp_planner::Grasp::Link(link) => Some(link.as_str()),
                    ramp_planner::Grasp::Head => None,
                };
                cell.pick_up(item.name(), link)
            }
            FineAction::PutDown { .. } => cell.release(),
            FineAction::AssembleSquare { beam, .. } => match beam_index(beam) {
                Some(index) => cell.assemble(index, false),
                None => Ok(()),
            },
            FineAction::AssembleCap { beam, .. } => match beam_index(beam) {
                Some(index) => cell.assemble(index, true),
                None => Ok(()),
            },
            FineAction::Fasten { connection, .. } => match self.assembly.connection_index(connection) {
                Some(index) => cell.fasten(index),
                None => Ok(()),
            },
            FineAction::Push { beam, link } => match beam_index(beam) {
                Some(index) => {
                    cell.rise()?;
                    cell.push(index, link)
                }
                None => Ok(()),
            },
        }
    }

    /// The link by which the plan picks an item up next.
    fn link_for(&self, item: &Item) -> Option<String> {
        let plan = self.plan.as_ref()?;
        plan.steps.iter().flat_map(|step| &step.fine).find_map(|action| match action {
            FineAction::PickUp { item: other, grasp: ramp_planner::Grasp::Link(link) } if other == item => {
                Some(link.clone())
            }
            _ => None,
        })
    }

    /// After a fault: let go of what is held, where it can do no harm, and look again.
    fn recover(&mut self, cell: &mut Workcell, lost: &mut Vec<String>) -> Result<(), RobotError> {
        if let Some(held) = cell.hand.held.clone() {
            if cell.kit.peg(&held.part).is_some() {
                lost.push(held.part.clone());
            }
        }
        let attempts: [&mut dyn FnMut(&mut Workcell) -> Result<(), SkillError>; 2] =
            [&mut |cell| cell.release(), &mut |cell| cell.rise()];
        for attempt in attempts {
            match attempt(cell) {
                Err(SkillError::Robot(error)) => return Err(error),
                Err(error) => cell.note("fault", error.to_string()),
                Ok(()) => {}
            }
        }
        self.report(cell);
        Ok(())
    }
}

impl Agent for Baseline<'_> {
    fn name(&self) -> (&str, &str) {
        ("baseline", env!("CARGO_PKG_VERSION"))
    }

    fn account(&self) -> Account {
        self.account.clone()
    }

    fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError> {
        let planner = PathPlanner::new(self.arm);
        let mut cell = Workcell {
            kit: self.kit,
            assembly: self.assembly,
            arm: self.arm,
            planner: &planner,
            hand: Hand::new(robot),
            belief: Belief::default(),
            standing: vec![self.assembly.base],
            pinned: Vec::new(),
            stream: Stream::new(self.seed, "motion"),
            events: Vec::new(),
        };
        let result = self.work(&mut cell);
        self.report(&mut cell);
        result
    }
}
