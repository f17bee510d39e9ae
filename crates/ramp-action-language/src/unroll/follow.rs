//! Consequences of a step: effects, inertia, laws between fluents, and defined fluents.

use super::program::{GroundRule, Literal};
use super::unrolled::{Sides, Unrolled};
use crate::domain::{FluentKind, Kind};
use crate::interpreter::{Ground, State, View};
use rustc_hash::FxHashMap as HashMap;
use std::collections::{BTreeMap, BTreeSet};

/// A law between the fluents of one time: its conclusion and its conditions.
type Link = (Ground, bool, Vec<(Ground, bool)>);

impl Unrolled<'_, '_> {
    /// The next time: direct effects, consequences, and inertia.
    pub(crate) fn follow(&mut self, caused: BTreeMap<Ground, Vec<(bool, Vec<Literal>)>>) {
        let model = self.model;
        let (mut may, mut must) = (self.may.clone(), self.must.clone());
        let mut changed = BTreeSet::new();
        for (fluent, causes) in &caused {
            for (truth, _) in causes {
                let new = if *truth {
                    model.put(&mut may, fluent, true)
                } else {
                    model.put(&mut must, fluent, false)
                };
                if new {
                    changed.insert(fluent.predicate);
                }
            }
        }
        self.relax(&mut may, &mut must, changed);
        let view = View { may: &may, must: &must };
        let open = |fluent: &Ground| self.in_state(fluent, &may) && !self.in_state(fluent, &must);

        // Laws between the fluents of one time, where something is undecided.
        let mut links: Vec<Link> = Vec::new();
        for rule in &model.constraints {
            let head = &rule.heads[0];
            model.solve(rule, view, &mut |binding| {
                if let Some(fluent) = model.head(head, binding).filter(open) {
                    links.push((fluent, head.positive, self.conditions(rule, binding, view)));
                }
                false
            });
        }
        // Fluents that this step can change get new atoms.
        let mut touched: BTreeSet<Ground> = caused.keys().filter(|fluent| open(fluent)).cloned().collect();
        let is_defined =
            |fluent: &Ground| model.predicates[fluent.predicate].kind == Kind::Fluent(FluentKind::Defined);
        loop {
            let known = touched.len();
            for (fluent, _, conditions) in &links {
                let new = |(other, _): &(Ground, bool)| is_defined(other) || touched.contains(other);
                if !touched.contains(fluent) && (conditions.is_empty() || conditions.iter().any(new)) {
                    touched.insert(fluent.clone());
                }
            }
            if touched.len() == known {
                break;
            }
        }
        let mut rules = Vec::new();
        let mut sides: HashMap<Ground, Sides> = HashMap::default();
        for (predicate, rows) in may.rows.iter().enumerate() {
            if model.predicates[predicate].kind != Kind::Fluent(FluentKind::Inertial) {
                continue;
            }
            for row in rows.iter().filter(|row| !must.rows[predicate].contains(*row)) {
                let fluent = Ground { predicate, row: row.clone() };
                let before = self.sides.get(&fluent).copied();
                let now = match before {
                    Some(before) if !touched.contains(&fluent) => before,
                    _ => {
                        let now = Sides { yes: self.atom(), no: self.atom() };
                        let rule = |head, body| GroundRule { choice: false, head, body };
                        // Other fluents persist.
                        let was = self.in_state(&fluent, &self.must);
                        if was || before.is_some() {
                            let body = before.map(|before| before.yes).into_iter().chain([-now.no]).collect();
                            rules.push(rule(Some(now.yes), body));
                        }
                        if !was {
                            let body = before.map(|before| before.no).into_iter().chain([-now.yes]).collect();
                            rules.push(rule(Some(now.no), body));
                        }
                        rules.push(rule(None, vec![now.yes, now.no]));
                        now
                    }
                };
                sides.insert(fluent, now);
            }
        }
        for (fluent, causes) in caused {
            if let Some(sides) = sides.get(&fluent) {
                for (truth, body) in causes {
                    let head = Some(if truth { sides.yes } else { sides.no });
                    rules.push(GroundRule { choice: false, head, body });
                }
            }
        }
        self.sides = sides;
        self.define(&may, &must, &mut rules);
        for (fluent, truth, conditions) in links {
            if touched.contains(&fluent) {
                let head = Some(self.literal(&fluent, truth));
                rules.push(GroundRule { choice: false, head, body: self.body(&conditions) });
            }
        }
        self.rules.append(&mut rules);
        (self.may, self.must) = (may, must);
    }

    /// The undecided defined fluents, with their laws.
    fn define(&mut self, may: &State, must: &State, rules: &mut Vec<GroundRule>) {
        let model = self.model;
        let view = View { may, must };
        let mut before = std::mem::take(&mut self.grounds);
        for (predicate, laws) in &model.defined {
            let rows = may.rows[*predicate].iter().filter(|row| !must.rows[*predicate].contains(*row));
            let open: Vec<Ground> =
                rows.map(|row| Ground { predicate: *predicate, row: row.clone() }).collect();
            if open.is_empty() {
                continue;
            }
            let recursive = laws.iter().any(|law| law.reads.contains(predicate));
            if recursive {
                for fluent in &open {
                    let yes = self.atom();
                    self.sides.insert(fluent.clone(), Sides { yes, no: -yes });
                }
            }
            let mut bodies: HashMap<Ground, BTreeSet<Vec<Literal>>> = HashMap::default();
            for law in laws {
                model.solve(law, view, &mut |binding| {
                    let fluent = model.head(&law.heads[0], binding);
                    if let Some(fluent) = fluent.filter(|fluent| !self.in_state(fluent, must)) {
                        let body = self.body(&self.conditions(law, binding, view));
                        bodies.entry(fluent).or_default().insert(body);
                    }
                    false
                });
            }
            for fluent in open {
                let own = bodies.remove(&fluent).unwrap_or_default();
                let mut only = own.iter().flatten();
                let yes = match (before.remove(&fluent), only.next(), only.next()) {
                    // With the same grounds as before it keeps its atom.
                    (Some((old, yes)), ..) if !recursive && old == own => yes,
                    // With a single ground it shares the ground's atom.
                    (_, Some(&ground), None) if !recursive && own.len() == 1 => ground,
                    _ => {
                        let yes = if recursive { self.literal(&fluent, true) } else { self.atom() };
                        let rule = |body: &Vec<Literal>| GroundRule {
                            choice: false,
                            head: Some(yes),
                            body: body.clone(),
                        };
                        rules.extend(own.iter().map(rule));
                        yes
                    }
                };
                self.sides.insert(fluent.clone(), Sides { yes, no: -yes });
                self.grounds.insert(fluent, (own, yes));
            }
        }
    }
}
