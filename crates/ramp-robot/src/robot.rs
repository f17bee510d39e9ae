//! The seam itself: a robot that can be driven.

use crate::camera::{Camera, CameraModel, Image};
use crate::command::Command;
use crate::error::RobotError;
use crate::observation::{Observation, PartReading};

/// Exposures of the cameras whose images wait to be asked for, at most.
pub const MOST_EXPOSURES: usize = 8;

/// A robot that an agent can drive: the twin, or a real arm.
///
/// The trait is all that an agent gets of it. What is behind it, with the truth that the referee reads, cannot be had
/// from it:
///
/// ```
/// fn drive(robot: &mut dyn ramp_robot::Robot) -> &mut dyn ramp_robot::Robot {
///     robot
/// }
/// ```
/// ```compile_fail
/// fn peek(robot: &mut dyn ramp_robot::Robot) -> &mut dyn std::any::Any {
///     robot
/// }
/// ```
pub trait Robot {
    /// Lets one control period of a millisecond pass under `command` and returns what was sensed at its end.
    ///
    /// # Errors
    /// When the command is not finite, a limit of the arm is broken or the episode's time is over. After an error
    /// every further call returns the same error.
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError>;

    /// What was sensed last, without letting time pass.
    fn observe(&self) -> Observation;

    /// Reads where the parts are, as far as the track allows. On `state` all parts, exactly and at no cost;
    /// on `noisy` most of them, with noise, and robot time passes as for an image, during which the arm goes on with
    /// its last command.
    ///
    /// # Errors
    /// As [`Robot::step`]; on `tags` always [`RobotError::NotOnTrack`], and the robot goes on.
    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError>;

    /// Opens the shutters of both cameras, and takes no robot time: the arm goes on as it is commanded, and the image carries
    /// its pose in the middle of the exposure. What moves meanwhile is blurred. [`Robot::look`] gives the images later, the
    /// oldest first. A camera is done with one image before it begins the next, so that exposures that are asked for at once
    /// follow each other. [`MOST_EXPOSURES`] are kept: another one takes the place of the oldest whose images are there, and is
    /// not begun if there is none.
    ///
    /// # Errors
    /// That of an earlier step; on `noisy` [`RobotError::NotOnTrack`], and the robot goes on.
    fn expose(&mut self) -> Result<(), RobotError>;

    /// Gives an image: the oldest of those exposed by [`Robot::expose`] that this camera has not given yet, as soon as it
    /// is there, or else one that is exposed now. Exposure and the way to the agent take robot time, during which the arm
    /// goes on with its last command. The cameras are exposed together: the other one's image of the same moment is there, too,
    /// and takes no time if it is asked for before any passes.
    ///
    /// # Errors
    /// As [`Robot::step`]; [`RobotError::CameraStopped`] when there is no image, and on `noisy`
    /// [`RobotError::NotOnTrack`]: after these two the robot goes on.
    fn look(&mut self, camera: Camera) -> Result<Image, RobotError>;

    /// What is known of a camera: its lens, and where it is up to the error of a usual calibration.
    fn camera(&self, camera: Camera) -> CameraModel;
}
