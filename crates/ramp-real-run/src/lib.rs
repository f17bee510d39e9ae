//! Runs of a real robot become results by the same rules as runs in the twin.
//!
//! Either a person with a stopwatch notes when each peg was seated, on the [`form`], and [`stopwatch`] reads the notes;
//! or cameras log where the parts are, and [`poses`] lets the referee judge them. What cannot have happened is refused.

pub mod form;
pub mod poses;
pub mod stopwatch;
