//! Problems that differ in nothing but names have the same shape, and are solved once.

use ramp_action_language::Term;
use std::collections::{BTreeSet, HashMap};

/// Facts in which every name is replaced by its number in the order of appearance.
pub(crate) struct Shape {
    /// The facts without names; equal for problems of the same shape.
    pub(crate) facts: Vec<Term>,
    /// The names, by number.
    names: Vec<String>,
}

impl Shape {
    /// Takes the names out of some facts, but for those that the rules know themselves.
    pub(crate) fn of(facts: &[Term], fixed: &BTreeSet<String>) -> Shape {
        let mut names: Vec<String> = Vec::new();
        let mut numbers: HashMap<String, String> = HashMap::new();
        let mut number = |text: &str| {
            if fixed.contains(text) {
                return text.to_string();
            }
            if let Some(number) = numbers.get(text) {
                return number.clone();
            }
            // Of one width, so that the rules put them in the order of appearance.
            let number = format!("{:06}", names.len());
            names.push(text.to_string());
            numbers.insert(text.to_string(), number.clone());
            number
        };
        let facts = facts.iter().map(|fact| fact.with_texts(&mut number)).collect();
        Shape { facts, names }
    }

    /// Puts the names back into an answer; other texts stay.
    pub(crate) fn name(&self, term: &Term) -> Term {
        term.with_texts(&mut |text| {
            let name = text.parse::<usize>().ok().and_then(|number| self.names.get(number));
            name.cloned().unwrap_or_else(|| text.to_string())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn problems_with_other_names_have_the_same_shape() {
        let facts = |c: &str, b: &str| {
            [Term::new("pinned", [c.into()]), Term::new("at", [Term::new("beam", [b.into()]), c.into()])]
        };
        let (first, second) = (
            Shape::of(&facts("C1", "b4"), &BTreeSet::new()),
            Shape::of(&facts("b4", "\""), &BTreeSet::new()),
        );
        assert_eq!(first.facts, second.facts);
        assert_ne!(first.facts, Shape::of(&facts("C1", "C1"), &BTreeSet::new()).facts);
        for (fact, shaped) in facts("b4", "\"").iter().zip(&second.facts) {
            assert_eq!(*fact, second.name(shaped));
        }
    }
}
