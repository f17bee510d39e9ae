//! Robots that a test changes: each call goes to the robot below, and the test alters what goes down or comes
//! up.

use nalgebra::Vector6;
use ramp_robot::{
    ArmCommand, Camera, CameraModel, Command, DOF, GripperCommand, Image, ImageWidth, Impedance, Observation,
    PartReading, Robot, RobotError,
};

/// Moves the tip by `height` m along the vertical at 0.1 m/s from where it is, under impedance, with the
/// elbow near `posture` (rad).
///
/// # Errors
///
/// The robot's.
pub fn press(robot: &mut dyn Robot, height: f64, posture: [f64; DOF]) -> Result<(), RobotError> {
    let from = robot.observe();
    let steps = (height.abs() / 0.1 * 1e3) as u32;
    for step in 1..=steps {
        let mut x_wt = from.x_wt;
        x_wt.translation.z += height * f64::from(step) / f64::from(steps);
        let arm = ArmCommand::CartesianImpedance(Impedance {
            x_wt,
            stiffness: Vector6::new(1500.0, 1500.0, 1500.0, 60.0, 60.0, 60.0),
            damping_ratio: 1.0,
            feed_forward: Vector6::zeros(),
            posture,
        });
        robot.step(&Command { arm, gripper: GripperCommand { width: 0.04, force: 20.0 } })?;
    }
    Ok(())
}

/// An alteration of a robot in a test. By default none.
pub trait Alteration<R: Robot + ?Sized> {
    /// Before a step: changes the command, or ends the agent's work with an error.
    ///
    /// # Errors
    ///
    /// The error that the agent gets in place of an observation; the step is not made.
    fn before(&mut self, _robot: &R, _command: &mut Command) -> Result<(), RobotError> {
        Ok(())
    }

    /// After a step, with what the agent is going to see of it.
    ///
    /// # Errors
    ///
    /// The error that the agent gets in place of the observation.
    fn after(&mut self, _robot: &R, _command: &Command, _seen: &Observation) -> Result<(), RobotError> {
        Ok(())
    }

    /// The answer to a request for poses of parts, at a robot time (s).
    ///
    /// # Errors
    ///
    /// The error that the agent gets in place of `given`.
    fn parts(
        &mut self,
        _time: f64,
        given: Result<Vec<PartReading>, RobotError>,
    ) -> Result<Vec<PartReading>, RobotError> {
        given
    }

    /// The answer to a request for an image.
    ///
    /// # Errors
    ///
    /// The error that the agent gets in place of `given`.
    fn image(&mut self, _camera: Camera, given: Result<Image, RobotError>) -> Result<Image, RobotError> {
        given
    }

    /// The answer to a request to expose both cameras.
    ///
    /// # Errors
    ///
    /// The error that the agent gets in place of `given`.
    fn exposed(&mut self, given: Result<(), RobotError>) -> Result<(), RobotError> {
        given
    }
}

/// A robot with an alteration.
pub struct Altered<'r, R: ?Sized, A> {
    /// The robot below.
    pub robot: &'r mut R,
    /// The alteration.
    pub alteration: A,
}

impl<R: Robot + ?Sized, A: Alteration<R>> Robot for Altered<'_, R, A> {
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError> {
        let mut command = command.clone();
        self.alteration.before(self.robot, &mut command)?;
        let seen = self.robot.step(&command)?;
        self.alteration.after(self.robot, &command, &seen)?;
        Ok(seen)
    }

    fn observe(&self) -> Observation {
        self.robot.observe()
    }

    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        let time = self.robot.observe().time;
        let given = self.robot.read_parts();
        self.alteration.parts(time, given)
    }

    fn expose(&mut self) -> Result<(), RobotError> {
        let given = self.robot.expose();
        self.alteration.exposed(given)
    }

    fn look_sized(&mut self, camera: Camera, width: Option<ImageWidth>) -> Result<Image, RobotError> {
        let given = self.robot.look_sized(camera, width);
        self.alteration.image(camera, given)
    }

    fn camera(&self, camera: Camera) -> CameraModel {
        self.robot.camera(camera)
    }
}

/// Ends the agent's work at this robot time (s).
pub struct StopAt(pub f64);

impl<R: Robot + ?Sized> Alteration<R> for StopAt {
    fn after(&mut self, _robot: &R, _command: &Command, seen: &Observation) -> Result<(), RobotError> {
        if seen.time >= self.0 { Err(RobotError::OutOfTime { limit: self.0 }) } else { Ok(()) }
    }
}
