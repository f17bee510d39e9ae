//! The seam itself: a robot that an agent can drive.

use crate::camera::{Camera, CameraModel, Image, ImageWidth};
use crate::command::Command;
use crate::error::RobotError;
use crate::observation::{Observation, PartReading};

/// Largest number of exposures whose images wait to be fetched.
pub const MOST_EXPOSURES: usize = 8;

/// A robot that an agent can drive: the twin, or a real arm.
///
/// The trait is all that an agent gets. The implementation behind it, and the truth that the
/// referee reads, cannot be reached through it:
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
    /// Advances one control period of a millisecond under `command` and returns the observation at
    /// its end.
    ///
    /// # Errors
    /// When the command is not finite, a limit of the arm is exceeded or the time limit is reached.
    /// After a final error every further call returns the same error. After
    /// [`RobotError::Recovered`] the arm stands where it stopped, robot time has passed, and the next
    /// command begins a new motion.
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError>;

    /// The last observation; no time passes.
    fn observe(&self) -> Observation;

    /// Reads the poses of the parts, as far as the track allows. On `state`: all parts, exactly, in
    /// no time. On `noisy`: most of them, with noise; robot time passes as for an image, during
    /// which the arm continues its last command.
    ///
    /// # Errors
    /// As [`Robot::step`]; on `tags` always [`RobotError::NotOnTrack`], and the robot continues.
    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError>;

    /// Opens the shutters of both cameras. It takes no robot time: the arm continues to follow its
    /// commands, and the image carries its pose in the middle of the exposure. Motion during the
    /// exposure blurs the image. [`Robot::look`] delivers the images later, the oldest first. A
    /// camera finishes one image before it begins the next, so simultaneous requests are exposed
    /// one after the other. At most [`MOST_EXPOSURES`] are kept. A further request replaces the
    /// oldest exposure whose images are ready, and is ignored if none is ready.
    ///
    /// # Errors
    /// The error of an earlier step; on `noisy` [`RobotError::NotOnTrack`], and the robot
    /// continues.
    fn expose(&mut self) -> Result<(), RobotError>;

    /// Delivers an image: the oldest exposed by [`Robot::expose`] that this camera has not
    /// delivered yet, as soon as it is ready; otherwise a new one. Exposure and transfer take robot
    /// time, during which the arm continues its last command. The cameras are exposed together: the
    /// other camera's image of the same moment is ready as well and takes no time if it is
    /// requested before any passes.
    ///
    /// # Errors
    /// As [`Robot::step`]; [`RobotError::CameraStopped`] when there is no image, and on `noisy`
    /// [`RobotError::NotOnTrack`]. After these two the robot continues. After
    /// [`RobotError::Recovered`] the image may be requested again.
    fn look(&mut self, camera: Camera) -> Result<Image, RobotError> {
        self.look_sized(camera, None)
    }

    /// As [`Robot::look`], with an image of this width and the whole field of view
    /// ([`CameraModel::with_width`]); `None` is the camera's own width. A small image is drawn with one
    /// sample for each of its pixels: it costs less than a full image, and is not the mean of one. Robot
    /// time is the same.
    ///
    /// # Errors
    /// As [`Robot::look`].
    fn look_sized(&mut self, camera: Camera, width: Option<ImageWidth>) -> Result<Image, RobotError>;

    /// The nominal model of a camera: its lens, and its pose up to a typical calibration error.
    fn camera(&self, camera: Camera) -> CameraModel;
}
