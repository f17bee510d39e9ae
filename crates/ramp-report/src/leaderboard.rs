//! A leaderboard: whole classes, each result run again from its log, as a static site.
//!
//! [`terms`] says what an entry must be, [`copies`] finds calls that came before under another name, [`boards`] ranks
//! what was admitted, and [`pages`] writes it.

pub mod boards;
pub mod copies;
pub mod pages;
pub mod terms;

pub use boards::{Boards, Key, Standing, standings};
pub use copies::{Copy, Stream, Streams};
pub use pages::Refusal;
pub use terms::{BoardGoal, BoardTerms, Refused, agent, check_log, check_whole, one_agent};
