//! Facts indexed by the names in them, to select those of a small part of a large goal.

use ramp_action_language::Term;
use std::collections::{BTreeSet, HashMap};

/// Facts, indexed by their names.
pub(crate) struct Facts {
    pub(crate) all: Vec<Term>,
    /// The names, by number.
    numbers: HashMap<String, usize>,
    /// By name: the facts that contain it, in order.
    of: Vec<Vec<usize>>,
    /// By fact: its names.
    names: Vec<Vec<usize>>,
    /// Facts without any name.
    nameless: Vec<usize>,
}

impl Facts {
    /// Facts with their index.
    pub(crate) fn new(all: Vec<Term>) -> Facts {
        let mut facts =
            Facts { all, numbers: HashMap::new(), of: Vec::new(), names: Vec::new(), nameless: Vec::new() };
        for (index, fact) in facts.all.iter().enumerate() {
            let texts: BTreeSet<&str> = fact.texts().into_iter().collect();
            if texts.is_empty() {
                facts.nameless.push(index);
            }
            let mut names = Vec::new();
            for text in texts {
                let next = facts.numbers.len();
                let number = *facts.numbers.entry(text.to_string()).or_insert(next);
                if number == next {
                    facts.of.push(Vec::new());
                }
                facts.of[number].push(index);
                names.push(number);
            }
            facts.names.push(names);
        }
        facts
    }

    /// The facts that name only these objects, in order; without `names`, all.
    pub(crate) fn about(&self, names: Option<&BTreeSet<String>>) -> impl Iterator<Item = &Term> {
        let picked = match names {
            None => (0..self.all.len()).collect(),
            Some(names) => {
                let mut wanted = vec![false; self.of.len()];
                let numbers: Vec<usize> =
                    names.iter().filter_map(|name| self.numbers.get(name)).copied().collect();
                for &number in &numbers {
                    wanted[number] = true;
                }
                let near = numbers.iter().flat_map(|&number| &self.of[number]);
                let inside = |index: &&usize| self.names[**index].iter().all(|&name| wanted[name]);
                let mut picked: Vec<usize> = near.filter(inside).chain(&self.nameless).copied().collect();
                picked.sort_unstable();
                picked.dedup();
                picked
            }
        };
        picked.into_iter().map(|index| &self.all[index])
    }
}
