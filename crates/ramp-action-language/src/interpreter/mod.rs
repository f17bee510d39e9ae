//! Executes the domain state by state, from the definition of the language, without a solver.
//!
//! `compile` makes a [`Model`] from a domain and the facts of a problem. Ground terms are interned
//! as numbers (`values`), so states are small and fast to compare. `matching` enumerates the
//! bindings of a law's variables. It is the basis of `transition` (states and actions), `query`
//! (true fluents) and `reason` (laws that forbid an action).

mod compile;
mod matching;
mod model;
mod query;
mod reason;
mod refusal;
mod rule;
mod state;
mod transition;
mod values;

pub use model::Model;
pub use refusal::{Reason, Refusal};
pub(crate) use rule::{Binding, Rule, Test};
pub use state::State;
pub(crate) use state::{Ground, View};
pub(crate) use values::Row;
