//! Proofs: a lower bound on the number of coarse actions, and the search for a shorter plan.

use super::core::Planner;
use super::memo::solve;
use crate::error::PlanError;
use crate::solver::Solver;
use crate::state::Known;
use ramp_action_language::{State as Fluents, Term};

impl Planner<'_> {
    /// A plan of at most `most` coarse actions for the whole goal, if one exists, and a lower
    /// bound.
    pub(crate) fn shorter(
        &mut self,
        start: &Fluents,
        least: usize,
        most: usize,
    ) -> Result<(Option<Vec<Term>>, usize), PlanError> {
        let mut problem = self.facts.all.clone();
        let told = self.model.inertial(start);
        problem.extend(told.into_iter().map(|fluent| Term::new("told", [fluent])));
        let goal = |(fluent, truth)| Term::new(if truth { "goal" } else { "avoid" }, [fluent]);
        problem.extend(self.model.goals().into_iter().map(goal));
        let mut solver = Solver { thorough: true, ..Solver::default() };
        let found = solve(&mut solver, self.domains.coarse(), &problem, [least, most]);
        self.solver.solves += solver.solves;
        match found {
            Ok(Some(found)) => {
                let steps = found.actions.len();
                Ok((Some(found.actions), steps))
            }
            Ok(None) => Ok((None, most + 1)),
            Err(PlanError::GaveUp { steps, .. }) => Ok((None, steps)),
            Err(error) => Err(error),
        }
    }
}

/// The hand begins over the sheet and every item costs six actions: pick up, two moves, one to
/// build it in, two moves back. After the last item, one move that frees the hand replaces the two
/// moves back.
pub(crate) fn lower_bound(known: &Known) -> usize {
    let beams = known.stands.iter().filter(|stands| !**stands).count();
    let pegs = known.pinned.iter().filter(|pinned| pinned.is_none()).count();
    let held = usize::from(known.held_beam.is_some() || known.held_peg.is_some());
    // A held item only needs to be built in, and the hand may be there already.
    (6 * (beams + pegs)).saturating_sub(1 + 3 * held)
}
