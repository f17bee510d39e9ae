//! The fault of an episode: waits for its occasion, strikes once, and keeps a report.
//!
//! `state` is the current stage, `strike` begins and continues a fault, and `step` does so with each step of
//! the physics.

mod state;
mod step;
mod strike;

pub(crate) use state::Injector;
