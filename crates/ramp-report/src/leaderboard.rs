//! A leaderboard as a static site: results of whole classes, each reproduced from its log.
//!
//! [`terms`] checks entries, [`copies`] finds calls that an earlier entry has made, [`boards`]
//! ranks the admitted entries, and [`pages`] writes the site.

pub mod boards;
pub mod copies;
pub mod pages;
pub mod terms;

pub use boards::{Boards, Control, Key, Standing, standings};
pub use copies::{Copy, Stream, Streams};
pub use pages::Refusal;
pub use terms::{BoardArm, BoardGoal, BoardTerms, Refused, agent, check_log, check_whole, one_agent};
