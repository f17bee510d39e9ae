//! The search through the levels: one order of the beams after another, until all levels agree.

use super::core::{Planner, Transition};
use super::order::Order;
use super::proof::lower_bound;
use crate::error::PlanError;
use crate::plan::{CoarseStep, Entry, Plan, Statistics};
use crate::state::Known;
use ramp_action_language::State as Fluents;

/// Number of orders of the beams that are tried.
const MOST_ORDERS: usize = 24;

impl Planner<'_> {
    /// The plan from a state.
    pub(crate) fn plan(&mut self, known: &Known) -> Result<Plan, PlanError> {
        let (transitions, steps, lower_bound) = self.search(known)?;
        let statistics =
            Statistics { solves: self.solver.solves, optimal: lower_bound == transitions.len(), lower_bound };
        Ok(Plan { entries: self.entries(&transitions), steps, statistics })
    }

    /// The coarse actions of the plan, with the states between them.
    pub(crate) fn transitions(&mut self, known: &Known) -> Result<Vec<Transition>, PlanError> {
        Ok(self.search(known)?.0)
    }

    /// Plans, and replans with a regrasp for each beam without a common grasp: the possible grasps
    /// at a beam's goal pose depend on the beams placed by then.
    fn search(&mut self, known: &Known) -> Result<(Vec<Transition>, Vec<CoarseStep>, usize), PlanError> {
        loop {
            let found = self.try_orders(known);
            let Some(beam) = self.ungrasped.take().filter(|_| found.is_err()) else { return found };
            if !self.regrasp(&[beam]) {
                return found;
            }
        }
    }

    /// Tries one order of the beams after another.
    fn try_orders(&mut self, known: &Known) -> Result<(Vec<Transition>, Vec<CoarseStep>, usize), PlanError> {
        let start = self.fluents(known)?;
        let mut refused: Vec<Order> = Vec::new();
        let mut first_error: Option<PlanError> = None;
        loop {
            let order = match self.order(known, &refused) {
                Ok(order) => order,
                // The error of the levels below for the first order is more informative.
                Err(error) => return Err(first_error.unwrap_or(error)),
            };
            match self.build(&order, known, &start) {
                Ok(found) => return Ok(found),
                Err(error @ (PlanError::NoPlan { .. } | PlanError::Illegal { .. })) => {
                    let first = first_error.get_or_insert(error);
                    refused.push(order);
                    if refused.len() >= MOST_ORDERS {
                        return Err(std::mem::replace(
                            first,
                            PlanError::NoOrder { goal: self.assembly.name.clone() },
                        ));
                    }
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// Coarse and fine actions for an order, and a lower bound on the number of coarse actions.
    fn build(
        &mut self,
        order: &Order,
        known: &Known,
        start: &Fluents,
    ) -> Result<(Vec<Transition>, Vec<CoarseStep>, usize), PlanError> {
        let mut transitions = self.coarse(order, known, start)?;
        self.has_ways(&transitions)?;
        // The analytic bound is known for the shipped rules only.
        let shipped =
            self.domains.coarse().file().text() == include_str!("../../../../data/domains/coarse.al");
        let mut lower_bound = if shipped { lower_bound(known).min(transitions.len()) } else { 0 };
        if self.options.optimal && lower_bound < transitions.len() {
            let (shorter, proven) = self.shorter(start, lower_bound, transitions.len() - 1)?;
            if let Some(actions) = shorter {
                transitions = self.walk(start, &actions)?;
            }
            lower_bound = proven.min(transitions.len());
        }
        let steps = self.steps(&transitions, known)?;
        Ok((transitions, steps, lower_bound))
    }

    /// Checks that each beam has an insertion path past all beams placed by then. The rules only
    /// know single beams that block a path. Where one beam makes the path longer and another one
    /// blocks it further out, only both together do.
    fn has_ways(&self, transitions: &[Transition]) -> Result<(), PlanError> {
        for transition in transitions {
            let Some((name @ ("assemble" | "assemble_deep" | "lay_down"), [beam])) =
                transition.action.parts()
            else {
                continue;
            };
            let Some(index) = beam.texts().first().and_then(|name| self.assembly.beam_index(name)) else {
                continue;
            };
            let (stands, _) = self.standing(&transition.before);
            if self.geometry.way(index, &stands, name == "lay_down").is_none() {
                let beam = &self.assembly.beams[index].beam.name;
                return Err(PlanError::Illegal {
                    goal: self.assembly.name.clone(),
                    why: format!("{beam} has no insertion path past the beams placed before it"),
                    beams: vec![beam.clone()],
                });
            }
        }
        Ok(())
    }

    /// Insertion motions of the beams in some transitions.
    fn entries(&self, transitions: &[Transition]) -> Vec<Entry> {
        let mut entries = Vec::new();
        for transition in transitions {
            let Some((name @ ("assemble" | "assemble_deep" | "lay_down"), [beam])) =
                transition.action.parts()
            else {
                continue;
            };
            let Some(beam) = beam.texts().first().and_then(|name| self.assembly.beam_index(name)) else {
                continue;
            };
            let (stands, _) = self.standing(&transition.before);
            if let Some((way, distance)) = self.geometry.way(beam, &stands, name == "lay_down") {
                let shuttles = self.geometry.shuttles.iter().filter(|shuttle| shuttle.beam == beam);
                let depth = shuttles.map(|shuttle| shuttle.depth).fold(0.0, f64::max);
                entries.push(Entry {
                    beam: self.assembly.beams[beam].beam.name.clone(),
                    path: way.name.to_string(),
                    direction: way.direction.into_inner().into(),
                    distance,
                    depth: if name == "assemble_deep" { depth } else { 0.0 },
                });
            }
        }
        entries
    }
}
