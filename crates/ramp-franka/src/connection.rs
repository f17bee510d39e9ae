//! The addresses of an arm, and the numbers of a connection to it.

/// The addresses of an arm and its surroundings.
#[derive(Clone, Debug, PartialEq)]
pub struct Connection {
    /// The arm's address: `HOST` or `HOST:PORT`.
    pub arm: String,
    /// The gripper's.
    pub gripper: String,
    /// The cell's of a served twin, `HOST:PORT`; a real arm has none.
    pub cell: Option<String>,
    /// How time passes.
    pub pace: Pace,
    /// External force (N) and external torque of a joint (N·m) at which the arm stops by reflex.
    pub reflex_force: f64,
    /// See `reflex_force`.
    pub reflex_torque: f64,
}

/// How time passes between two commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// The arm's time goes on, whether or not a command has come: a real arm.
    RealTime,
    /// The arm waits for each command: a served twin in lock-step.
    LockStep,
}

/// Numbers of a connection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Control periods.
    pub periods: u64,
    /// Those without a new command in time.
    pub late: u64,
    /// The longest row of them.
    pub longest: u64,
    /// States that did not come a millisecond after the one before.
    pub gaps: u64,
}
