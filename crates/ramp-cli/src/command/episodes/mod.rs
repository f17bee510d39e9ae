//! Many episodes, each in a process of its own: what is finished stays, what crashes or hangs costs its own episode
//! only, and what was stopped or killed goes on where it was.

mod arguments;
mod batch;
mod display;
mod episode;
mod goals;

pub use arguments::Arguments;
pub use batch::{Batch, BatchWorld};
pub use episode::{Episode, Outcome};
pub use goals::find;
