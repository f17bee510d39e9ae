//! States from known fluents and from actions: effects, derived fluents, and inertia.

use super::model::Model;
use super::refusal::Refusal;
use super::rule::{Binding, Rule, Test};
use super::state::{Ground, State};
use super::values::Row;
use crate::domain::{FluentKind, Kind};
use crate::term::Term;
use rustc_hash::FxHashMap as HashMap;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// By predicate: the rows that are true in exactly one of two states.
type Changes = BTreeMap<usize, BTreeSet<Row>>;

impl Model<'_> {
    /// The state with the given true and false fluents; all others follow from the domain.
    ///
    /// # Errors
    /// When laws contradict each other about a fluent.
    pub fn initial(&self, told: &[Term], told_not: &[Term]) -> Result<State, Refusal> {
        let mut state = self.empty();
        let mut fixed: HashMap<Ground, bool> = HashMap::default();
        for (terms, truth) in [(told, true), (told_not, false)] {
            for term in terms {
                if let Some(fluent) = self.ground(term) {
                    self.put(&mut state, &fluent, truth);
                    fixed.insert(fluent, truth);
                }
            }
        }
        self.settle(&mut state, &mut fixed, None)?;
        // A default applies unless the given fluents contradict it.
        let mut usual = Vec::new();
        for rule in &self.initially {
            self.solve(rule, &state, &mut |binding| {
                for head in &rule.heads {
                    usual.extend(self.head(head, binding).map(|fluent| (fluent, head.positive)));
                }
                false
            });
        }
        for (fluent, truth) in usual {
            let known = fixed.get(&fluent).copied();
            if known.is_none() {
                self.put(&mut state, &fluent, truth);
                fixed.insert(fluent, truth);
            }
        }
        self.settle(&mut state, &mut fixed, None)?;
        Ok(state)
    }

    /// The state in which exactly the given inertial fluents are true.
    ///
    /// # Errors
    /// As [`Model::initial`].
    pub fn resumed(&self, told: &[Term]) -> Result<State, Refusal> {
        let mut state = self.empty();
        let mut fixed: HashMap<Ground, bool> = HashMap::default();
        for fluent in told.iter().filter_map(|term| self.ground(term)) {
            self.put(&mut state, &fluent, true);
            fixed.insert(fluent, true);
        }
        self.settle(&mut state, &mut fixed, None)?;
        Ok(state)
    }

    /// The state after an action.
    ///
    /// # Errors
    /// When the action does not exist, when a law forbids it, or when laws contradict each other.
    pub fn after(&self, state: &State, action: &Term) -> Result<State, Refusal> {
        let ground = self.action(action)?;
        if let Some(reason) = self.prevented(state, &ground) {
            return Err(Refusal::Impossible(reason));
        }
        self.effects(state, &ground)
    }

    /// The state after an action whose conditions hold.
    fn effects(&self, state: &State, action: &Ground) -> Result<State, Refusal> {
        let mut fixed: HashMap<Ground, bool> = HashMap::default();
        let mut clash = None;
        for rule in &self.causal {
            self.solve_action(rule, state, action, &mut |binding| {
                for head in &rule.heads {
                    if let Some(fluent) = self.head(head, binding)
                        && fixed
                            .insert(fluent.clone(), head.positive)
                            .is_some_and(|other| other != head.positive)
                    {
                        clash = Some(fluent);
                    }
                }
                false
            });
        }
        if let Some(fluent) = clash {
            return Err(Refusal::Contradiction(self.text(&fluent)));
        }
        let mut next = state.clone();
        for (fluent, truth) in &fixed {
            self.put(&mut next, fluent, *truth);
        }
        self.settle(&mut next, &mut fixed, Some(state.clone()))?;
        Ok(next)
    }

    /// Derives the defined fluents and applies the state constraints. `since`: the settled state
    /// from which this one was made by changing some inertial fluents, if any.
    fn settle(
        &self,
        state: &mut State,
        fixed: &mut HashMap<Ground, bool>,
        since: Option<State>,
    ) -> Result<(), Refusal> {
        let mut disputed: Vec<&Rule> = Vec::new();
        let mut since = since.map(|before| {
            let changes = self.inertial_changes(&before, state);
            (before, changes)
        });
        loop {
            for (predicate, rules) in &self.defined {
                let needs = &self.depends[predicate];
                let by_rows = rules.iter().all(|rule| rule.is_local() && !rule.reads.contains(predicate));
                match &mut since {
                    Some((_, changes)) if changes.keys().all(|changed| !needs.contains(changed)) => {}
                    Some((before, changes)) if by_rows => {
                        let flipped = self.flipped(rules, before, state, changes);
                        if !flipped.is_empty() {
                            let rows = Rc::make_mut(&mut state.rows[*predicate]);
                            for row in &flipped {
                                if !rows.remove(row) {
                                    rows.insert(row.clone());
                                }
                            }
                            changes.insert(*predicate, flipped);
                        }
                    }
                    _ => {
                        let old = state.rows[*predicate].clone();
                        state.rows[*predicate] = Rc::new(self.derived(*predicate, rules, state));
                        if let Some((_, changes)) = &mut since
                            && old != state.rows[*predicate]
                        {
                            let flipped = old.symmetric_difference(&state.rows[*predicate]);
                            changes.insert(*predicate, flipped.cloned().collect());
                        }
                    }
                }
            }
            let settled = state.clone();
            for rule in &self.constraints {
                if let Some((_, changes)) = &since
                    && changes.keys().all(|changed| !rule.reads.contains(changed))
                {
                    continue;
                }
                let truth = rule.heads[0].positive;
                for fluent in self.concluded(rule, state, fixed) {
                    if fixed.get(&fluent).is_some_and(|known| *known != truth) {
                        disputed.push(rule);
                        continue;
                    }
                    self.put(state, &fluent, truth);
                    fixed.insert(fluent, truth);
                }
            }
            let changes = self.inertial_changes(&settled, state);
            if changes.is_empty() {
                // A law that was skipped during the changes must hold in the result.
                for rule in disputed {
                    let mut violated = None;
                    self.solve(rule, &*state, &mut |binding| {
                        let head = &rule.heads[0];
                        let fluent = self.head(head, binding);
                        violated = fluent.filter(|f| self.has(f.predicate, &f.row, state) != head.positive);
                        violated.is_some()
                    });
                    if let Some(fluent) = violated {
                        return Err(Refusal::Contradiction(self.text(&fluent)));
                    }
                }
                return Ok(());
            }
            since = Some((settled, changes));
        }
    }

    /// The inertial fluents that are true in exactly one of two states.
    fn inertial_changes(&self, before: &State, after: &State) -> Changes {
        let mut changes = Changes::new();
        for (predicate, (old, new)) in before.rows.iter().zip(&after.rows).enumerate() {
            if self.predicates[predicate].kind == Kind::Fluent(FluentKind::Inertial) && !Rc::ptr_eq(old, new)
            {
                let flipped: BTreeSet<Row> = old.symmetric_difference(new).cloned().collect();
                if !flipped.is_empty() {
                    changes.insert(predicate, flipped);
                }
            }
        }
        changes
    }

    /// All rows of a defined fluent.
    fn derived(&self, predicate: usize, rules: &[Rule], state: &mut State) -> BTreeSet<Row> {
        let recursive = rules.iter().any(|rule| rule.reads.contains(&predicate));
        if recursive {
            // The previous value must not support itself.
            state.rows[predicate] = Rc::default();
        }
        let mut rows = BTreeSet::new();
        loop {
            let known = rows.len();
            for rule in rules {
                self.solve(rule, &*state, &mut |binding| {
                    rows.extend(self.row(&rule.heads[0].arguments, binding));
                    false
                });
            }
            if !recursive || rows.len() == known {
                return rows;
            }
            state.rows[predicate] = Rc::new(rows.clone());
        }
    }

    /// The rows of a defined fluent that differ between two states, given the changed rows: a law
    /// loses or gains a conclusion only through one of these.
    fn flipped(&self, rules: &[Rule], before: &State, after: &State, changes: &Changes) -> BTreeSet<Row> {
        let predicate = rules[0].heads[0].predicate;
        let rows = |state: &State| {
            let mut rows = BTreeSet::new();
            for rule in rules {
                for (changed, flipped) in changes.iter().filter(|(changed, _)| rule.reads.contains(changed)) {
                    for row in flipped {
                        self.solve_with(rule, state, *changed, row, &mut |binding| {
                            rows.extend(self.row(&rule.heads[0].arguments, binding));
                            false
                        });
                    }
                }
            }
            rows
        };
        let old = &before.rows[predicate];
        let gained = rows(after).into_iter().filter(|row| !old.contains(row));
        let holds = |row: &Row| rules.iter().any(|rule| self.solve_head(rule, after, row, &mut |_| true));
        let lost = rows(before).into_iter().filter(|row| !holds(row));
        gained.chain(lost).collect()
    }

    /// The conclusions of a law between the fluents of one time. A conclusion that held before on
    /// the same grounds is not new; it may be exactly what has to change.
    fn concluded(&self, rule: &Rule, state: &State, fixed: &HashMap<Ground, bool>) -> Vec<Ground> {
        let mut concluded = Vec::new();
        let kind = |predicate: &usize| self.predicates[*predicate].kind;
        let inertial = rule.reads.iter().any(|read| kind(read) == Kind::Fluent(FluentKind::Inertial));
        let defined = rule.reads.iter().any(|read| kind(read) == Kind::Fluent(FluentKind::Defined));
        if inertial && !defined && rule.is_local() {
            // A new conclusion depends on something fixed by this transition.
            for fluent in fixed.keys() {
                self.solve_with(rule, state, fluent.predicate, &fluent.row, &mut |binding| {
                    concluded.extend(self.head(&rule.heads[0], binding));
                    false
                });
            }
        } else {
            self.solve(rule, state, &mut |binding| {
                if self.is_news(rule, binding, fixed) {
                    concluded.extend(self.head(&rule.heads[0], binding));
                }
                false
            });
        }
        concluded
    }

    /// Whether a conclusion depends on something changed by this transition, or on defined fluents.
    fn is_news(&self, rule: &Rule, binding: &Binding, fixed: &HashMap<Ground, bool>) -> bool {
        let mut inertial = false;
        for test in &rule.conditions {
            let Test::Literal { predicate, arguments, .. } = test else { continue };
            match self.predicates[*predicate].kind {
                Kind::Fluent(FluentKind::Inertial) => inertial = true,
                Kind::Fluent(FluentKind::Defined) => return true,
                _ => continue,
            }
            let fluent = self.row(arguments, binding).map(|row| Ground { predicate: *predicate, row });
            if fluent.is_some_and(|fluent| fixed.contains_key(&fluent)) {
                return true;
            }
        }
        !inertial
    }

    /// Sets a fluent's truth value; `false` when it had that value already.
    pub(crate) fn put(&self, state: &mut State, fluent: &Ground, truth: bool) -> bool {
        let rows = &mut state.rows[fluent.predicate];
        if rows.contains(&fluent.row) == truth {
            return false;
        }
        let rows = Rc::make_mut(rows);
        if truth { rows.insert(fluent.row.clone()) } else { rows.remove(&fluent.row) }
    }
}
