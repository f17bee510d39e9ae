//! Converts runs of a real robot into results by the same rules as runs in the twin.
//!
//! There are two sources. A person with a stopwatch notes on the [`form`] when each peg was seated,
//! and [`stopwatch`] reads the notes. Or cameras log the poses of the parts, and [`poses`] passes
//! them to the referee. Impossible input is refused.

pub mod form;
pub mod poses;
pub mod stopwatch;
