//! States: the set of true ground atoms.

use super::values::Row;
use std::collections::BTreeSet;
use std::rc::Rc;

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Ground {
    pub(crate) predicate: usize,
    pub(crate) row: Row,
}

/// A state: the set of true fluents.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct State {
    /// By predicate; unchanged parts are shared with the previous state.
    pub(crate) rows: Vec<Rc<BTreeSet<Row>>>,
}

/// Bounds on a state for matching: fluents that may be true and fluents that must be. For a known
/// state both are equal.
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
