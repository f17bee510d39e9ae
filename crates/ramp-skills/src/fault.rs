//! Reasons for which a skill ends early.

use ramp_motion::MotionError;
pub use ramp_robot::Fault;
use ramp_robot::RobotError;

/// The reason for which a skill ended early.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SkillError {
    /// The robot stopped; nothing more can be done.
    #[error(transparent)]
    Robot(RobotError),
    /// No motion was found.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// Something went wrong that a retry or a new plan may repair.
    #[error(transparent)]
    Fault(#[from] Fault),
}

/// After a stop from which the arm has recovered, the work goes on as after any fault.
impl From<RobotError> for SkillError {
    fn from(error: RobotError) -> SkillError {
        if error.is_recovered() {
            SkillError::Fault(Fault::Robot { why: error.to_string() })
        } else {
            SkillError::Robot(error)
        }
    }
}

impl SkillError {
    /// The same as an event reports it.
    pub fn fault(&self) -> Fault {
        match self {
            SkillError::Robot(error) => Fault::Robot { why: error.to_string() },
            SkillError::Motion(error) => Fault::NoMotion { why: error.to_string() },
            SkillError::Fault(fault) => fault.clone(),
        }
    }
}
