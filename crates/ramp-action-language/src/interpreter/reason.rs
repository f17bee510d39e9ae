//! Reasons: the laws that forbid an action, and the objects relevant for it.

use super::model::Model;
use super::refusal::{Reason, Refusal};
use super::rule::{Binding, Rule, Test};
use super::state::{Ground, State};
use crate::domain::{FluentKind, Kind};
use crate::term::Term;
use std::collections::BTreeSet;
use std::rc::Rc;

impl Model<'_> {
    /// All reasons against an action in a state: every law that forbids it, with every binding of
    /// its variables.
    ///
    /// # Errors
    /// When the action does not exist.
    pub fn why_not(&self, state: &State, action: &Term) -> Result<Vec<Reason>, Refusal> {
        let action = self.action(action)?;
        let mut reasons: Vec<Reason> = Vec::new();
        for rule in &self.impossible {
            self.solve_action(rule, state, &action, &mut |binding| {
                let reason = self.reason(rule, binding);
                if !reasons.contains(&reason) {
                    reasons.push(reason);
                }
                false
            });
        }
        Ok(reasons)
    }

    /// The first law that forbids an action.
    pub(crate) fn prevented(&self, state: &State, action: &Ground) -> Option<Reason> {
        self.impossible.iter().find_map(|rule| {
            let mut reason = None;
            self.solve_action(rule, state, action, &mut |binding| {
                reason = Some(self.reason(rule, binding));
                true
            });
            reason
        })
    }

    fn reason(&self, rule: &Rule, binding: &Binding) -> Reason {
        let mut objects = BTreeSet::new();
        let mut conditions = Vec::new();
        for test in &rule.conditions {
            let text = match test {
                Test::Literal { positive, predicate, arguments } => {
                    let Some(row) = self.row(arguments, binding) else { continue };
                    let term = self.atom_term(&Ground { predicate: *predicate, row });
                    objects.extend(term.texts().into_iter().map(str::to_string));
                    format!("{}{term}", if *positive { "" } else { "-" })
                }
                Test::Comparison(left, operator, right) => {
                    let side = |term| self.evaluate(term, binding).map(|value| self.term(value).to_string());
                    let (Some(left), Some(right)) = (side(left), side(right)) else { continue };
                    format!("{left} {} {right}", operator.text())
                }
            };
            conditions.push(text);
        }
        let file = self.domain.file();
        let law = file.text().get(rule.span.clone()).unwrap_or_default();
        Reason {
            law: law.split_whitespace().collect::<Vec<_>>().join(" "),
            line: file.place(rule.span.clone()).line_column().0,
            conditions,
            objects: objects.into_iter().collect(),
        }
    }

    /// The objects relevant for a transition: those named by the action, by changed fluents, and by
    /// the conditions of the action that are literally true before it.
    pub fn relevant(&self, before: &State, action: &Term, after: &State) -> BTreeSet<String> {
        let mut terms = vec![action.clone()];
        for (predicate, (old, new)) in before.rows.iter().zip(&after.rows).enumerate() {
            let inertial = self.predicates[predicate].kind == Kind::Fluent(FluentKind::Inertial);
            if !inertial || Rc::ptr_eq(old, new) {
                continue;
            }
            let changed = old.symmetric_difference(new);
            terms.extend(changed.map(|row| self.atom_term(&Ground { predicate, row: row.clone() })));
        }
        if let Ok(ground) = self.action(action) {
            for rule in &self.impossible {
                let is_static = |index: &usize| match &rule.conditions[*index] {
                    Test::Literal { positive, predicate, .. } => {
                        *positive && self.predicates[*predicate].kind == Kind::Static
                    }
                    Test::Comparison(..) => false,
                };
                let statics: Vec<usize> = (0..rule.conditions.len()).filter(is_static).collect();
                for index in 0..rule.conditions.len() {
                    let Test::Literal { predicate, .. } = &rule.conditions[index] else { continue };
                    if self.predicates[*predicate].kind == Kind::Static {
                        continue;
                    }
                    let open = [&statics[..], &[index]].concat();
                    self.solve_some(rule, before.into(), &ground, &open, &mut |binding| {
                        for condition in &open {
                            if let Test::Literal { predicate, arguments, .. } = &rule.conditions[*condition]
                                && let Some(row) = self.row(arguments, binding)
                            {
                                terms.push(self.atom_term(&Ground { predicate: *predicate, row }));
                            }
                        }
                        false
                    });
                }
            }
        }
        terms.iter().flat_map(Term::texts).map(str::to_string).collect()
    }
}
