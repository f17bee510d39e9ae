//! One episode (section III-D of the paper): an agent works in the twin, the referee watches the truth, the
//! log keeps it.
//!
//! Data passes one way: [`episode`] lets an agent work through `judged`, which stands between agent and twin,
//! and hands on an [`EpisodeResult`](ramp_result::EpisodeResult) and a log. [`mod@replay`] runs the same
//! episode again from its log, reports each [`Difference`], and each violation of the track ([`Breach`]).
//! [`faults`] judges episodes in which something went wrong on purpose, and a [`Tape`] plays the commands of
//! a log without sight.

mod again;
mod answer;
mod conduct;
mod difference;
pub mod episode;
pub mod faults;
mod given;
mod judged;
pub mod replay;
pub mod tape;

mod waiting;

pub use conduct::Breach;
pub use difference::Difference;
pub use episode::{EpisodeError, Label, Recorded, record_episode, run_episode, run_episode_in};
pub use given::{GivenError, check_given};
pub use judged::{Progress, Watcher};
pub use replay::{ReplayError, Replayed, replay};
pub use tape::Tape;
