//! Plans of other planners, translated into the terms of the domain.

use super::error::PddlError;
use super::files::Pddl;
use crate::domain::{Domain, Kind, Leaf};
use crate::term::Term;
use std::collections::BTreeMap;

impl Pddl {
    /// The actions of a plan in the usual form, one `(action object …)` per line, in the terms of
    /// the rules.
    ///
    /// # Errors
    /// At the first line that is not an action of the domain with objects of the problem.
    pub fn read_plan(&self, domain: &Domain, text: &str) -> Result<Vec<Term>, PddlError> {
        let names: BTreeMap<&str, &str> =
            self.objects.iter().map(|(name, pddl)| (pddl.as_str(), name.as_str())).collect();
        let mut actions = Vec::new();
        for (number, line) in text.lines().enumerate() {
            let line = line.split(';').next().unwrap_or_default().trim().to_lowercase();
            if line.is_empty() {
                continue;
            }
            let bad = |why: String| PddlError::Plan { line: number + 1, found: line.clone(), why };
            // Some planners write the time before and the duration after the action.
            let inside = line.split_once('(').and_then(|(_, rest)| Some(rest.split_once(')')?.0));
            let inside = inside.ok_or_else(|| bad("expected `(action object …)`".to_string()))?;
            let mut words = inside.split_whitespace();
            let name = words.next().unwrap_or_default();
            let sorts = domain
                .predicates
                .get(name)
                .filter(|predicate| matches!(predicate.kind, Kind::Action { .. }))
                .map(|predicate| &predicate.sorts)
                .ok_or_else(|| bad(format!("the domain has no action `{name}`")))?;
            let mut arguments = Vec::new();
            for (sort, word) in sorts.iter().zip(words.by_ref()) {
                let term = term_of(domain, sort, word, &names, &|sort, object| self.is_of(sort, object));
                arguments.push(term.ok_or_else(|| bad(format!("`{word}` is not of the sort `{sort}`")))?);
            }
            if arguments.len() != sorts.len() || words.next().is_some() {
                return Err(bad(format!("`{name}` has {} arguments", sorts.len())));
            }
            actions.push(Term::Function(name.to_string(), arguments));
        }
        Ok(actions)
    }

    /// Whether an object is declared with a type in the problem.
    fn is_of(&self, sort: &str, object: &str) -> bool {
        let suffix = format!(" - {sort}");
        self.problem
            .lines()
            .filter_map(|line| line.strip_suffix(&suffix))
            .any(|names| names.split_whitespace().any(|name| name == object))
    }
}

/// An object in the terms of the rules, for an argument of the given sort.
fn term_of(
    domain: &Domain,
    sort: &str,
    word: &str,
    names: &BTreeMap<&str, &str>,
    is_of: &dyn Fn(&str, &str) -> bool,
) -> Option<Term> {
    domain.sorts.get(sort)?.leaves.iter().find_map(|leaf| match leaf {
        Leaf::Number => None,
        Leaf::Constant(constant) => (constant == word).then(|| Term::new(constant, [])),
        Leaf::Open(open) if is_of(open, word) => names.get(word).map(|name| Term::from(*name)),
        Leaf::Open(_) => None,
        Leaf::Function(function) => {
            let [inner] = &domain.functions.get(function)?[..] else { return None };
            Some(Term::new(function, [term_of(domain, inner, word, names, is_of)?]))
        }
    })
}
