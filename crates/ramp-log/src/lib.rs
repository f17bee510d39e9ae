//! Logs: one MCAP file per episode, to view it, judge it again, or replay it bit by bit.
//!
//! A log holds the inputs of the episode ([`Header`]), every call of the agent to its last bit
//! ([`calls`]) with hashes of the physics state between them, [`signals`] for viewers, and the result.
//! [`mod@write`] writes it while the episode runs, in a file of [`channels`]. [`read`] takes it apart,
//! record by record ([`records`]), and [`facts`] are what a board compares. It contains the true poses,
//! so an agent never gets the file. This crate links no physics engine: the caller passes in the
//! observations and truths.

pub mod calls;
pub mod channels;
pub mod error;
pub mod facts;
pub mod header;
pub mod read;
pub mod records;
pub mod signals;
pub mod write;

pub use channels::LogFile;
pub use error::LogError;
pub use facts::{Facts, Named};
pub use header::{CALLS, ENDING, Header, SCHEMA, SecretSeed, Sources};
pub use read::Log;
pub use records::Limits;
pub use write::{Due, Recorder};
