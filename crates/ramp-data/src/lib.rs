//! The benchmark's files: kit, goals, planning rules, arm and worlds. The command line, the environments and
//! Python all read them here.
//!
//! [`Data`] is a data folder, such as `data` of this repository, or the same files built into the program.
//! Every method reads files and hands on checked values; [`DataError`] says which file or name is wrong.
//! [`Plans`] are plans of another planner.

mod built_in;
mod data;
mod error;
mod plans;

pub use built_in::built_in;
pub use data::{ARMS, Data, Texts};
pub use error::DataError;
pub use plans::{LARGEST_PLAN, MOST_PLANS, Plans, PlansError};
