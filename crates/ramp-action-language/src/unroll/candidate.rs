//! Candidate actions: all actions of a kind, each with the laws that may forbid it.

use crate::domain::Kind;
use crate::interpreter::{Ground, Model, Row};

/// An action that a plan may contain.
pub(crate) struct Candidate {
    pub(crate) action: Ground,
    /// The laws that may forbid it, starting with the one that did so last.
    pub(crate) laws: Vec<usize>,
}

impl Candidate {
    /// One action.
    pub(crate) fn new(model: &Model, action: Ground) -> Candidate {
        Candidate { laws: Candidate::laws(model, action.predicate), action }
    }

    /// The laws that may forbid actions of a name.
    fn laws(model: &Model, predicate: usize) -> Vec<usize> {
        let is_about = |law: &usize| {
            model.impossible[*law].action.as_ref().is_some_and(|head| head.predicate == predicate)
        };
        (0..model.impossible.len()).filter(is_about).collect()
    }

    /// All actions that a plan may contain, or all exogenous ones.
    pub(crate) fn all(model: &Model, exogenous: bool) -> Vec<Candidate> {
        let mut candidates = Vec::new();
        for (predicate, known) in model.predicates.iter().enumerate() {
            if known.kind != (Kind::Action { exogenous }) {
                continue;
            }
            let sorts = model.domain.predicates.get(known.name).map(|p| p.sorts.as_slice());
            let mut rows: Vec<Row> = vec![Row::new()];
            for sort in sorts.unwrap_or_default() {
                let sort = model.sort_numbers.get(sort.as_str());
                let elements = sort.map(|&sort| model.elements[sort].as_slice()).unwrap_or_default();
                let longer = |row: Row| {
                    elements.iter().map(move |&value| row.iter().copied().chain([value]).collect::<Row>())
                };
                rows = rows.into_iter().flat_map(longer).collect();
            }
            let grounds = rows.into_iter().map(|row| Ground { predicate, row });
            let laws = Candidate::laws(model, predicate);
            candidates.extend(grounds.map(|action| Candidate { action, laws: laws.clone() }));
        }
        candidates
    }
}
