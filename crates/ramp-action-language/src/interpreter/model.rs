//! The [`Model`]: a domain with the objects and statics of one problem, and the mapping between
//! terms and numbers.

use super::refusal::Refusal;
use super::rule::Rule;
use super::state::{Ground, State};
use super::values::{Relation, Row, Value, Values};
use crate::domain::{Domain, Kind, NUMBER};
use crate::term::Term;
use rustc_hash::FxHashMap as HashMap;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::rc::Rc;

/// A domain with the objects and statics of one problem. It computes the effects of actions and the
/// reasons why they are impossible.
///
/// ```
/// use ramp_action_language::{Domain, Model, SourceFile, Term};
///
/// let text = "sort lamp. inertial fluent on(lamp). action press(lamp). press(L) causes on(L) if -on(L).";
/// let domain = Domain::new(&SourceFile::new("lamp.al", text), None)?;
/// let lamp = Term::from("hall");
/// let model = Model::new(&domain, &[Term::new("lamp", [lamp.clone()])]);
/// let dark = model.initial(&[], &[]).unwrap();
/// let lit = model.after(&dark, &Term::new("press", [lamp.clone()])).unwrap();
/// assert!(model.holds(&lit, &Term::new("on", [lamp])));
/// # Ok::<(), ramp_action_language::LanguageError>(())
/// ```
pub struct Model<'d> {
    pub(crate) domain: &'d Domain,
    pub(crate) names: HashMap<&'d str, usize>,
    pub(crate) predicates: Vec<Predicate<'d>>,
    pub(crate) values: RefCell<Values>,
    /// The number of each sort, and by sort number and value whether the value belongs to it.
    pub(crate) sort_numbers: HashMap<&'d str, usize>,
    pub(crate) sorts: Vec<Vec<bool>>,
    /// In a fixed order.
    pub(crate) elements: Vec<Vec<Value>>,
    pub(crate) statics: Vec<Relation>,
    pub(crate) causal: Vec<Rule<'d>>,
    pub(crate) impossible: Vec<Rule<'d>>,
    pub(crate) constraints: Vec<Rule<'d>>,
    /// Laws of defined fluents, by fluent, in order of dependency.
    pub(crate) defined: Vec<(usize, Vec<Rule<'d>>)>,
    /// For each defined fluent: the inertial fluents on which it depends.
    pub(crate) depends: HashMap<usize, BTreeSet<usize>>,
    pub(crate) initially: Vec<Rule<'d>>,
    pub(crate) goals: Vec<Rule<'d>>,
    pub(crate) bridges: Vec<Rule<'d>>,
}

/// A declared name.
pub(crate) struct Predicate<'d> {
    pub(crate) name: &'d str,
    pub(crate) kind: Kind,
}

impl Model<'_> {
    /// The number of a term.
    pub(crate) fn value(&self, term: &Term) -> Value {
        self.values.borrow_mut().of(term)
    }

    /// Whether a value belongs to a sort.
    pub(crate) fn is_of(&self, value: Value, sort: usize) -> bool {
        self.sorts[sort].get(value as usize).copied().unwrap_or(false)
    }

    /// The ground term that a value stands for.
    pub(crate) fn term(&self, value: Value) -> Term {
        self.values.borrow().terms[value as usize].clone()
    }

    /// The state in which nothing is true.
    pub(crate) fn empty(&self) -> State {
        State { rows: self.predicates.iter().map(|_| Rc::default()).collect() }
    }

    /// Whether an atom is true in a state, or a static.
    pub(crate) fn has(&self, predicate: usize, row: &Row, state: &State) -> bool {
        match self.predicates[predicate].kind {
            Kind::Static => self.statics[predicate].rows.contains(row),
            _ => state.rows[predicate].contains(row),
        }
    }

    /// A term as a ground atom of the domain; `None` for an unknown name.
    pub(crate) fn ground(&self, term: &Term) -> Option<Ground> {
        let (name, arguments) = term.parts()?;
        let predicate = *self.names.get(name)?;
        let sorts = &self.domain.predicates.get(name)?.sorts;
        if sorts.len() != arguments.len() {
            return None;
        }
        let row: Row = arguments.iter().map(|argument| self.value(argument)).collect();
        let belongs = |(value, sort): (&Value, &String)| {
            sort == NUMBER
                || self.sort_numbers.get(sort.as_str()).is_some_and(|&sort| self.is_of(*value, sort))
        };
        row.iter().zip(sorts).all(belongs).then_some(Ground { predicate, row })
    }

    /// A term as an action of the domain.
    pub(crate) fn action(&self, term: &Term) -> Result<Ground, Refusal> {
        let ground = self
            .ground(term)
            .filter(|action| matches!(self.predicates[action.predicate].kind, Kind::Action { .. }));
        ground.ok_or_else(|| Refusal::Unknown(term.to_string()))
    }

    /// A ground atom as a term.
    pub(crate) fn atom_term(&self, fluent: &Ground) -> Term {
        let arguments = fluent.row.iter().map(|&value| self.term(value)).collect();
        Term::Function(self.predicates[fluent.predicate].name.to_string(), arguments)
    }

    /// A ground atom in words.
    pub(crate) fn text(&self, fluent: &Ground) -> String {
        self.atom_term(fluent).to_string()
    }
}
