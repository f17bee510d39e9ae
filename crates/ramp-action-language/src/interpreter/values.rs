//! Ground terms interned as numbers, and relations over them: for small states and fast
//! comparisons.

use crate::term::Term;
use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};
use smallvec::SmallVec;
use std::rc::Rc;

/// The number of a ground term.
pub(crate) type Value = u32;
/// The arguments of a ground atom.
pub(crate) type Row = SmallVec<[Value; 4]>;

/// Every known ground term, with its number.
#[derive(Default)]
pub(crate) struct Values {
    pub(crate) numbers: HashMap<Term, Value>,
    pub(crate) terms: Vec<Term>,
    /// The arguments of a function.
    pub(crate) parts: Vec<Option<(Rc<str>, Row)>>,
    /// Functions by their arguments.
    pub(crate) functions: HashMap<Rc<str>, HashMap<Row, Value>>,
}

impl Values {
    /// The number of a term; a new term gets a new one.
    pub(crate) fn of(&mut self, term: &Term) -> Value {
        if let Some(&value) = self.numbers.get(term) {
            return value;
        }
        let parts = match term {
            Term::Function(name, arguments) if !arguments.is_empty() => {
                let row: Row = arguments.iter().map(|argument| self.of(argument)).collect();
                Some((Rc::<str>::from(name.as_str()), row))
            }
            _ => None,
        };
        let value = Value::try_from(self.terms.len()).unwrap_or(Value::MAX);
        self.numbers.insert(term.clone(), value);
        self.terms.push(term.clone());
        if let Some((name, row)) = &parts {
            self.functions.entry(name.clone()).or_default().insert(row.clone(), value);
        }
        self.parts.push(parts);
        value
    }
}

impl Values {
    /// Whether all names in a term, at any depth, are among `named` (by value).
    pub(crate) fn names_only(&self, value: Value, named: &[bool]) -> bool {
        match (&self.parts[value as usize], &self.terms[value as usize]) {
            (Some((_, row)), _) => row.iter().all(|&inner| self.names_only(inner, named)),
            (None, Term::Text(_)) => named[value as usize],
            (None, _) => true,
        }
    }
}

/// A static: its rows, in order of insertion.
#[derive(Default)]
pub(crate) struct Relation {
    pub(crate) rows: HashSet<Row>,
    pub(crate) list: Vec<Row>,
    /// Rows by argument position and value.
    pub(crate) index: HashMap<(usize, Value), Vec<usize>>,
}

impl Relation {
    /// Adds a row; `false` when it exists already.
    pub(crate) fn insert(&mut self, row: Row) -> bool {
        let new = self.rows.insert(row.clone());
        if new {
            for (position, &value) in row.iter().enumerate() {
                self.index.entry((position, value)).or_default().push(self.list.len());
            }
            self.list.push(row);
        }
        new
    }
}
