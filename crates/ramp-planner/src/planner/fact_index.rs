//! Facts by the names in them: what a small problem is told of a large goal.

use ramp_action_language::Term;
use std::collections::{BTreeSet, HashMap};

/// Facts, to be picked by the names in them.
pub(crate) struct Facts {
    pub(crate) all: Vec<Term>,
    /// By name: where it occurs, in order.
    of: HashMap<String, Vec<usize>>,
    /// Facts without any name.
    nameless: Vec<usize>,
}

impl Facts {
    /// Facts with their index.
    pub(crate) fn new(all: Vec<Term>) -> Facts {
        let mut of: HashMap<String, Vec<usize>> = HashMap::new();
        let mut nameless = Vec::new();
        for (index, fact) in all.iter().enumerate() {
            let texts: BTreeSet<&str> = fact.texts().into_iter().collect();
            if texts.is_empty() {
                nameless.push(index);
            }
            for text in texts {
                of.entry(text.to_string()).or_default().push(index);
            }
        }
        Facts { all, of, nameless }
    }

    /// The facts that name nothing but these, in order; without names, all.
    pub(crate) fn about(&self, names: Option<&BTreeSet<String>>) -> impl Iterator<Item = &Term> {
        let picked = match names {
            None => (0..self.all.len()).collect(),
            Some(names) => {
                let near = names.iter().filter_map(|name| self.of.get(name)).flatten().chain(&self.nameless);
                let near: BTreeSet<usize> = near.copied().collect();
                let inside =
                    |index: &usize| self.all[*index].texts().into_iter().all(|text| names.contains(text));
                near.into_iter().filter(inside).collect::<Vec<_>>()
            }
        };
        picked.into_iter().map(|index| &self.all[index])
    }
}
