//! One step: the possible actions, the conditions that forbid each, and the constraint that at most
//! one happens.

use super::candidate::Candidate;
use super::program::{GroundRule, Literal};
use super::unrolled::Unrolled;
use crate::interpreter::Ground;
use crate::term::Term;
use std::collections::BTreeMap;

impl Unrolled<'_, '_> {
    /// Adds a step; `false` when no action is possible any more.
    pub fn advance(&mut self) -> bool {
        let mut candidates = std::mem::take(&mut self.candidates);
        let choices = self.choose(&mut candidates, &mut Vec::new());
        self.candidates = candidates;
        let atoms: Vec<Literal> = choices.iter().map(|(_, occurs)| *occurs).collect();
        let any = self.at_most_one(&atoms);
        self.rules.push(GroundRule {
            choice: false,
            head: None,
            body: any.map(|any| -any).into_iter().collect(),
        });
        self.choices.push(choices);
        any.is_some()
    }

    /// At most one exogenous action happens; returns the possible ones with their literals.
    pub fn may_happen(&mut self) -> Vec<(Term, Literal)> {
        let mut candidates = Candidate::all(self.model, true);
        let choices = self.choose(&mut candidates, &mut Vec::new());
        let atoms: Vec<Literal> = choices.iter().map(|(_, occurs)| *occurs).collect();
        self.at_most_one(&atoms);
        choices
    }

    /// An attempted action: if it is impossible, it has no effect. Returns the literal of
    /// "possible, but without effect"; `None` when that cannot be.
    pub fn attempt(&mut self, action: &Term) -> Option<Literal> {
        let Ok(ground) = self.model.action(action) else { return None };
        let mut forbidden = Vec::new();
        let mut candidates = vec![Candidate::new(self.model, ground)];
        let choices = self.choose(&mut candidates, &mut forbidden);
        let &[(_, occurs)] = &choices[..] else { return None };
        let impossible = self.either(forbidden);
        Some(self.either(vec![vec![-occurs, -impossible]]))
    }

    /// The possible actions, as choices, with their consequences; `forbidding` takes the conditions
    /// that forbid them.
    fn choose(
        &mut self,
        candidates: &mut [Candidate],
        forbidding: &mut Vec<Vec<Literal>>,
    ) -> Vec<(Term, Literal)> {
        let model = self.model;
        let mut caused: BTreeMap<Ground, Vec<(bool, Vec<Literal>)>> = BTreeMap::new();
        let mut choices = Vec::new();
        let mut rules = Vec::new();
        for candidate in candidates {
            let Some(forbidden) = self.forbidden(candidate) else { continue };
            let occurs = self.atom();
            rules.push(GroundRule { choice: true, head: Some(occurs), body: Vec::new() });
            forbidding.extend(forbidden.iter().cloned());
            let constraints = forbidden.into_iter().map(|mut body| {
                body.push(occurs);
                GroundRule { choice: false, head: None, body }
            });
            rules.extend(constraints);
            for rule in &model.causal {
                model.solve_action(rule, self.view(), &candidate.action, &mut |binding| {
                    let mut body = self.body(&self.conditions(rule, binding, self.view()));
                    body.push(occurs);
                    for head in &rule.heads {
                        if let Some(fluent) = model.head(head, binding) {
                            caused.entry(fluent).or_default().push((head.positive, body.clone()));
                        }
                    }
                    false
                });
            }
            choices.push((model.atom_term(&candidate.action), occurs));
        }
        self.rules.append(&mut rules);
        self.follow(caused);
        choices
    }

    /// The bodies that forbid an action; `None` when one of them is certain.
    fn forbidden(&self, candidate: &mut Candidate) -> Option<Vec<Vec<Literal>>> {
        let mut bodies = Vec::new();
        let mut certain = None;
        for (place, &law) in candidate.laws.iter().enumerate() {
            let rule = &self.model.impossible[law];
            let stopped = self.model.solve_action(rule, self.view(), &candidate.action, &mut |binding| {
                let conditions = self.conditions(rule, binding, self.view());
                if !conditions.is_empty() {
                    bodies.push(self.body(&conditions));
                }
                conditions.is_empty()
            });
            if stopped {
                certain = Some(place);
                break;
            }
        }
        match certain {
            Some(place) => {
                candidate.laws.swap(0, place);
                None
            }
            None => Some(bodies),
        }
    }

    /// Constrains some atoms so that at most one is true. Each auxiliary atom means that one up to
    /// its index is true; the last means that any is.
    fn at_most_one(&mut self, atoms: &[Literal]) -> Option<Literal> {
        let mut so_far: Option<Literal> = None;
        for &atom in atoms {
            let next = self.atom();
            self.rules.push(GroundRule { choice: false, head: Some(next), body: vec![atom] });
            if let Some(before) = so_far {
                self.rules.push(GroundRule { choice: false, head: Some(next), body: vec![before] });
                self.rules.push(GroundRule { choice: false, head: None, body: vec![before, atom] });
            }
            so_far = Some(next);
        }
        so_far
    }
}
