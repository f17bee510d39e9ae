//! Errors of a connection.

use ramp_robot::RobotError;

/// Error of [`FrankaRobot::connect`](crate::FrankaRobot::connect), and inside of a connection.
#[derive(Debug, thiserror::Error)]
pub enum FrankaError {
    /// The arm, its gripper or the line to it, in Franka's own words.
    #[error("{0}")]
    Arm(String),
    /// The arm has been silent.
    #[error("the arm at {address} has said nothing for {seconds} s")]
    Silent {
        /// Its address.
        address: String,
        /// s.
        seconds: f64,
    },
    /// The station has neither a cell nor cameras.
    #[error("this station has no cell that reads parts, and no cameras for images")]
    NoCell,
    /// The cell's connection.
    #[error("the cell at {address}: {error}")]
    Cell {
        /// Its address.
        address: String,
        /// The words of the system.
        error: std::io::Error,
    },
    /// The cell's answer is none.
    #[error("the cell at {address}: {why}")]
    CellAnswer {
        /// Its address.
        address: String,
        /// The fault.
        why: String,
    },
    /// A camera of this computer.
    #[error("the camera {name}: {why}")]
    Camera {
        /// Its device.
        name: String,
        /// The fault.
        why: String,
    },
    /// A command was refused before it was sent.
    #[error(transparent)]
    Command(#[from] RobotError),
}

impl From<franka::FrankaError> for FrankaError {
    fn from(error: franka::FrankaError) -> FrankaError {
        FrankaError::Arm(error.to_string())
    }
}

impl From<FrankaError> for RobotError {
    fn from(error: FrankaError) -> RobotError {
        match error {
            FrankaError::Command(error) => error,
            other => RobotError::Arm { what: other.to_string() },
        }
    }
}
