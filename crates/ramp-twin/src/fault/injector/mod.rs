//! The fault of an episode at work: waits for its occasion, strikes once, and keeps what it did.
//!
//! `state` is what goes on, `strike` begins and moves it, and `step` does so with each step of the physics.

mod state;
mod step;
mod strike;

pub(crate) use state::Injector;
