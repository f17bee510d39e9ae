//! Result files of every kind, and statistics over many of them.
//!
//! Data passes one way. A judge makes an [`EpisodeResult`] or the verdict of a single ability
//! ([`planning`], [`perception`], [`manipulation`]). Each is one JSON file of a schema in
//! `data/schema`, written by [`write_whole`]. [`collection`] reads folders of such untrusted files;
//! [`published`] holds means that others have published. A [`secret`] makes seeds that are
//! unpredictable. [`summary`], [`activity`] and [`statistics`] evaluate the collection. This crate
//! links no physics engine.

pub mod activity;
pub mod collection;
pub mod episode;
pub mod file;
pub mod manipulation;
pub mod perception;
pub mod planning;
pub mod published;
pub mod secret;
pub mod statistics;
pub mod summary;
#[doc(hidden)]
pub mod testing;
mod words;

pub use episode::EpisodeResult;
pub use file::sha256;
pub use ramp_kit::source::{WriteError, write_whole};
pub use words::{MOST_EVENTS, MOST_PEGS};
