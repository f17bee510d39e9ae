//! Cache of solved problems by shape: the shortest plan for a problem.

use super::shape::Shape;
use crate::error::PlanError;
use crate::solver::Solver;
use ramp_action_language::{Domain, Model, Refusal, Term, Unrolled};
use std::collections::HashMap;

/// Answers to problems of one domain, by their shape.
#[derive(Default)]
pub(crate) struct KnownAnswers(pub(crate) HashMap<Vec<Term>, Option<Found>>);

/// The fewest actions for a problem.
#[derive(Clone, Debug, Default)]
pub(crate) struct Found {
    pub(crate) actions: Vec<Term>,
    /// The true inertial fluents of the final state.
    pub(crate) end: Vec<Term>,
}

impl Found {
    fn name(&self, shape: &Shape) -> Found {
        let [actions, end] =
            [&self.actions, &self.end].map(|terms| terms.iter().map(|term| shape.name(term)).collect());
        Found { actions, end }
    }
}

impl KnownAnswers {
    /// Solves a problem of objects, statics, `told(F)`, `goal(F)` and `avoid(F)`.
    pub(crate) fn shortest(
        &mut self,
        solver: &mut Solver,
        domain: &Domain,
        shape: &Shape,
        most: usize,
    ) -> Result<Option<Found>, PlanError> {
        if let Some(found) = self.0.get(&shape.facts) {
            return Ok(found.as_ref().map(|found| found.name(shape)));
        }
        let found = solve(solver, domain, &shape.facts, [0, most])?;
        let named = found.as_ref().map(|found| found.name(shape));
        self.0.insert(shape.facts.clone(), found);
        Ok(named)
    }
}

/// The fewest actions, between `least` and `most`, for a problem of objects, statics, `told(F)`,
/// `goal(F)` and `avoid(F)`.
pub(crate) fn solve(
    solver: &mut Solver,
    domain: &Domain,
    problem: &[Term],
    range: [usize; 2],
) -> Result<Option<Found>, PlanError> {
    let file = domain.file();
    let (mut told, mut goals) = (Vec::new(), Vec::new());
    for term in problem {
        match term.parts() {
            Some(("told", [fluent])) => told.push(fluent.clone()),
            Some((name @ ("goal" | "avoid"), [fluent])) => goals.push((fluent.clone(), name == "goal")),
            _ => {}
        }
    }
    let model = Model::new(domain, problem);
    let refused = |refusal: Refusal| PlanError::Refused {
        file: file.name().to_string(),
        why: refusal_words(refusal, "the state"),
    };
    let start = model.resumed(&told).map_err(refused)?;
    let mut unrolled = Unrolled::new(&model, start.clone());
    let actions =
        solver.shortest(&mut unrolled, &goals, range).map_err(|error| PlanError::solver(file, &error))?;
    let Some(actions) = actions else { return Ok(None) };
    let mut state = start;
    for action in &actions {
        state = model.after(&state, action).map_err(refused)?;
    }
    Ok(Some(Found { actions, end: model.inertial(&state) }))
}

/// A refusal as a sentence; `what` is its subject.
pub(crate) fn refusal_words(refusal: Refusal, what: &str) -> String {
    match refusal {
        Refusal::Unknown(name) => format!("there is no action {name}"),
        Refusal::Impossible(reason) => {
            format!("{what} is impossible by line {}: {}", reason.line, reason.law)
        }
        Refusal::Contradiction(fluent) => format!("{what} makes {fluent} both true and false"),
    }
}
