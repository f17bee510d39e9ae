//! States: which ground atoms are true.

use super::values::Row;
use std::collections::BTreeSet;
use std::rc::Rc;

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Ground {
    pub(crate) predicate: usize,
    pub(crate) row: Row,
}

/// A state: which fluents are true.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct State {
    /// By predicate; shared with the states before and after as far as they are equal.
    pub(crate) rows: Vec<Rc<BTreeSet<Row>>>,
}

/// What a law is matched against: fluents that may be true and fluents that must be. For a state that is known, the
/// two are the same.
#[derive(Clone, Copy)]
pub(crate) struct View<'s> {
    pub may: &'s State,
    pub must: &'s State,
}

impl<'s> From<&'s State> for View<'s> {
    fn from(state: &'s State) -> View<'s> {
        View { may: state, must: state }
    }
}
