//! States from what is told, and states from actions: effects, what follows from them, and what stays as it is.

use super::model::Model;
use super::refusal::Refusal;
use super::rule::{Binding, Rule, Test};
use super::state::{Ground, State};
use crate::domain::{FluentKind, Kind};
use crate::term::Term;
use rustc_hash::FxHashMap as HashMap;
use std::collections::BTreeSet;
use std::rc::Rc;

impl Model<'_> {
    /// The state in which some fluents are told to be true and others false; the rest is as the domain says.
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
        // The rule holds where nothing that is known says otherwise.
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

    /// The state in which exactly these inertial fluents are true.
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
    /// When there is no such action, when a law forbids it, or when laws contradict each other.
    pub fn after(&self, state: &State, action: &Term) -> Result<State, Refusal> {
        let ground = self.action(action)?;
        if let Some(reason) = self.prevented(state, &ground) {
            return Err(Refusal::Impossible(reason));
        }
        self.effects(state, &ground)
    }

    /// The state after an action whose conditions are known to hold.
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
        let mut changed = BTreeSet::new();
        for (fluent, truth) in &fixed {
            if self.put(&mut next, fluent, *truth) {
                changed.insert(fluent.predicate);
            }
        }
        self.settle(&mut next, &mut fixed, Some(changed))?;
        Ok(next)
    }

    /// Makes the defined fluents and the state constraints true. `changed`: inertial fluents that changed since
    /// they were; `None` when nothing is known of that.
    fn settle(
        &self,
        state: &mut State,
        fixed: &mut HashMap<Ground, bool>,
        mut changed: Option<BTreeSet<usize>>,
    ) -> Result<(), Refusal> {
        let mut disputed: Vec<&Rule> = Vec::new();
        loop {
            let mut dirty = changed.clone();
            for (predicate, rules) in &self.defined {
                let needs = &self.depends[predicate];
                if changed.as_ref().is_some_and(|changed| changed.is_disjoint(needs)) {
                    continue;
                }
                let before = state.rows[*predicate].clone();
                let recursive = rules.iter().any(|rule| rule.reads.contains(predicate));
                if recursive {
                    // What was true before is no reason for itself.
                    state.rows[*predicate] = Rc::default();
                }
                let mut rows = BTreeSet::new();
                loop {
                    let known = rows.len();
                    for rule in rules {
                        let mut found = Vec::new();
                        self.solve(rule, &*state, &mut |binding| {
                            found.extend(self.row(&rule.heads[0].arguments, binding));
                            false
                        });
                        rows.extend(found);
                    }
                    if !recursive || rows.len() == known {
                        break;
                    }
                    state.rows[*predicate] = Rc::new(rows.clone());
                }
                if *before == rows {
                    state.rows[*predicate] = before;
                } else {
                    state.rows[*predicate] = Rc::new(rows);
                    if let Some(dirty) = &mut dirty {
                        dirty.insert(*predicate);
                    }
                }
            }
            let mut again = BTreeSet::new();
            for rule in &self.constraints {
                if dirty.as_ref().is_some_and(|dirty| dirty.is_disjoint(&rule.reads)) {
                    continue;
                }
                let mut concluded = Vec::new();
                self.solve(rule, &*state, &mut |binding| {
                    // What held before on the same grounds is no news; it may be just what has to give way.
                    if self.is_news(rule, binding, fixed) {
                        concluded.extend(self.head(&rule.heads[0], binding));
                    }
                    false
                });
                let truth = rule.heads[0].positive;
                for fluent in concluded {
                    if fixed.get(&fluent).is_some_and(|known| *known != truth) {
                        disputed.push(rule);
                        continue;
                    }
                    if self.put(state, &fluent, truth) {
                        again.insert(fluent.predicate);
                    }
                    fixed.insert(fluent, truth);
                }
            }
            if again.is_empty() {
                // A law that had no say while things changed has one in the end.
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
            changed = Some(again);
        }
    }

    /// Rests a conclusion on something that this transition changed, or on defined fluents?
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

    /// Makes a fluent true or false; `false` when it was so.
    pub(crate) fn put(&self, state: &mut State, fluent: &Ground, truth: bool) -> bool {
        let rows = &mut state.rows[fluent.predicate];
        if rows.contains(&fluent.row) == truth {
            return false;
        }
        let rows = Rc::make_mut(rows);
        if truth { rows.insert(fluent.row.clone()) } else { rows.remove(&fluent.row) }
    }
}
