//! Faults: what goes wrong in an episode on purpose, inside the physics, so that it can be measured who notices and
//! fixes it.
//!
//! A [`Fault`] strikes once. `occasion` watches the truth for the moments at which a kind may strike and counts them;
//! `act` is what then happens: a force on a part, a grip that is weak, an image that repeats, a bias of the wrist
//! sensor. No part is ever put anywhere, and the agent is told nothing. Sizes, times and, where it is not given, the
//! occasion come from the stream `fault-KIND` of the episode's seed.

mod act;
mod draws;
mod injector;
mod kind;
mod occasion;
mod spec;

pub(crate) use draws::Start;
pub(crate) use injector::Injector;
pub use kind::FaultKind;
pub use spec::{Fault, FaultError, FaultReport};
