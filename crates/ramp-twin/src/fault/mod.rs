//! Faults: injected errors inside the physics of an episode, to measure which agents notice and fix them.
//!
//! A [`Fault`] strikes once. `occasion` watches the truth for the moments at which a kind may strike and
//! counts them. The injector then acts: a force on a part, a weak grip, a repeated image, a bias of the wrist
//! sensor. It never sets the pose of a part, and the agent gets no notice. Sizes, times and, if it is not
//! given, the occasion come from the stream `fault-KIND` of the episode's seed.

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
