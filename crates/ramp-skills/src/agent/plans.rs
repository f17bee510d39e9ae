//! The plans of the baseline: those of its own planner, rehearsed with the arm's model, or of another.

use std::time::Instant;

use ramp_assembly::Assembly;
use ramp_kit::source::{MAX_SENTENCE, plain};
use ramp_motion::MotionError;
use ramp_planner::{End, Impossible, MotionFact, Plan, PlanError, State};
use ramp_robot::EventKind;

use super::Baseline;
use crate::cell::Workcell;
use crate::clear;
use crate::fault::{Fault, SkillError};
use crate::rehearsal::{Rehearsal, Scene, UnusualGrasp, plan_with_motion};
use crate::skill::Call;

impl<'a> Baseline<'a> {
    /// Plans from a state, given the limits of the arm there. If no such plan is left, the goal is built as
    /// far as possible without them. Beams that are left for later are not in the plan.
    pub(super) fn make_plan(&mut self, cell: &mut Workcell, mut state: State) -> Result<Plan, String> {
        let begin = Instant::now();
        let rest = self.rest(cell)?;
        let goal = rest.as_ref().unwrap_or(self.assembly);
        state.fastened.retain(|(connection, _)| goal.connection_index(connection).is_some());
        let facts = self.learned.iter().chain(self.history.facts());
        state.motion = facts.filter_map(|fact| fact.of(goal)).collect();
        state.lost_pegs.extend_from_slice(self.history.aside());
        let plan = match &mut self.planner {
            Some(_) if rest.is_some() => Err("a planner of one's own plans the whole goal".to_string()),
            Some(planner) => planner(&state, &self.account.events),
            None => self.own_plan(cell, goal, state).map_err(|error| error.to_string()),
        };
        self.account.planning += begin.elapsed().as_secs_f64();
        plan
    }

    /// The goal without the beams that are left for later, and without those that only these join to the
    /// rest. `None` if there are none.
    ///
    /// # Errors
    /// If the rest cannot be built alone.
    fn rest(&self, cell: &Workcell) -> Result<Option<Assembly>, String> {
        let goal = self.assembly;
        let left: Vec<usize> =
            self.history.left_out().iter().filter_map(|beam| goal.beam_index(beam)).collect();
        if left.is_empty() {
            return Ok(None);
        }
        let mut kept = cell.belief.standing.clone();
        kept.push(goal.base);
        loop {
            let joined = |beam: &usize| {
                goal.connections
                    .iter()
                    .any(|it| goal.sides(it, *beam).is_some_and(|(_, theirs)| kept.contains(&theirs.beam)))
            };
            let is_next = |beam: &usize| !kept.contains(beam) && !left.contains(beam) && joined(beam);
            match (0..goal.beams.len()).find(is_next) {
                Some(beam) => kept.push(beam),
                None => break,
            }
        }
        let rest = goal.of_beams(|beam| kept.contains(&beam));
        rest.map(Some).ok_or_else(|| "no order of insertions builds the rest".to_string())
    }

    /// The plan of its own planner: rehearsed with all limits that skills have found, else without them, else
    /// by the rules alone if no limit stands against the work that failed. The history's facts always hold.
    fn own_plan(
        &mut self,
        cell: &mut Workcell,
        goal: &Assembly,
        mut state: State,
    ) -> Result<Plan, PlanError> {
        loop {
            let error = match self.rehearsed_plan(cell, goal, &state) {
                Err(error @ PlanError::Motion { .. }) => error,
                done => return done,
            };
            cell.record(EventKind::Note { text: plain(&error.to_string(), MAX_SENTENCE - 1) });
            state.motion = self.history.facts().iter().filter_map(|fact| fact.of(goal)).collect();
            if self.learned.is_empty() {
                cell.grasps.clear();
                let plan = ramp_planner::plan(goal, &state, self.domains)?;
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
            .without_lost(|part| cell.belief.parts.is_lost(part))
            .without_unseen(self.start.scatter.as_ref().map(|_| &believed[..]))
    }

    /// A plan that the rehearsal accepts.
    fn rehearsed_plan(
        &mut self,
        cell: &mut Workcell,
        goal: &Assembly,
        state: &State,
    ) -> Result<Plan, PlanError> {
        let rehearsed = plan_with_motion(goal, state, self.domains, || self.rehearsal(cell, state))?;
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

    /// Lays a beam down elsewhere on the table, so that the hand has room to take its neighbour. What the arm
    /// could not do at the neighbour's place is open again.
    ///
    /// # Errors
    /// The reason for which it stays where it is, for a person.
    pub(super) fn lay_aside(
        &mut self,
        cell: &mut Workcell,
        name: &str,
        neighbour: &str,
    ) -> Result<(), String> {
        let Some(beam) = cell.kit.beam(name) else { return Err(format!("{name} is no beam")) };
        let entries = self.plan.as_ref().map_or(&[][..], |plan| &plan.entries);
        let done =
            clear::lay_aside(&self.skills, cell, entries, beam, &format!("{name} lies beside {neighbour}"));
        self.report(cell);
        done.map_err(|error| error.to_string())?;
        let is_open = |fact: &MotionFact| match &fact.cannot {
            Impossible::Grasp { beam, at: End::Start, .. } => beam != neighbour,
            _ => true,
        };
        self.learned.retain(is_open);
        self.told.retain(is_open);
        Ok(())
    }

    /// Records the arm's limit that the error of an action shows.
    pub(super) fn learn(&mut self, cell: &mut Workcell, call: &Call, error: &SkillError) {
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
}
