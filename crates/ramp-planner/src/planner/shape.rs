//! Problems that differ in nothing but names, or in numbers of the same order, have the same shape, and are solved once.

use ramp_action_language::{Domain, Term};
use std::collections::{BTreeSet, HashMap};

/// What the rules of a domain see of names and numbers.
pub(crate) struct Sight {
    /// Names that the rules know themselves: they are not like others.
    pub(crate) known: BTreeSet<String>,
    /// Whether the rules do nothing with numbers but compare them.
    order: bool,
}

impl Sight {
    /// Of a domain; `also` are names that are not like others, either.
    pub(crate) fn of(domain: &Domain, also: impl IntoIterator<Item = String>) -> Sight {
        let mut known = domain.quoted();
        known.extend(also);
        Sight { known, order: domain.only_compares_numbers() }
    }
}

/// Facts in which every name is replaced by its number in the order of appearance, and every number by its rank.
pub(crate) struct Shape {
    /// The facts without names; equal for problems of the same shape.
    pub(crate) facts: Vec<Term>,
    /// The names, by number.
    names: Vec<String>,
    /// The numbers, by rank; none where the rules do more with numbers than compare them.
    numbers: Vec<i64>,
}

impl Shape {
    /// Takes the names and numbers out of some facts, as far as the rules do not see them.
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
            // Of one width, so that the rules put them in the order of appearance.
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
        // Numbers count by their order alone, where the rules do nothing but compare them.
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
