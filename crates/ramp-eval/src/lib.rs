//! Measures and protocol (sections III-C and III-D of the paper): who is right, how far, how fast.
//!
//! Data passes one way: [`episode`] lets an agent work in the twin while [`referee`] watches the truth; what comes
//! out is a [`result::EpisodeResult`], one JSON file of a published schema; [`curve`] draws it. [`perception`] makes images with
//! labels, and judges detectors on them. [`summary`] adds up the episodes of a goal or a class. [`log`] keeps all that an
//! episode was, and [`mod@replay`] runs it again from there.
//! [`collection`] reads folders of results, and [`report`] compares the agents in them, with [`statistics`] and with
//! what the events tell of each [`activity`]; [`faults`] judges episodes in which something went wrong on purpose; [`published`] holds means that others have given.

pub mod activity;
pub mod collection;
pub mod curve;
pub mod episode;
pub mod external;
pub mod faults;
pub mod form;
pub mod held_out;
pub mod leaderboard;
pub mod log;
pub mod manipulation;
pub mod perception;
pub mod planning;
pub mod poses;
pub mod published;
pub mod referee;
pub mod replay;
pub mod report;
pub mod result;
pub mod statistics;
pub mod stopwatch;
pub mod summary;
#[cfg(test)]
mod testing;

pub use episode::{EpisodeError, Progress, record_episode, run_episode};
pub use log::Log;
pub use referee::Referee;
pub use replay::{ReplayError, Replayed, replay};
pub use result::EpisodeResult;
