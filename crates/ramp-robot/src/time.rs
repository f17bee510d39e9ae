//! The robot's clock.

/// Length of a control period, s: a [`Command`](crate::Command) is valid for one period. The twin's
/// physics step has the same length.
pub const PERIOD: f64 = 0.001;

/// Longest episode, s of robot time: the rules end it there.
pub const TIME_LIMIT: f64 = 30.0 * 60.0;
