//! The exit status of the program.

/// Done.
pub const DONE: u8 = 0;
/// The run ended without completing the goal, or a check failed.
pub const INCOMPLETE: u8 = 1;
/// Bad usage or bad input.
pub const BAD_INPUT: u8 = 2;
/// Many episodes were stopped by Ctrl-C.
pub const STOPPED: u8 = 130;
