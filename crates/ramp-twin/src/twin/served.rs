//! The twin's arm for a controller outside of it: torques in, and what the arm reports of its joints out.

use ramp_control::JointVector;
use ramp_robot::{Camera, DOF, GripperCommand, ImageWidth, RobotError};

use super::Twin;
use crate::drawing::Drawing;
use crate::period;

/// The report of the arm about its joints beside an observation, N·m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointReport {
    /// The torques that hold the arm up.
    pub weight: [f64; DOF],
    /// The torques of the arm on what it touches, as it estimates them.
    pub external: [f64; DOF],
    /// The torques that it received last.
    pub received: [f64; DOF],
}

impl Twin {
    /// A control period in which these torques are sent to the arm, on top of those that hold it up (N·m),
    /// and this command to the gripper.
    ///
    /// # Errors
    /// When a limit of the arm is exceeded, the physics diverge or the time limit is reached. After an error
    /// every further call returns the same error, until [`Twin::stand`].
    pub fn actuate(&mut self, torques: &[f64; DOF], gripper: GripperCommand) -> Result<(), RobotError> {
        self.check_running()?;
        self.state.gripper_command = gripper;
        let broad_phase = &mut self.workspace.broad_phase;
        let torques = JointVector::from(*torques);
        let run = period::actuate(&self.scene, &mut self.data, &mut self.state, broad_phase, &torques);
        run.inspect_err(|error| self.state.failed = Some(error.clone()))
    }

    /// A control period in which the arm holds itself where it stands, with this command to the gripper.
    ///
    /// # Errors
    /// As [`Twin::actuate`].
    pub fn rest(&mut self, gripper: GripperCommand) -> Result<(), RobotError> {
        self.state.gripper_command = gripper;
        self.hold(1)
    }

    /// Makes the arm ready again, whatever stopped it. It stands where it is from now on.
    pub fn stand(&mut self) {
        self.state.failed = None;
        self.state.drive.restart();
        self.state.controller.stopped();
    }

    /// Whether so many torques were lost in a row on the world's line that the arm stops.
    pub fn has_lost_the_line(&self) -> bool {
        self.state.drive.has_stopped()
    }

    /// What the arm reports of its joints.
    pub fn joint_report(&self) -> JointReport {
        let controller = &self.state.controller;
        let external = self.state.drive.external().map_or_else(
            || {
                let wrench = self.state.wrench;
                crate::sensors::wrist_jacobian(self.hand_tip(), controller.state()).transpose() * wrench
            },
            |external| -external,
        );
        JointReport {
            weight: controller.model().weight(&controller.state().positions).into(),
            external: external.into(),
            received: self.state.drive.received().into(),
        }
    }

    /// The number of control periods after which [`Twin::due_image`] gives an image of this camera. If no
    /// exposure waits for it, the shutters open now.
    ///
    /// # Errors
    /// As [`Robot::look`](ramp_robot::Robot::look).
    pub fn begin_image(&mut self, camera: Camera) -> Result<u64, RobotError> {
        self.check_running()?;
        self.check_images()?;
        let number = self.exposure(camera);
        Ok(self.state.cameras.shutters.available(number).saturating_sub(self.state.steps))
    }

    /// The image for which [`Twin::begin_image`] told the periods, once they have passed, to be drawn on any
    /// thread. Until [`Twin::drawn`] has it back, no other image of this camera is asked for.
    ///
    /// # Errors
    /// As [`Robot::look`](ramp_robot::Robot::look).
    pub fn due_image(&mut self, camera: Camera, width: Option<ImageWidth>) -> Result<Drawing, RobotError> {
        self.check_running()?;
        let number = self.exposure(camera);
        self.drawing(camera, width, number)
    }
}
