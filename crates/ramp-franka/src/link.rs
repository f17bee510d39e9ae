//! The arm over the wire, one period with each call. Nothing runs between the calls.

use franka::robot::ActiveTorqueControl;
use franka::{RobotState, Torques};
use nalgebra::{Vector3, Vector6};
use ramp_control::{ArmController, ControllerSettings, JointVector, Sensed, check_command};
use ramp_robot::arm::ArmModel;
use ramp_robot::{Command, GripperCommand, Observation, PERIOD};

use crate::error::FrankaError;
use crate::gripper::Gripper;

/// A motion under torques, with the gripper.
pub(crate) struct Link<'r> {
    control: ActiveTorqueControl<'r>,
    gripper: Gripper,
    controller: ArmController,
    /// Distance from the wrist to the tip along the hand's z, m.
    tip: f64,
    state: RobotState,
    gripper_command: GripperCommand,
    busy: bool,
    /// The number of timeouts of the client library, of a second each, after which an arm counts as dead.
    patience: u32,
    /// The number of the arm's state that the first command answered: a millisecond each; `None` before it.
    begin: Option<u64>,
}

impl<'r> Link<'r> {
    /// Begins a motion of `robot`.
    pub fn begin(
        robot: &'r franka::Robot,
        gripper: Gripper,
        arm: &ArmModel,
        settings: &ControllerSettings,
        patience: u32,
    ) -> Result<Link<'r>, FrankaError> {
        let mut control = robot.start_torque_control()?;
        let (state, _) = control.read_once()?;
        let gripper_command = GripperCommand { width: gripper.width, force: 0.0 };
        Ok(Link {
            control,
            gripper,
            controller: ArmController::new(arm, settings, &JointVector::from(state.q)),
            tip: arm.hand.tip,
            begin: None,
            state,
            gripper_command,
            busy: false,
            patience,
        })
    }

    /// The number of the arm's state to which the first command was the answer: a millisecond each.
    pub fn first_message(&self) -> u64 {
        self.begin.unwrap_or_else(|| number(&self.state))
    }

    /// One period under a command, or, if none has come in time, under the last one.
    ///
    /// # Errors
    /// The command is refused before anything is sent, or the arm has stopped.
    pub fn period(&mut self, command: Option<&Command>) -> Result<(), FrankaError> {
        if self.begin.is_none() {
            // The arm's states went on since the motion began, and a command must answer the newest.
            self.state = self.read()?;
            self.begin = Some(number(&self.state));
        }
        let torques = match command {
            Some(command) => {
                check_command(command)?;
                self.gripper_command = command.gripper;
                self.controller.torques(&command.arm)?
            }
            None => self.controller.late(),
        };
        if self.gripper_command.force > 0.0 {
            self.busy = self.gripper.cycle(&self.gripper_command)?;
        }
        self.control.write_once(&Torques::new(torques.into()))?;
        self.state = self.read()?;
        let positions = JointVector::from(self.state.q);
        let weight = self.controller.model().weight(&positions);
        self.controller.sensed(&Sensed {
            positions,
            velocities: JointVector::from(self.state.dq),
            torques: JointVector::from(self.state.tau_J) - weight,
            received: JointVector::from(self.state.tau_J_d),
        });
        Ok(())
    }

    /// The next state.
    fn read(&mut self) -> Result<RobotState, FrankaError> {
        let mut timeouts = 0;
        loop {
            match self.control.read_once() {
                Err(franka::FrankaError::Network(_)) if timeouts + 1 < self.patience => timeouts += 1,
                other => return Ok(other?.0),
            }
        }
    }

    /// What the arm reported last.
    pub fn observe(&self) -> Observation {
        let state = self.controller.state();
        let wrench = self.state.O_F_ext_hat_K;
        let force = Vector3::new(wrench[0], wrench[1], wrench[2]);
        // Franka tells the wrench at the tip, an observation has it at the wrist.
        let lever = state.x_wt.rotation * Vector3::z() * self.tip;
        let moment = Vector3::new(wrench[3], wrench[4], wrench[5]) + lever.cross(&force);
        let weight = self.controller.model().weight(&state.positions);
        Observation {
            time: number(&self.state).saturating_sub(self.first_message()) as f64 * PERIOD,
            positions: state.positions.into(),
            velocities: state.velocities.into(),
            torques: (JointVector::from(self.state.tau_J) - weight).into(),
            x_wt: state.x_wt,
            wrench: Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z),
            width: self.gripper.width,
            gripper_busy: self.busy,
            touch: None,
        }
    }

    /// Ends the motion: the arm stays where it is.
    pub fn end(&mut self) -> Result<(), FrankaError> {
        let last = franka::motion_finished(Torques::new(self.state.tau_J_d));
        Ok(self.control.write_once(&last)?)
    }
}

/// The number of a state. The client library tells it as a time.
fn number(state: &RobotState) -> u64 {
    (state.time.as_secs_f64() / PERIOD).round() as u64
}
