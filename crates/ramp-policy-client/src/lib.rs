//! Policies behind a WebSocket, in the dialect of openpi's and RoboArena's policy servers: a server sends its
//! metadata, gets observations, and answers each with a chunk of actions (for their authors:
//! `docs/src/reference/policies.md`).
//!
//! Nothing that a server sends can stop a bench: a message that is too long, of the wrong shape or not finite
//! ends the episode, which is scored, with a reason that names the field.
//!
//! Data passes one way: [`wire`] turns bytes into values; a connection carries them, within limits of size
//! and time; [`Metadata`] says what the policy sees and does; a rollout drives the robot by its actions,
//! waiting for each answer or not;
//! [`PolicyAgent`] is a policy for a whole goal, [`PolicySkill`] one for a single action.

mod agent;
mod asynchronous;
mod chunk;
mod connection;
mod error;
mod metadata;
mod motion;
mod observation;
mod rollout;
mod server;
mod skill;
pub mod wire;

pub use agent::PolicyAgent;
pub use connection::{PolicyUrl, UrlError};
pub use error::PolicyError;
pub use metadata::{ActionSpace, Metadata};
pub use server::PolicyServer;
pub use skill::PolicySkill;
