//! Agents that are programs of their own, in any language: they speak a small protocol on their standard
//! input and output ([`protocol`], and for their authors `docs/src/reference/agents.md`).
//!
//! Nothing that such a program does can stop or bend a bench: whether it hangs, crashes, floods or talks
//! nonsense, it ends its own episode, which is scored, with a reason that says so.
//!
//! Data passes one way: an [`AgentFile`] is started as a [`process`], in a [`sandbox`] if its author is a
//! stranger, told its [`GoalMessage`], and heard through [`protocol`]; [`ExternalAgent`] is what an episode
//! sees of it.

mod agent;
mod become_agent;
mod family;
mod file;
mod finder;
pub mod finder_message;
mod goal;
pub mod limits;
pub mod observation;
mod planner;
mod powers;
pub mod process;
pub mod protocol;
pub mod sandbox;
mod still;
mod words;

pub use agent::ExternalAgent;
pub use become_agent::{become_agent, hide};
pub use family::{adopt_orphans, end_orphans};
pub use file::{AgentFile, AgentFileError};
pub use finder::{FinderError, finder_name, start_finder};
pub use goal::GoalMessage;
pub use limits::Patience;
pub use planner::{PlannerError, ask_planner, planner_name};
pub use process::Silence;
pub use sandbox::{Sandbox, SandboxError};
