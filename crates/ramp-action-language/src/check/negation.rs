//! Stratification: no static and no fluent is defined by its own negation, directly or through
//! others.

use super::checker::Checker;
use crate::ast::{Condition, Law, Literal};
use crate::domain::{FluentKind, Kind};
use crate::problem::{LanguageError, LanguageProblem};
use std::collections::{BTreeMap, BTreeSet};

impl Checker<'_> {
    /// Checks that no defined predicate depends on its own negation, directly or through others.
    pub(crate) fn stratified(&self) -> Result<(), LanguageError> {
        let defined = |name: &str| {
            matches!(self.domain.kind(name), Some(Kind::Static | Kind::Fluent(FluentKind::Defined)))
        };
        let mut needs: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        let mut negations: Vec<(&str, &Literal)> = Vec::new();
        for law in &self.domain.laws {
            let Law::Holds { head } = &law.law else { continue };
            let name = head.atom.name.text.as_str();
            if !defined(name) {
                continue;
            }
            for condition in &law.body {
                if let Condition::Literal(literal) = condition
                    && defined(&literal.atom.name.text)
                {
                    needs.entry(name).or_default().insert(&literal.atom.name.text);
                    if !literal.positive {
                        negations.push((name, literal));
                    }
                }
            }
        }
        for (name, literal) in negations {
            let mut reached = BTreeSet::new();
            let mut open = vec![literal.atom.name.text.as_str()];
            while let Some(next) = open.pop() {
                if next == name {
                    return self
                        .fault(LanguageProblem::Negation { name: name.to_string() }, &literal.atom.span);
                }
                if reached.insert(next) {
                    open.extend(needs.get(next).into_iter().flatten());
                }
            }
        }
        Ok(())
    }
}
