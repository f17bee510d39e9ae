//! Shapes of problems: problems that differ only in names, or in numbers of the same order, are
//! solved once.

use ramp_action_language::{Domain, Term};
use std::collections::{BTreeSet, HashMap};

/// The names and numbers visible to the rules of a domain.
pub(crate) struct Sight {
    /// Names in the rules: they are not interchangeable.
    pub(crate) known: BTreeSet<String>,
    /// Whether the rules only compare numbers.
    order: bool,
}

impl Sight {
    /// Of a domain; `also` are further names that are not interchangeable.
    pub(crate) fn of(domain: &Domain, also: impl IntoIterator<Item = String>) -> Sight {
        let mut known = domain.quoted();
        known.extend(also);
        Sight { known, order: domain.only_compares_numbers() }
    }
}

/// Facts with every name replaced by its index in order of appearance, and every number by its
/// rank.
pub(crate) struct Shape {
    /// The facts without names; equal for problems of the same shape.
    pub(crate) facts: Vec<Term>,
    /// The names, by number.
    names: Vec<String>,
    /// The numbers, by rank; empty where the rules calculate with numbers.
    numbers: Vec<i64>,
}

impl Shape {
    /// Removes the interchangeable names and numbers from some facts.
    pub(crate) fn of(facts: &[Term], sight: &Sight) -> Shape {
        let mut names: Vec<String> = Vec::new();
        let mut known: HashMap<String, String> = HashMap::new();
        let mut number = |text: &str| {
            if sight.known.contains(text) {
                return text.to_string();
            }
            if let Some(number) = known.get(text) {
                return number.clone();
            }
            // Zero-padded, so that the rules sort them in order of appearance.
            let number = format!("{:06}", names.len());
            names.push(text.to_string());
            known.insert(text.to_string(), number.clone());
            number
        };
        let mut facts: Vec<Term> = facts.iter().map(|fact| fact.with_texts(&mut number)).collect();
        let numbers: BTreeSet<i64> = match sight.order {
            true => facts.iter().flat_map(Term::numbers).collect(),
            false => BTreeSet::new(),
        };
        let numbers = Vec::from_iter(numbers);
        if sight.order {
            let mut rank = |number: i64| numbers.binary_search(&number).map_or(number, |rank| rank as i64);
            facts = facts.iter().map(|fact| fact.with_numbers(&mut rank)).collect();
        }
        Shape { facts, names, numbers }
    }

    /// Puts names and numbers back into an answer; other texts stay.
    pub(crate) fn name(&self, term: &Term) -> Term {
        let named = term.with_texts(&mut |text| {
            let name = text.parse::<usize>().ok().and_then(|number| self.names.get(number));
            name.cloned().unwrap_or_else(|| text.to_string())
        });
        named.with_numbers(&mut |rank| {
            let number = usize::try_from(rank).ok().and_then(|rank| self.numbers.get(rank));
            number.copied().unwrap_or(rank)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sight(order: bool) -> Sight {
        Sight { known: BTreeSet::new(), order }
    }

    #[test]
    fn problems_with_other_names_have_the_same_shape() {
        let facts = |c: &str, b: &str| {
            [Term::new("pinned", [c.into()]), Term::new("at", [Term::new("beam", [b.into()]), c.into()])]
        };
        let (first, second) =
            (Shape::of(&facts("C1", "b4"), &sight(false)), Shape::of(&facts("b4", "\""), &sight(false)));
        assert_eq!(first.facts, second.facts);
        assert_ne!(first.facts, Shape::of(&facts("C1", "C1"), &sight(false)).facts);
        // Only the order of the numbers matters when the rules only compare them.
        let far = |a: i64, b: i64| [a, b].map(|number| Term::new("far", [Term::Number(number)]));
        let of = |order, a, b| Shape::of(&far(a, b), &sight(order));
        assert_eq!(of(true, 70, 9).facts, of(true, 140, -3).facts);
        assert_ne!(of(true, 70, 9).facts, of(true, 9, 70).facts);
        assert_ne!(of(true, 70, 9).facts, of(true, 70, 70).facts);
        assert_ne!(of(false, 70, 9).facts, of(false, 140, 9).facts);
        let shape = of(true, 70, 9);
        assert_eq!(shape.facts.iter().map(|fact| shape.name(fact)).collect::<Vec<_>>(), far(70, 9));
        for (fact, shaped) in facts("b4", "\"").iter().zip(&second.facts) {
            assert_eq!(*fact, second.name(shaped));
        }
    }
}
