//! The ground problem: what actions can reach, under which conditions, and with which effects.

use std::collections::{BTreeMap, BTreeSet};

use crate::domain::{FluentKind, Kind};
use crate::interpreter::{Ground, Model, State};
use crate::pddl::PddlError;
use crate::unroll::{Candidate, Unrolled};

/// A fluent and its truth.
pub(super) type Literal = (Ground, bool);
/// Conditions that all hold.
pub(super) type All = BTreeSet<Literal>;

/// An action with the conditions that forbid it, and its effects.
pub(super) struct Action {
    pub action: Ground,
    /// None of these holds.
    pub forbidden: BTreeSet<All>,
    /// Conditions, and the literal that becomes true if all of them hold.
    pub effects: BTreeSet<(All, Literal)>,
}

/// A problem whose fluents are undecided; certain ones are left out of all conditions.
pub(super) struct Grounded {
    /// The inertial fluents that actions change.
    pub inertial: BTreeSet<Ground>,
    /// The bodies of each defined fluent, one of which holds when it does.
    pub defined: BTreeMap<Ground, BTreeSet<All>>,
    pub actions: Vec<Action>,
    /// The goals; `None` when one can never be met.
    pub goals: Option<All>,
}

impl Grounded {
    /// Grounds the domain from a state.
    ///
    /// # Errors
    /// When a state constraint has several fluents in its body.
    pub fn new(model: &Model, start: &State) -> Result<Grounded, PddlError> {
        let mut reach = Reach { bounds: Unrolled::new(model, start.clone()), model };
        let candidates = Candidate::all(model, false);
        while reach.widen(&candidates) {}
        let links = reach.links()?;
        let mut actions = Vec::new();
        for candidate in &candidates {
            let forbidden = reach.forbidden(candidate);
            if !forbidden.iter().any(BTreeSet::is_empty) {
                let effects = reach.effects(&candidate.action, &links);
                actions.push(Action { action: candidate.action.clone(), forbidden, effects });
            }
        }
        Ok(Grounded {
            inertial: reach.undecided(FluentKind::Inertial),
            defined: reach.defined(),
            actions,
            goals: reach.goals(),
        })
    }
}

/// The fluents that may be true, and those that must be, after any actions.
struct Reach<'m, 'd> {
    bounds: Unrolled<'m, 'd>,
    model: &'m Model<'d>,
}

/// The conclusions of state constraints, by the fluent that they follow from.
type Links = BTreeMap<Literal, Vec<Literal>>;

impl Reach<'_, '_> {
    /// Adds what the possible actions change; `false` if that is nothing new.
    fn widen(&mut self, candidates: &[Candidate]) -> bool {
        let (mut may, mut must) = (self.bounds.may.clone(), self.bounds.must.clone());
        let mut changed = BTreeSet::new();
        for candidate in candidates {
            if self.forbidden(candidate).iter().any(BTreeSet::is_empty) {
                continue;
            }
            for rule in &self.model.causal {
                self.model.solve_action(rule, self.bounds.view(), &candidate.action, &mut |binding| {
                    for head in &rule.heads {
                        let Some(fluent) = self.model.head(head, binding) else { continue };
                        let state = if head.positive { &mut may } else { &mut must };
                        if self.model.put(state, &fluent, head.positive) {
                            changed.insert(fluent.predicate);
                        }
                    }
                    false
                });
            }
        }
        let any = !changed.is_empty();
        self.bounds.relax(&mut may, &mut must, changed);
        (self.bounds.may, self.bounds.must) = (may, must);
        any
    }

    fn forbidden(&self, candidate: &Candidate) -> BTreeSet<All> {
        let mut bodies = BTreeSet::new();
        for &law in &candidate.laws {
            let rule = &self.model.impossible[law];
            self.model.solve_action(rule, self.bounds.view(), &candidate.action, &mut |binding| {
                let body: All =
                    self.bounds.conditions(rule, binding, self.bounds.view()).into_iter().collect();
                let certain = body.is_empty();
                bodies.insert(body);
                certain
            });
        }
        bodies
    }

    fn is_certain(&self, (fluent, truth): &Literal) -> bool {
        match truth {
            true => self.bounds.in_state(fluent, &self.bounds.must),
            false => !self.bounds.in_state(fluent, &self.bounds.may),
        }
    }

    fn links(&self) -> Result<Links, PddlError> {
        let mut links = Links::new();
        for rule in &self.model.constraints {
            let mut several = false;
            self.model.solve(rule, self.bounds.view(), &mut |binding| {
                let body = self.bounds.conditions(rule, binding, self.bounds.view());
                let Some(fluent) = self.model.head(&rule.heads[0], binding) else { return false };
                match &body[..] {
                    [] => {}
                    [trigger] => {
                        links.entry(trigger.clone()).or_default().push((fluent, rule.heads[0].positive));
                    }
                    _ => several = true,
                }
                several
            });
            if several {
                let file = self.model.domain.file();
                return Err(PddlError::Law {
                    file: file.name().to_string(),
                    line: file.place(rule.span.clone()).line_column().0,
                    why: "expected a state constraint with one fluent in its body".to_string(),
                });
            }
        }
        Ok(links)
    }

    /// The effects of an action, with their consequences.
    fn effects(&self, action: &Ground, links: &Links) -> BTreeSet<(All, Literal)> {
        let mut effects = BTreeSet::new();
        let mut open: Vec<(All, Literal)> = Vec::new();
        for rule in &self.model.causal {
            self.model.solve_action(rule, self.bounds.view(), action, &mut |binding| {
                let body: All =
                    self.bounds.conditions(rule, binding, self.bounds.view()).into_iter().collect();
                let heads = rule.heads.iter();
                open.extend(heads.filter_map(|head| {
                    Some((body.clone(), (self.model.head(head, binding)?, head.positive)))
                }));
                false
            });
        }
        while let Some((body, literal)) = open.pop() {
            if self.is_certain(&literal) || !effects.insert((body.clone(), literal.clone())) {
                continue;
            }
            let more = links.get(&literal).into_iter().flatten();
            open.extend(more.map(|next| (body.clone(), next.clone())));
        }
        effects
    }

    fn undecided(&self, kind: FluentKind) -> BTreeSet<Ground> {
        let mut fluents = BTreeSet::new();
        for (predicate, rows) in self.bounds.may.rows.iter().enumerate() {
            if self.model.predicates[predicate].kind == Kind::Fluent(kind) {
                let new = rows.iter().filter(|row| !self.bounds.must.rows[predicate].contains(*row));
                fluents.extend(new.map(|row| Ground { predicate, row: row.clone() }));
            }
        }
        fluents
    }

    fn defined(&self) -> BTreeMap<Ground, BTreeSet<All>> {
        let mut defined: BTreeMap<Ground, BTreeSet<All>> =
            self.undecided(FluentKind::Defined).into_iter().map(|fluent| (fluent, BTreeSet::new())).collect();
        for rule in self.model.defined.iter().flat_map(|(_, rules)| rules) {
            self.model.solve(rule, self.bounds.view(), &mut |binding| {
                if let Some(fluent) = self.model.head(&rule.heads[0], binding)
                    && let Some(bodies) = defined.get_mut(&fluent)
                {
                    bodies.insert(
                        self.bounds.conditions(rule, binding, self.bounds.view()).into_iter().collect(),
                    );
                }
                false
            });
        }
        defined
    }

    fn goals(&self) -> Option<All> {
        let mut goals = All::new();
        for (term, truth) in self.model.goals() {
            let literal = (self.model.ground(&term)?, truth);
            if self.is_certain(&(literal.0.clone(), !truth)) {
                return None;
            }
            if !self.is_certain(&literal) {
                goals.insert(literal);
            }
        }
        Some(goals)
    }
}
