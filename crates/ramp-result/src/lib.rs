//! Result files of every kind, and statistics over many of them.
//!
//! Data passes one way: whoever judges makes an [`EpisodeResult`], or the verdict of a single ability
//! ([`planning`], [`perception`], [`manipulation`]); each is one JSON file of a schema in `data/schema`,
//! written by [`write_whole`]. [`collection`] reads folders of such files, from anybody, and [`published`]
//! means that others have given. [`resume`] decides whether a result on disk is that of a wanted episode. A
//! [`secret`] makes seeds that nobody knows before. [`shipped`] lists the versions of shipped files.
//! [`summary`], [`activity`] and [`statistics`] add up what was read. Nothing here links a physics engine.

pub mod activity;
pub mod collection;
pub mod episode;
pub mod file;
pub mod manipulation;
mod older;
pub mod perception;
pub mod planning;
pub mod published;
pub mod resume;
pub mod secret;
pub mod shipped;
mod start;
pub mod statistics;
pub mod summary;
#[doc(hidden)]
pub mod testing;
mod words;

pub use episode::EpisodeResult;
pub use file::sha256;
pub use ramp_kit::source::{WriteError, write_whole};
pub use words::MOST_PEGS;
