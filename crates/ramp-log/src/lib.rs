//! Logs: one MCAP file an episode, from which it can be looked at, judged again, and run again bit by bit.
//!
//! A log holds what the episode was made from ([`Header`]), every call of the agent to its last bit ([`calls`]) with
//! hashes of the physics state on the way, signals for viewers, and the result. [`mod@write`] makes it while the episode
//! runs, and [`read`] takes it apart, record by record ([`records`]). The truth is in it: an agent never gets the file. Nothing here links a physics
//! engine; whoever runs the episode hands over what the world shows.

pub mod calls;
pub mod error;
pub mod header;
pub mod read;
pub mod records;
pub mod write;

pub use error::LogError;
pub use header::{CALLS, ENDING, Header, SCHEMA, SecretSeed, Sources};
pub use read::Log;
pub use write::{Due, Recorder};
