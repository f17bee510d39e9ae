//! Why a robot stopped.

use crate::camera::Camera;
use crate::track::Track;

/// Why a robot stopped.
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
    /// A command holds a number that is not finite, or is not a pose, force or width at all.
    #[error("the command's {what} is not a finite, sensible number")]
    BadCommand {
        /// Which part of the command.
        what: &'static str,
    },
    /// A command holds a number beyond the [`limits`](crate::limits).
    #[error("the command's {what} is {value:e}, and {limit} {unit} is the most there is")]
    TooMuch {
        /// Which part of the command.
        what: &'static str,
        /// In `unit`.
        value: f64,
        /// The most that is allowed, in `unit`.
        limit: f64,
        /// The SI unit.
        unit: &'static str,
    },
    /// A commanded position or pose does not follow from the one before within the limits of a motion.
    #[error(
        "the commanded {quantity} of {of} is {value:.3} {unit}, and the most is {limit:.3}: commands come one a period of 1 ms"
    )]
    NotSmooth {
        /// What moves, such as `joint 3`.
        of: String,
        /// Velocity, acceleration or jerk; of the first command, its step or turn from where the arm is.
        quantity: &'static str,
        /// In `unit`.
        value: f64,
        /// The most that is allowed, in `unit`.
        limit: f64,
        /// The SI unit.
        unit: &'static str,
    },
    /// Commanded torques change faster than the controller allows.
    #[error(
        "controller_torque_discontinuity: the commanded torque of joint {joint} changes by {rate:.0} N·m/s, and the most is {limit:.0}"
    )]
    TorqueJump {
        /// 1 to 7.
        joint: usize,
        /// N·m/s.
        rate: f64,
        /// N·m/s.
        limit: f64,
    },
    /// The arm has felt more than it may.
    #[error("reflex: {of} is {value:.0} {unit}, and the most is {limit:.0}")]
    Reflex {
        /// What was felt.
        of: String,
        /// In `unit`.
        value: f64,
        /// In `unit`.
        limit: f64,
        /// The SI unit.
        unit: &'static str,
    },
    /// The episode has lasted as long as an episode may.
    #[error("the episode reached its limit of {limit:.0} s of robot time")]
    OutOfTime {
        /// s.
        limit: f64,
    },
    /// The track on which the agent is judged does not give what it asked for. The robot goes on.
    #[error("track `{}` gives no {what}", track.name())]
    NotOnTrack {
        /// The track.
        track: Track,
        /// What was asked for.
        what: &'static str,
    },
    /// A camera gives no images any more. The robot goes on.
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
    /// Whether the robot has stopped for good; after the other errors it goes on.
    pub fn is_final(&self) -> bool {
        !matches!(self, RobotError::NotOnTrack { .. } | RobotError::CameraStopped { .. })
    }
}
