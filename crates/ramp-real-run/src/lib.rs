//! Converts runs of a real robot into results by the same rules as runs in the twin.
//!
//! There are two sources. A person with a stopwatch notes on the [`form`] when each peg was seated, and
//! [`stopwatch`] reads the notes. Or the poses of the parts are logged, and [`poses`] passes them to the
//! referee. Cameras of the lab log them, or [`mod@drive`] does, which lets an agent drive a robot. Impossible
//! input is refused.

pub mod drive;
pub mod form;
pub mod poses;
pub mod stopwatch;
