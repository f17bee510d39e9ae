//! The baseline at a single piece of a plan, in a build that others have begun: for judging single skills.
//!
//! Its input about the assembly is that of the planner: the inserted beams and the pinned connections. It has
//! to detect their actual poses.

use ramp_kit::source::{MAX_SENTENCE, plain};
use ramp_motion::PathPlanner;
use ramp_planner::{Plan, State};
use ramp_robot::{Account, Agent, Robot, RobotError};

use crate::agent::Baseline;
use crate::cell::Workcell;
use crate::fault::SkillError;
use crate::recognition::expect_state;
use crate::recovery::check_holes;

/// The baseline that executes a piece of a plan.
pub struct Piece<'a> {
    baseline: Baseline<'a>,
    state: State,
    plan: Plan,
    next: Vec<usize>,
    /// The reason for giving up.
    failure: Option<String>,
}

impl<'a> Piece<'a> {
    /// `state` is the assembly at the start, with an empty hand; `plan` has the steps that are to be carried
    /// out, and the paths of all beams, those that stand included; `next` are the connections (indices into
    /// [`ramp_assembly::Assembly::connections`]) that pegs are to pin afterwards as they are then.
    pub fn new(baseline: Baseline<'a>, state: State, plan: Plan, next: Vec<usize>) -> Piece<'a> {
        Piece { baseline, state, plan, next, failure: None }
    }

    fn work(&mut self, cell: &mut Workcell) -> Result<(), SkillError> {
        self.baseline.learn_paths(cell, &self.plan);
        expect_state(cell, &self.state)?;
        cell.belief.parts.update(&mut cell.hand)?;
        cell.calibrate()?;
        self.baseline.run_plan(cell, &self.plan)?;
        // The checks of a build before it fetches each of the next pegs, which are not part of the piece. A
        // push for one hole may misalign another.
        for _ in 0..cell.parameters.piece.rounds {
            for &connection in &self.next {
                check_holes(&self.baseline.skills, cell, connection)?;
            }
            let connections = self.next.iter().map(|index| &cell.assembly.connections[*index]);
            let offsets = connections.map(|connection| cell.belief.parts.offset(cell.assembly, connection));
            if offsets
                .collect::<Result<Vec<f64>, _>>()?
                .into_iter()
                .all(|offset| offset <= cell.parameters.alignment.peggable)
            {
                break;
            }
        }
        Ok(())
    }
}

impl Agent for Piece<'_> {
    fn name(&self) -> (&str, &str) {
        self.baseline.name()
    }

    fn file_hash(&self) -> Option<&str> {
        self.baseline.file_hash()
    }

    fn account(&self) -> Account {
        self.baseline.account()
    }

    fn failure(&self) -> Option<String> {
        self.failure.clone()
    }

    fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError> {
        let planner = PathPlanner::new(self.baseline.arm);
        let mut cell = self.baseline.cell(&planner, robot);
        let result = self.work(&mut cell);
        cell.tell_complaints();
        if let Err(error) = &result {
            cell.record(error.fault());
            self.failure = Some(plain(&error.to_string(), MAX_SENTENCE - 1));
        }
        self.baseline.report(&mut cell);
        match result {
            Err(SkillError::Robot(error)) => Err(error),
            _ => Ok(()),
        }
    }
}
