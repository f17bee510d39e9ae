//! Queries on a state: true fluents, changes, and missing goals.

use super::model::Model;
use super::state::{Ground, State};
use super::values::{Relation, Value};
use crate::domain::{FluentKind, Kind};
use crate::term::Term;
use std::collections::BTreeSet;
use std::rc::Rc;

impl Model<'_> {
    /// The fluent named by a term, with names quoted or not; `None` when it does not exist.
    pub fn fluent(&self, term: &Term) -> Option<Term> {
        let known = |term: &Term| {
            let ground = self.ground(term)?;
            matches!(self.predicates[ground.predicate].kind, Kind::Fluent(_)).then(|| term.clone())
        };
        known(term).or_else(|| known(&term.quoted()))
    }

    /// Whether a fluent is true in a state, or a static.
    pub fn holds(&self, state: &State, fluent: &Term) -> bool {
        self.ground(fluent).is_some_and(|fluent| self.has(fluent.predicate, &fluent.row, state))
    }

    /// The true inertial fluents that name only these objects; without `names`, all.
    pub fn inertial_about(&self, state: &State, names: Option<&BTreeSet<String>>) -> Vec<Term> {
        let Some(names) = names else { return self.inertial(state) };
        let values = self.values.borrow();
        let mut named = vec![false; values.terms.len()];
        for name in names {
            if let Some(&value) = values.numbers.get(&Term::from(name.as_str())) {
                named[value as usize] = true;
            }
        }
        let about = |value: Value| values.names_only(value, &named);
        let mut terms = Vec::new();
        for (predicate, rows) in state.rows.iter().enumerate() {
            if self.predicates[predicate].kind == Kind::Fluent(FluentKind::Inertial) {
                let rows = rows.iter().filter(|row| row.iter().all(|&value| about(value)));
                terms.extend(rows.map(|row| self.atom_term(&Ground { predicate, row: row.clone() })));
            }
        }
        terms
    }

    /// The true fluents of one name.
    pub fn true_of(&self, state: &State, name: &str) -> Vec<Term> {
        let Some(&predicate) = self.names.get(name) else { return Vec::new() };
        let rows = state.rows[predicate].iter();
        rows.map(|row| self.atom_term(&Ground { predicate, row: row.clone() })).collect()
    }

    /// Whether the true fluents of these names are equal in two states.
    pub fn agree<const N: usize>(&self, first: &State, second: &State, names: [&str; N]) -> bool {
        let predicates = names.into_iter().filter_map(|name| self.names.get(name));
        predicates.into_iter().all(|&predicate| {
            let (first, second) = (&first.rows[predicate], &second.rows[predicate]);
            Rc::ptr_eq(first, second) || first == second
        })
    }

    /// The inertial fluents that became true in a step.
    pub fn gained(&self, before: &State, after: &State) -> Vec<Term> {
        let mut terms = Vec::new();
        for (predicate, (old, new)) in before.rows.iter().zip(&after.rows).enumerate() {
            let inertial = self.predicates[predicate].kind == Kind::Fluent(FluentKind::Inertial);
            if inertial && !Rc::ptr_eq(old, new) {
                let rows = new.difference(old);
                terms.extend(rows.map(|row| self.atom_term(&Ground { predicate, row: row.clone() })));
            }
        }
        terms
    }

    /// The true inertial fluents.
    pub fn inertial(&self, state: &State) -> Vec<Term> {
        self.of_kind(state, FluentKind::Inertial)
    }

    fn of_kind(&self, state: &State, kind: FluentKind) -> Vec<Term> {
        let mut terms = Vec::new();
        for (predicate, rows) in state.rows.iter().enumerate() {
            if self.predicates[predicate].kind == Kind::Fluent(kind) {
                terms.extend(rows.iter().map(|row| self.atom_term(&Ground { predicate, row: row.clone() })));
            }
        }
        terms
    }

    /// The goals of the domain that a state does not meet, with the required truth values.
    pub fn missing(&self, state: &State) -> Vec<(Term, bool)> {
        let mut missing = Vec::new();
        for rule in &self.goals {
            self.solve(rule, state, &mut |binding| {
                for head in &rule.heads {
                    if let Some(fluent) = self.head(head, binding)
                        && self.has(fluent.predicate, &fluent.row, state) != head.positive
                    {
                        missing.push((self.atom_term(&fluent), head.positive));
                    }
                }
                false
            });
        }
        missing
    }

    /// The statics, including derived ones.
    pub fn static_facts(&self) -> Vec<Term> {
        let of = |(predicate, relation): (usize, &Relation)| {
            let mut terms: Vec<Term> = relation
                .list
                .iter()
                .map(|row| self.atom_term(&Ground { predicate, row: row.clone() }))
                .collect();
            terms.sort();
            terms
        };
        self.statics.iter().enumerate().flat_map(of).collect()
    }

    /// All goals of the domain that do not depend on the state, with the required truth values.
    pub fn goals(&self) -> Vec<(Term, bool)> {
        let mut goals = Vec::new();
        let nothing = self.empty();
        for rule in &self.goals {
            self.solve(rule, &nothing, &mut |binding| {
                let heads = rule.heads.iter();
                goals
                    .extend(heads.filter_map(|head| {
                        Some((self.atom_term(&self.head(head, binding)?), head.positive))
                    }));
                false
            });
        }
        goals
    }

    /// The coarse fluents that are true in a fine state: those of the same name, and those of the
    /// bridge laws.
    pub fn bridged(&self, state: &State) -> BTreeSet<Term> {
        let mut terms: BTreeSet<Term> = self.inertial(state).into_iter().collect();
        for rule in &self.bridges {
            self.solve(rule, state, &mut |binding| {
                for head in &rule.heads {
                    if let Some(row) = self.row(&head.arguments, binding) {
                        let arguments = row.iter().map(|&value| self.term(value)).collect();
                        terms.insert(Term::Function(head.name.to_string(), arguments));
                    }
                }
                false
            });
        }
        terms
    }
}
