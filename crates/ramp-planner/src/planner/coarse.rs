//! The second level: the fewest coarse actions for each task.
//!
//! A task is first solved on the part of the goal around it; the result is judged on the whole
//! goal.

use super::core::{Planner, Transition, name_of};
use super::fact_index::Facts;
use super::memo::Found;
use super::order::Order;
use super::shape::Shape;
use super::tasks::Task;
use crate::error::PlanError;
use crate::facts::{self, beam_name};
use crate::state::Known;
use ramp_action_language::{State as Fluents, Term};
use ramp_assembly::Assembly;
use std::collections::BTreeSet;

impl Planner<'_> {
    /// The coarse actions for an order, with the states between them.
    pub(crate) fn coarse(
        &mut self,
        order: &Order,
        known: &Known,
        start: &Fluents,
    ) -> Result<Vec<Transition>, PlanError> {
        let mut facts = self.facts.all.clone();
        let name = |beam: usize| beam_name(self.assembly, beam);
        facts.extend(order.before.iter().map(|&(a, b)| Term::new("before", [name(a), name(b)])));
        let facts = Facts::new(facts);
        let mut transitions: Vec<Transition> = Vec::new();
        let mut state = start.clone();
        for task in self.tasks(order, known) {
            self.reach(&task, &facts, &mut state, &mut transitions)?;
        }
        // The domain's goals for the final state, such as an empty hand.
        for _ in 0..2 {
            let missing = self.model.missing(&state);
            if missing.is_empty() {
                return Ok(transitions);
            }
            self.reach(&missing, &facts, &mut state, &mut transitions)?;
        }
        match self.model.missing(&state).first() {
            None => Ok(transitions),
            Some((fluent, _)) => {
                Err(self.no_plan(self.domains.coarse().file().name(), &fluent.to_string(), 0))
            }
        }
    }

    /// Appends the fewest actions that achieve a task.
    fn reach(
        &mut self,
        task: &Task,
        facts: &Facts,
        state: &mut Fluents,
        transitions: &mut Vec<Transition>,
    ) -> Result<(), PlanError> {
        let held = |fluent: &(Term, bool)| self.model.holds(state, &fluent.0) == fluent.1;
        if task.iter().all(held) {
            return Ok(());
        }
        // Relevant for placing a beam: the beams that it meets, and those that support them; for a
        // peg: its two beams.
        let places = task.iter().any(|(fluent, _)| name_of(fluent) == Some("in_assembly"));
        let reaches: &[usize] = match (self.options.zoom, places) {
            (false, _) => &[],
            (true, true) => &[1, 2],
            (true, false) => &[0, 2],
        };
        for &reach in reaches {
            if let Some(actions) = self.solve_task(task, facts, state, Some(reach))?
                && let Ok(walked) = self.walk(state, &actions)
                // Judged on the whole goal: the omitted parts made no difference.
                && let Some(last) = walked.last()
                && task.iter().all(|(fluent, truth)| self.model.holds(&last.after, fluent) == *truth)
            {
                *state = last.after.clone();
                transitions.extend(walked);
                return Ok(());
            }
        }
        let name = self.domains.coarse().file().name().to_string();
        let words = task.iter().map(|(fluent, truth)| format!("{}{fluent}", if *truth { "" } else { "-" }));
        let words = words.collect::<Vec<_>>().join(", ");
        let actions = self
            .solve_task(task, facts, state, None)?
            .ok_or_else(|| self.no_plan(&name, &words, most_steps(self.assembly)))?;
        let walked = self.walk(state, &actions)?;
        if let Some(last) = walked.last() {
            *state = last.after.clone();
        }
        transitions.extend(walked);
        Ok(())
    }

    fn solve_task(
        &mut self,
        task: &Task,
        facts: &Facts,
        state: &Fluents,
        reach: Option<usize>,
    ) -> Result<Option<Vec<Term>>, PlanError> {
        let mut problem: Vec<Term> = Vec::new();
        let goal = |(fluent, truth): &(Term, bool)| {
            Term::new(if *truth { "goal" } else { "avoid" }, [fluent.clone()])
        };
        let keep = reach.map(|reach| self.around(task, state, reach));
        problem.extend(facts.about(keep.as_ref()).cloned());
        let told = self.model.inertial_about(state, keep.as_ref());
        problem.extend(told.into_iter().map(|fluent| Term::new("told", [fluent])));
        problem.extend(task.iter().map(goal));
        let shape = Shape::of(&problem, &self.coarse_sight);
        let most = most_steps(self.assembly);
        let found = self.coarse_answers.shortest(&mut self.solver, self.domains.coarse(), &shape, most)?;
        let Some(Found { mut actions, .. }) = found else { return Ok(None) };
        // Consecutive pushes may come in any order; it is always the same one.
        for run in actions.chunk_by_mut(|a, b| is_push(a) && is_push(b)) {
            run.sort_by_key(|action| action.texts().first().and_then(|name| self.assembly.beam_index(name)));
        }
        Ok(Some(actions))
    }

    /// The names relevant for a task: its beams and those at most `reach` joints away.
    fn around(&self, task: &Task, state: &Fluents, reach: usize) -> BTreeSet<String> {
        let mut names = self.coarse_sight.known.clone();
        let in_hand = ["in_hand", "stuck"].map(|name| self.model.true_of(state, name)).concat();
        let texts = task.iter().map(|(fluent, _)| fluent).chain(&in_hand).flat_map(Term::texts);
        let mut beams: BTreeSet<usize> = BTreeSet::new();
        for text in texts {
            beams.extend(self.assembly.beam_index(text));
            if let Some(index) = self.assembly.connection_index(text) {
                let connection = &self.assembly.connections[index];
                beams.extend([connection.female.beam, connection.male.beam]);
            }
        }
        // Beams that are not placed yet have no effect.
        let (stands, _) = self.standing(state);
        let in_the_way: Vec<usize> = beams
            .iter()
            .flat_map(|&beam| (0..self.geometry.paths.ways(beam).len()).map(move |way| (beam, way)))
            .flat_map(|(beam, way)| self.geometry.paths.blocked(beam, way))
            .filter(|&other| stands[other])
            .collect();
        for _ in 0..reach {
            let next: Vec<usize> = beams
                .iter()
                .flat_map(|&beam| facts::partners(self.assembly, beam))
                .map(|(_, other)| other)
                .filter(|&other| stands[other])
                .collect();
            beams.extend(next);
        }
        if reach > 0 {
            beams.extend(in_the_way);
        }
        names.extend(beams.iter().map(|&beam| self.assembly.beams[beam].beam.name.clone()));
        for connection in &self.assembly.connections {
            if beams.contains(&connection.female.beam) && beams.contains(&connection.male.beam) {
                names.insert(connection.name.clone());
            }
        }
        names
    }
}

fn is_push(action: &Term) -> bool {
    name_of(action) == Some("push")
}

/// To the assembly and back with a push for every beam, there and back again, and the task itself.
fn most_steps(assembly: &Assembly) -> usize {
    assembly.beams.len().min(24) + 14
}
