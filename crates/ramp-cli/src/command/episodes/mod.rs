//! Runs many episodes, each in its own process. Finished results are kept. A crash or hang loses only its own
//! episode. An interrupted command resumes where it stopped.

mod arguments;
mod batch;
mod display;
mod episode;
mod goals;
mod remote;
mod tapes;

pub use arguments::Arguments;
pub use batch::{Batch, BatchWorld};
pub use episode::{Episode, Outcome};
pub use goals::find;
pub use tapes::Tapes;
