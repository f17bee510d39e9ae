//! The domain carried out, state by state, from the definition of the language alone: no solver has a part in it.
//!
//! `compile` makes a [`Model`] of a domain and the facts of a problem; everything in it is a number that stands for a
//! ground term (`values`), so that states are small and comparing them is cheap. `matching` finds what the variables
//! of a law can stand for. On it rest `transition` (states and actions), `query` (what is true) and `reason` (what
//! forbids an action).

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
