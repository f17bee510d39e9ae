//! Bounds on a state: the upper bound grows and the lower bound shrinks until the laws add nothing.

use super::unrolled::Unrolled;
use crate::interpreter::{Row, Rule, State, View};
use std::collections::BTreeSet;
use std::rc::Rc;

impl Unrolled<'_, '_> {
    /// Widens the upper bound and narrows the lower bound until the laws between fluents add
    /// nothing. `changed`: the inertial fluents whose bounds are known to be wider than before.
    pub(crate) fn relax(&self, may: &mut State, must: &mut State, mut changed: BTreeSet<usize>) {
        let model = self.model;
        while !changed.is_empty() {
            let mut dirty = changed.clone();
            for (predicate, laws) in &model.defined {
                if changed.is_disjoint(&model.depends[predicate]) {
                    continue;
                }
                let possible = self.derived(*predicate, laws, may, must, true);
                let new = possible != *may.rows[*predicate];
                may.rows[*predicate] = Rc::new(possible);
                let certain = self.derived(*predicate, laws, may, must, false);
                if new || certain != *must.rows[*predicate] {
                    dirty.insert(*predicate);
                }
                must.rows[*predicate] = Rc::new(certain);
            }
            let mut again = BTreeSet::new();
            for rule in &model.constraints {
                if dirty.is_disjoint(&rule.reads) {
                    continue;
                }
                let head = &rule.heads[0];
                let mut concluded = Vec::new();
                model.solve(rule, View { may, must }, &mut |binding| {
                    concluded.extend(model.head(head, binding));
                    false
                });
                for fluent in concluded {
                    let new = if head.positive {
                        model.put(may, &fluent, true)
                    } else {
                        model.put(must, &fluent, false)
                    };
                    if new {
                        again.insert(fluent.predicate);
                    }
                }
            }
            changed = again;
        }
    }

    /// The rows of a defined fluent in the upper or the lower bound.
    fn derived(
        &self,
        predicate: usize,
        laws: &[Rule],
        may: &mut State,
        must: &mut State,
        possible: bool,
    ) -> BTreeSet<Row> {
        let recursive = laws.iter().any(|law| law.reads.contains(&predicate));
        let mut rows = BTreeSet::new();
        loop {
            if recursive {
                // The previous value must not support itself.
                let state = if possible { &mut *may } else { &mut *must };
                state.rows[predicate] = Rc::new(rows.clone());
            }
            let known = rows.len();
            let view = if possible { View { may, must } } else { View { may: must, must: may } };
            for law in laws {
                self.model.solve(law, view, &mut |binding| {
                    rows.extend(self.model.row(&law.heads[0].arguments, binding));
                    false
                });
            }
            if !recursive || rows.len() == known {
                return rows;
            }
        }
    }
}
