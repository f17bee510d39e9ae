//! The baseline at a single piece of a plan, in a build that others have begun: for judging single skills.
//!
//! Its input about the assembly is that of the planner: the inserted beams and the pinned connections. It has
//! to detect their actual poses.

use nalgebra::Translation3;
use ramp_kit::joint::FEMALE_HEIGHT;
use ramp_kit::source::{MAX_SENTENCE, plain};
use ramp_motion::PathPlanner;
use ramp_planner::{Plan, State};
use ramp_robot::{Account, Agent, Robot, RobotError};

use crate::Pose;
use crate::agent::Baseline;
use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
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
        take_over(cell, &self.state)?;
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

/// Records the given assembly without a detection.
fn take_over(cell: &mut Workcell, state: &State) -> Result<(), SkillError> {
    let unknown = |name: &str| Fault::Unseen { part: name.to_string() };
    let assembly = cell.assembly;
    for name in &state.in_assembly {
        cell.belief.standing.push(assembly.beam_index(name).ok_or_else(|| unknown(name))?);
    }
    for name in &state.deep {
        cell.belief.deep.push(assembly.beam_index(name).ok_or_else(|| unknown(name))?);
    }
    for (name, peg) in &state.fastened {
        let connection = assembly.connection_index(name).ok_or_else(|| unknown(name))?;
        cell.belief.pinned.push((connection, peg.clone()));
        let hole = cell.belief.x_wa() * assembly.p_a_hole(assembly.connections[connection].female);
        let x_wp = Pose::translation(hole.x, hole.y, hole.z + FEMALE_HEIGHT / 2.0);
        cell.belief.parts.expect(
            peg,
            x_wp,
            (cell.parameters.piece.peg_position, cell.parameters.piece.peg_rotation),
        );
    }
    let beams: Vec<usize> =
        cell.belief.standing.iter().copied().filter(|beam| *beam != assembly.base).collect();
    for &beam in &beams {
        let mut x_wb = cell.belief.x_wa() * assembly.beams[beam].x_ab;
        if cell.belief.deep.contains(&beam) {
            let path = cell.belief.path(beam)?;
            x_wb = Translation3::from(cell.belief.x_wa().rotation * path.direction * path.depth) * x_wb;
        }
        let x_wb = cell.belief.drooped(beam, &x_wb).unwrap_or(x_wb);
        cell.belief.parts.expect(
            &assembly.beams[beam].beam.name,
            x_wb,
            (cell.parameters.piece.beam_position, cell.parameters.piece.beam_rotation),
        );
    }
    for beam in beams {
        cell.belief.reckon_heights(beam);
    }
    Ok(())
}
