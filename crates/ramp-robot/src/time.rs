//! The robot's clock.

/// Length of a control period, s: a [`Command`](crate::Command) holds for so long. The twin's physics step is as long.
pub const PERIOD: f64 = 0.001;

/// Longest episode, s of robot time: the rules end it there.
pub const TIME_LIMIT: f64 = 30.0 * 60.0;
