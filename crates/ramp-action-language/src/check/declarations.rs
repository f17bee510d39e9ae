//! Declarations: sorts with their parts, functions, and the signatures of statics, fluents and
//! actions.

use super::checker::Checker;
use crate::ast::{Name, SortPart, Span, Statement};
use crate::domain::{FluentKind, Kind, Leaf, NUMBER, Predicate, Sort};
use crate::problem::{LanguageError, LanguageProblem};
use ramp_source::Fault;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Names reserved for the translation.
const RESERVED: [&str; 16] = [
    NUMBER,
    "resumed",
    "active",
    "holds",
    "occurs",
    "query",
    "told",
    "told_not",
    "final",
    "final_not",
    "avoid",
    "event",
    "failed",
    "happened",
    "observed",
    "observed_not",
];

impl Checker<'_> {
    pub(crate) fn declare(&mut self, statements: &[Statement]) -> Result<(), LanguageError> {
        let number = Sort { leaves: BTreeSet::from([Leaf::Number]) };
        self.domain.sorts.insert(NUMBER.to_string(), number);
        let mut parts: BTreeMap<&str, (&Name, &Option<Vec<SortPart>>)> = BTreeMap::new();
        let mut places: HashMap<String, Span> = HashMap::new();
        for statement in statements {
            let name = match statement {
                Statement::Sort { name, .. }
                | Statement::Static { name, .. }
                | Statement::Fluent { name, .. }
                | Statement::Action { name, .. } => name,
                Statement::Law { .. } => continue,
            };
            let taken = RESERVED.contains(&name.text.as_str())
                || self.domain.sorts.contains_key(&name.text)
                || self.domain.predicates.contains_key(&name.text);
            let before = places.insert(name.text.clone(), name.span.clone());
            if taken || before.is_some() {
                let problem = LanguageProblem::Twice { name: name.text.clone() };
                let fault = Fault::new(problem, self.domain.file.place(name.span.clone()));
                return Err(match before {
                    Some(span) => fault.also(span, "first here"),
                    None => fault,
                });
            }
            if let Statement::Sort { name, parts: of } = statement {
                parts.insert(&name.text, (name, of));
            }
        }
        for name in parts.keys().copied().collect::<Vec<_>>() {
            self.sort(name, &parts, &mut Vec::new())?;
        }
        for (_, of) in parts.values() {
            for part in of.iter().flatten() {
                if let SortPart::Function(name, sorts) = part {
                    self.known_sorts(sorts)?;
                    let sorts: Vec<String> = sorts.iter().map(|sort| sort.text.clone()).collect();
                    match self.domain.functions.insert(name.text.clone(), sorts.clone()) {
                        Some(other) if other != sorts => {
                            return self
                                .fault(LanguageProblem::Twice { name: name.text.clone() }, &name.span);
                        }
                        _ => {}
                    }
                }
            }
        }
        for statement in statements {
            let (name, sorts, kind) = match statement {
                Statement::Static { name, sorts } => (name, sorts, Kind::Static),
                Statement::Fluent { name, sorts, inertial } => {
                    let kind = if *inertial { FluentKind::Inertial } else { FluentKind::Defined };
                    (name, sorts, Kind::Fluent(kind))
                }
                Statement::Action { name, sorts, exogenous } => {
                    (name, sorts, Kind::Action { exogenous: *exogenous })
                }
                Statement::Sort { .. } | Statement::Law { .. } => continue,
            };
            self.known_sorts(sorts)?;
            let numbers = matches!(kind, Kind::Action { .. } | Kind::Fluent(FluentKind::Inertial));
            if let Some(sort) = sorts.iter().find(|sort| numbers && sort.text == NUMBER) {
                // The numbers are too many to enumerate.
                let problem = LanguageProblem::Kind {
                    name: NUMBER.to_string(),
                    found: "a sort without an end",
                    expected: "a sort of objects",
                };
                return self.fault(problem, &sort.span);
            }
            let sorts = sorts.iter().map(|sort| sort.text.clone()).collect();
            self.domain.predicates.insert(name.text.clone(), Predicate { kind, sorts });
        }
        Ok(())
    }

    fn known_sorts(&self, sorts: &[Name]) -> Result<(), LanguageError> {
        match sorts.iter().find(|sort| !self.domain.sorts.contains_key(&sort.text)) {
            Some(sort) => self.unknown("sort", sort, self.domain.sorts.keys()),
            None => Ok(()),
        }
    }

    /// Finds the leaves of a sort, recursively.
    fn sort(
        &mut self,
        name: &str,
        parts: &BTreeMap<&str, (&Name, &Option<Vec<SortPart>>)>,
        within: &mut Vec<String>,
    ) -> Result<(), LanguageError> {
        if self.domain.sorts.contains_key(name) {
            return Ok(());
        }
        let Some((place, of)) = parts.get(name) else { return Ok(()) };
        // A chain of sorts as long as a file would overflow the stack.
        if within.len() > 64 || within.iter().any(|outer| outer == name) {
            return self.fault(LanguageProblem::Circle { name: name.to_string() }, &place.span);
        }
        within.push(name.to_string());
        let mut leaves = BTreeSet::new();
        match of {
            None => {
                leaves.insert(Leaf::Open(name.to_string()));
            }
            Some(of) => {
                for part in of {
                    match part {
                        SortPart::Constant(constant) => {
                            leaves.insert(Leaf::Constant(constant.text.clone()));
                        }
                        SortPart::Function(function, _) => {
                            leaves.insert(Leaf::Function(function.text.clone()));
                        }
                        SortPart::Sort(inner) => {
                            self.sort(&inner.text, parts, within)?;
                            match self.domain.sorts.get(&inner.text) {
                                Some(sort) => leaves.extend(sort.leaves.iter().cloned()),
                                None => {
                                    let names: Vec<String> =
                                        parts.keys().map(|name| name.to_string()).collect();
                                    return self.unknown("sort", inner, names.iter());
                                }
                            }
                        }
                    }
                }
            }
        }
        within.pop();
        self.domain.sorts.insert(name.to_string(), Sort { leaves });
        Ok(())
    }
}
