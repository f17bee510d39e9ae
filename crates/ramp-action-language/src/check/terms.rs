//! Atoms and terms: each argument must be of its sort, and narrows down the sorts of its variables.

use super::checker::Checker;
use crate::ast::{Atom, Expression, Name, Shape, Span};
use crate::domain::{FluentKind, Kind, Leaf, NUMBER, Predicate};
use crate::parse::KEYWORDS;
use crate::problem::{LanguageError, LanguageProblem};
use ramp_source::nearest;
use std::collections::{BTreeMap, BTreeSet};

/// The position of an atom, which determines the allowed kinds.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Role {
    StaticBody,
    Body,
    Action,
    Effect,
    Fluent,
    Head,
}

/// Knowledge about the variables of a law.
#[derive(Default)]
pub(crate) struct Variables {
    pub(crate) sorts: BTreeMap<String, String>,
    /// Variables bound by a positive literal.
    pub(crate) bound: BTreeSet<String>,
}

/// Records the variables bound by a positive literal: those that occur in it directly, not inside a
/// sum.
pub(crate) fn bind(terms: &[Expression], variables: &mut Variables) {
    for term in terms {
        match &term.what {
            Shape::Variable(name) => {
                variables.bound.insert(name.clone());
            }
            Shape::Function(_, arguments) => bind(arguments, variables),
            Shape::Number(_) | Shape::Quoted(_) | Shape::Sum(..) => {}
        }
    }
}

impl Checker<'_> {
    /// The terms of a comparison outside every atom: functions and sums still narrow down their
    /// variables.
    pub(crate) fn side(&self, term: &Expression, variables: &mut Variables) -> Result<(), LanguageError> {
        match &term.what {
            Shape::Sum(left, _, right) => {
                self.term(left, NUMBER, variables)?;
                self.term(right, NUMBER, variables)
            }
            Shape::Function(name, arguments) if !arguments.is_empty() => {
                match self.domain.functions.get(name) {
                    Some(sorts) => self.arguments(name, arguments, sorts, &term.span, variables),
                    None => {
                        let name = Name { text: name.clone(), span: term.span.clone() };
                        self.unknown("function", &name, self.domain.functions.keys())
                    }
                }
            }
            Shape::Function(name, _) => {
                let constant = Leaf::Constant(name.clone());
                if self.domain.sorts.values().any(|sort| sort.leaves.contains(&constant)) {
                    return Ok(());
                }
                let name = Name { text: name.clone(), span: term.span.clone() };
                self.unknown("constant", &name, std::iter::empty())
            }
            Shape::Variable(_) | Shape::Number(_) | Shape::Quoted(_) => Ok(()),
        }
    }

    pub(crate) fn atom(
        &self,
        atom: &Atom,
        role: Role,
        variables: &mut Variables,
    ) -> Result<(), LanguageError> {
        let name = &atom.name.text;
        let Some(predicate) = self.domain.predicates.get(name) else {
            let fits = |predicate: &Predicate| match role {
                Role::Action => matches!(predicate.kind, Kind::Action { .. }),
                Role::Effect | Role::Fluent => matches!(predicate.kind, Kind::Fluent(_)),
                _ => !matches!(predicate.kind, Kind::Action { .. }),
            };
            let kind = match role {
                Role::Action => "action",
                Role::Effect | Role::Fluent => "fluent",
                Role::StaticBody => "static",
                Role::Body | Role::Head => "static or fluent",
            };
            let names = self.domain.predicates.iter().filter(|(_, p)| fits(p)).map(|(name, _)| name);
            // A misspelt keyword at the beginning of a statement looks like a head.
            let keywords: Vec<String> = KEYWORDS.map(str::to_string).to_vec();
            return self.unknown(kind, &atom.name, names.chain(keywords.iter()));
        };
        let expected = match (role, predicate.kind) {
            (Role::Action, Kind::Action { .. })
            | (Role::Effect, Kind::Fluent(FluentKind::Inertial))
            | (Role::Fluent, Kind::Fluent(_))
            | (Role::StaticBody, Kind::Static)
            | (Role::Body | Role::Head, Kind::Static | Kind::Fluent(_)) => None,
            (Role::Action, _) => Some("an action"),
            (Role::Effect, _) => Some("an inertial fluent"),
            (Role::Fluent, _) => Some("a fluent"),
            (Role::StaticBody, _) => Some("a static"),
            (Role::Body | Role::Head, _) => Some("a static or a fluent"),
        };
        if let Some(expected) = expected {
            let found = predicate.kind.describe();
            return self.fault(LanguageProblem::Kind { name: name.clone(), found, expected }, &atom.span);
        }
        self.arguments(name, &atom.arguments, &predicate.sorts, &atom.span, variables)
    }

    /// The head of a bridge law: a fluent of the coarse domain.
    pub(crate) fn bridge(&self, atom: &Atom, variables: &mut Variables) -> Result<(), LanguageError> {
        let coarse = self.coarse.map(|coarse| &coarse.predicates);
        let fluents = |p: &&Predicate| matches!(p.kind, Kind::Fluent(_));
        match coarse.and_then(|coarse| coarse.get(&atom.name.text)).filter(fluents) {
            Some(fluent) => {
                self.arguments(&atom.name.text, &atom.arguments, &fluent.sorts, &atom.span, variables)
            }
            None => {
                let names = coarse.into_iter().flatten().filter(|(_, p)| fluents(p)).map(|(name, _)| name);
                self.unknown("coarse fluent", &atom.name, names)
            }
        }
    }

    fn arguments(
        &self,
        name: &str,
        arguments: &[Expression],
        sorts: &[String],
        span: &Span,
        variables: &mut Variables,
    ) -> Result<(), LanguageError> {
        if arguments.len() != sorts.len() {
            let (found, expected) = (arguments.len(), sorts.len());
            return self.fault(LanguageProblem::Arguments { name: name.to_string(), found, expected }, span);
        }
        arguments.iter().zip(sorts).try_for_each(|(term, sort)| self.term(term, sort, variables))
    }

    /// Checks a term where a sort is expected.
    fn term(&self, term: &Expression, sort: &str, variables: &mut Variables) -> Result<(), LanguageError> {
        let leaves = &self.domain.sorts[sort].leaves;
        let fits = match &term.what {
            Shape::Variable(variable) => {
                let sorts = &mut variables.sorts;
                match sorts.get(variable) {
                    Some(known) if self.domain.within(known, sort) => {}
                    Some(known) if !self.domain.within(sort, known) => {
                        let problem = LanguageProblem::Clash {
                            variable: variable.clone(),
                            first: known.clone(),
                            second: sort.to_string(),
                        };
                        return self.fault(problem, &term.span);
                    }
                    _ => {
                        sorts.insert(variable.clone(), sort.to_string());
                    }
                }
                true
            }
            Shape::Number(_) => leaves.contains(&Leaf::Number),
            // The objects are known only with a problem.
            Shape::Quoted(_) => leaves.iter().any(|leaf| matches!(leaf, Leaf::Open(_))),
            Shape::Function(name, arguments) if arguments.is_empty() => {
                leaves.contains(&Leaf::Constant(name.clone()))
            }
            Shape::Function(name, arguments) => {
                if leaves.contains(&Leaf::Function(name.clone())) {
                    let sorts = &self.domain.functions[name];
                    return self.arguments(name, arguments, sorts, &term.span, variables);
                }
                false
            }
            Shape::Sum(left, _, right) => {
                if leaves.contains(&Leaf::Number) {
                    self.term(left, NUMBER, variables)?;
                    return self.term(right, NUMBER, variables);
                }
                false
            }
        };
        if fits {
            return Ok(());
        }
        let text = self.domain.file.text().get(term.span.clone()).unwrap_or_default();
        let names = leaves.iter().filter_map(|leaf| match leaf {
            Leaf::Constant(name) | Leaf::Function(name) => Some(name.as_str()),
            _ => None,
        });
        let head = match &term.what {
            Shape::Function(name, _) => name.as_str(),
            _ => text,
        };
        let nearest = nearest(head, names).map(str::to_string);
        let problem = LanguageProblem::Sort { term: shorten(text), sort: sort.to_string(), nearest };
        self.fault(problem, &term.span)
    }
}

/// A term cut to the length of a message.
fn shorten(text: &str) -> String {
    let mut short: String = text.chars().take(40).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}
