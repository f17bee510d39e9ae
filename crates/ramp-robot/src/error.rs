//! Errors of a robot.

use crate::camera::Camera;
use crate::track::Track;

/// Errors of a robot.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RobotError {
    /// A joint left its range.
    #[error("joint {joint} is at {position:.3} rad, outside {low:.3} to {high:.3}")]
    JointPosition {
        /// 1 to 7.
        joint: usize,
        /// rad.
        position: f64,
        /// rad.
        low: f64,
        /// rad.
        high: f64,
    },
    /// A joint moved too fast.
    #[error("joint {joint} moves at {velocity:.3} rad/s, faster than {limit:.3}")]
    JointVelocity {
        /// 1 to 7.
        joint: usize,
        /// rad/s.
        velocity: f64,
        /// rad/s.
        limit: f64,
    },
    /// A real arm has stopped or cannot be reached.
    #[error("{what}")]
    Arm {
        /// The arm's own words, or what is wrong with the line to it.
        what: String,
    },
    /// A command holds a number that is not finite, or an invalid pose, force or width.
    #[error("the command's {what} is not a finite, valid number")]
    BadCommand {
        /// The part of the command.
        what: &'static str,
    },
    /// A command holds a number beyond the [`limits`](crate::limits).
    #[error("the command's {what} is {value:e}, above the limit of {limit} {unit}")]
    TooMuch {
        /// The part of the command.
        what: &'static str,
        /// In `unit`.
        value: f64,
        /// The largest allowed value, in `unit`.
        limit: f64,
        /// The SI unit.
        unit: &'static str,
    },
    /// The step from the previous commanded position or pose exceeds a motion limit.
    #[error(
        "the commanded {quantity} of {of} is {value:.3} {unit}, above the limit of {limit:.3}: one command is expected every 1 ms"
    )]
    NotSmooth {
        /// The moving body, such as `joint 3`.
        of: String,
        /// Velocity, acceleration or jerk; for the first command, its distance from the current
        /// pose.
        quantity: &'static str,
        /// In `unit`.
        value: f64,
        /// The largest allowed value, in `unit`.
        limit: f64,
        /// The SI unit.
        unit: &'static str,
    },
    /// Commanded torques change faster than the controller allows.
    #[error(
        "controller_torque_discontinuity: the commanded torque of joint {joint} changes by {rate:.0} N·m/s, above the limit of {limit:.0}"
    )]
    TorqueJump {
        /// 1 to 7.
        joint: usize,
        /// N·m/s.
        rate: f64,
        /// N·m/s.
        limit: f64,
    },
    /// A measured force or torque exceeded its limit.
    #[error("reflex: {of} is {value:.0} {unit}, above the limit of {limit:.0}")]
    Reflex {
        /// The measured quantity.
        of: String,
        /// In `unit`.
        value: f64,
        /// In `unit`.
        limit: f64,
        /// The SI unit.
        unit: &'static str,
    },
    /// The arm stopped by a reflex or for its speed, stood for a while, and is ready again. The robot
    /// continues: a new motion begins where the arm stands.
    #[error("{why}; the arm is ready again after {after:.1} s")]
    Recovered {
        /// The error that stopped it.
        why: String,
        /// Robot time for which it stood, s.
        after: f64,
    },
    /// The episode reached its time limit.
    #[error("the episode reached its limit of {limit:.0} s of robot time")]
    OutOfTime {
        /// s.
        limit: f64,
    },
    /// The requested reading is not available on the agent's track. The robot continues.
    #[error("track `{}` gives no {what}", track.name())]
    NotOnTrack {
        /// The track.
        track: Track,
        /// The requested reading.
        what: &'static str,
    },
    /// A camera no longer delivers images. The robot continues.
    #[error("the camera `{}` gives no image", camera.name())]
    CameraStopped {
        /// The camera.
        camera: Camera,
    },
    /// The simulation became unstable.
    #[error("the physics diverged at {time:.3} s")]
    Diverged {
        /// s.
        time: f64,
    },
}

impl RobotError {
    /// Whether the robot has stopped for good; after the other errors it continues.
    pub fn is_final(&self) -> bool {
        !matches!(
            self,
            RobotError::NotOnTrack { .. } | RobotError::CameraStopped { .. } | RobotError::Recovered { .. }
        )
    }

    /// Whether the arm stopped and is ready again: a motion that was under way has to begin anew from where
    /// the arm stands.
    pub fn is_recovered(&self) -> bool {
        matches!(self, RobotError::Recovered { .. })
    }
}
