//! The controller of an arm that takes torques: from the commands of an agent to the torques of one period,
//! and from what the arm reports to the state of the next one.
//!
//! The twin and a real arm are driven by the same type. In each period, [`ArmController::torques`] turns a
//! command into torques, or [`ArmController::late`] holds the last command when no new one has come. The arm
//! gets the torques, and [`ArmController::sensed`] takes what it reports afterwards.

use std::sync::Arc;

use ramp_robot::arm::ArmModel;
use ramp_robot::{ArmCommand, DOF, PERIOD, RobotError};

use crate::compensation::Compensation;
use crate::handover::{Handover, Mode, limit_rate};
use crate::joints::limit_torques;
use crate::model::StateModel;
use crate::state::{ArmState, JointVector};
use crate::targets::Targets;

/// Share by which a limit may be exceeded, for rounding.
const ROUNDING: f64 = 1e-6;

/// The knowledge of a controller about its arm beside the arm file.
#[derive(Clone, Debug, PartialEq)]
pub struct ControllerSettings {
    /// Inertia of each drive at its joint, kg·m².
    pub armature: JointVector,
    /// Dry friction of each joint, N·m. The compensation adds twice as much at most.
    pub friction: JointVector,
    /// The share of the measured friction that is compensated, 0 to 1.
    pub compensation: f64,
    /// The rate at which the compensation follows what is measured, 1/s.
    pub compensation_rate: f64,
    /// The largest rate of a torque, N·m/s; `None` for an arm without such a limit, which needs no handover
    /// between kinds of commands either.
    pub torque_rate: Option<f64>,
}

/// The report of an arm after a period.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensed {
    /// rad.
    pub positions: JointVector,
    /// rad/s.
    pub velocities: JointVector,
    /// Torques on the links without those that hold the arm up, N·m.
    pub torques: JointVector,
    /// The torques that the arm received last, N·m. They are not those that were sent last if these were
    /// lost.
    pub received: JointVector,
}

/// Drives an arm by torques.
#[derive(Clone, Debug)]
pub struct ArmController {
    arm: Arc<ArmModel>,
    model: StateModel,
    torque_rate: Option<f64>,
    state: ArmState,
    targets: Targets,
    handover: Handover,
    compensation: Compensation,
    /// The torques that the arm received last, N·m.
    received: JointVector,
}

/// A commanded motion that a stop interrupted.
#[derive(Clone, Debug)]
pub struct Interrupted(Targets);

impl ArmController {
    /// A controller of `arm`, which is at rest at these joint positions (rad).
    pub fn new(arm: &ArmModel, settings: &ControllerSettings, positions: &JointVector) -> ArmController {
        let model = StateModel::new(arm, settings.armature);
        let ControllerSettings { friction, compensation, compensation_rate, .. } = settings;
        ArmController {
            arm: Arc::new(arm.clone()),
            state: model.state(positions, &JointVector::zeros()),
            model,
            torque_rate: settings.torque_rate,
            targets: Targets::new(&arm.home),
            handover: Handover::default(),
            compensation: Compensation::new(*compensation, *compensation_rate, friction),
            received: JointVector::zeros(),
        }
    }

    /// The arm as it was sensed last.
    pub fn state(&self) -> &ArmState {
        &self.state
    }

    /// The model from which the state is computed.
    pub fn model(&self) -> &StateModel {
        &self.model
    }

    /// The torques to send for one period of a command, on top of those that hold the arm up, N·m.
    ///
    /// # Errors
    /// [`RobotError::NotSmooth`] for a command that the arm cannot follow from the one before, and
    /// [`RobotError::TorqueJump`] for torques that change faster than the arm allows.
    pub fn torques(&mut self, command: &ArmCommand) -> Result<JointVector, RobotError> {
        let wanted = self.targets.torques(&self.arm, &self.state, command)?;
        if let (ArmCommand::JointTorques(_), Some(rate)) = (command, self.torque_rate) {
            self.check_rate(&wanted, rate)?;
        }
        Ok(self.limited(Mode::of(command), wanted))
    }

    /// The torques to send for a period in which no command has come, N·m: the last command holds, and the
    /// velocity of its target fades. Before the first command the arm is held at home. A commanded motion may
    /// continue afterwards as if no period had passed.
    pub fn late(&mut self) -> JointVector {
        let (mode, wanted) = self.targets.late(&self.arm, &self.state);
        self.limited(mode, wanted)
    }

    /// The torques with which the arm itself holds where it was [`stopped`](ArmController::stopped), N·m. Its
    /// own controller brakes at once, needs no limit of the torques' rate and compensates no friction.
    pub fn hold(&mut self) -> JointVector {
        limit_torques(&self.arm, self.targets.held(&self.state))
    }

    /// Takes what the arm reports after a period.
    pub fn sensed(&mut self, sensed: &Sensed) {
        let accelerations = (sensed.velocities - self.state.velocities) / PERIOD;
        let drives = self.model.armature().component_mul(&accelerations);
        self.compensation.sensed(&sensed.received, &sensed.torques, &drives);
        self.received = sensed.received;
        self.state = self.model.state(&sensed.positions, &sensed.velocities);
    }

    /// Begins anew after a stop of the arm: [`ArmController::late`] holds it where it is. The result is what
    /// was commanded, for [`ArmController::resume`].
    pub fn stopped(&mut self) -> Interrupted {
        self.handover = Handover::default();
        self.received = JointVector::zeros();
        let standing = Targets::standing(&self.state.positions);
        Interrupted(std::mem::replace(&mut self.targets, standing))
    }

    /// Lets an interrupted motion continue from where the arm stands now.
    pub fn resume(&mut self, interrupted: Interrupted) {
        self.targets = interrupted.0.begun_anew();
    }

    /// Torques to send in place of those that the inner loop of `mode` wants, N·m.
    fn limited(&mut self, mode: Mode, wanted: JointVector) -> JointVector {
        let Some(rate) = self.torque_rate else {
            return limit_torques(&self.arm, wanted + self.compensation.torques());
        };
        let torques = self.handover.over(mode, &wanted);
        let torques = limit_torques(&self.arm, torques + self.compensation.torques());
        // The limit counts from what the arm has: commands may have been lost.
        limit_rate(&self.received, &torques, rate)
    }

    fn check_rate(&self, torques: &JointVector, limit: f64) -> Result<(), RobotError> {
        let before = self.handover.last();
        for joint in 0..DOF {
            let rate = (torques[joint] - before[joint]).abs() / PERIOD;
            if rate > limit * (1.0 + ROUNDING) {
                return Err(RobotError::TorqueJump { joint: joint + 1, rate, limit });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use std::path::Path;

    use super::*;

    const RATE: f64 = 1000.0;

    /// An arm without friction that does what torques ask of it.
    struct Ideal {
        controller: ArmController,
        received: JointVector,
    }

    impl Ideal {
        fn at_home() -> (ArmModel, Ideal) {
            let arm: ArmModel = ArmModel::read(Path::new("../../data/arms/fr3.json")).unwrap();
            let settings = ControllerSettings {
                armature: JointVector::repeat(0.2),
                friction: JointVector::zeros(),
                compensation: 0.0,
                compensation_rate: 50.0,
                torque_rate: Some(RATE),
            };
            let controller = ArmController::new(&arm, &settings, &arm.home.into());
            (arm, Ideal { controller, received: JointVector::zeros() })
        }

        /// One period under torques that arrive.
        fn moves(&mut self, torques: JointVector) {
            self.received = torques;
            let state = self.controller.state().clone();
            let accelerations = state.inertia.cholesky().unwrap().solve(&torques);
            let velocities = state.velocities + accelerations * PERIOD;
            let positions = state.positions + velocities * PERIOD;
            self.reports(positions, velocities);
        }

        fn reports(&mut self, positions: JointVector, velocities: JointVector) {
            let received = self.received;
            self.controller.sensed(&Sensed { positions, velocities, torques: received, received });
        }

        fn velocities(&self) -> JointVector {
            self.controller.state().velocities
        }
    }

    /// Joint 1 after so many periods of a motion that begins gently, then goes on with 0.3 rad/s.
    fn course(arm: &ArmModel, period: u32) -> ArmCommand {
        let time = f64::from(period) * PERIOD;
        let mut positions = arm.home;
        positions[0] += if time < 0.3 { 0.5 * time * time } else { 0.045 + 0.3 * (time - 0.3) };
        ArmCommand::JointPositions(positions)
    }

    /// Without a new command the arm brakes and stays near its last target. Then the motion goes on as if no
    /// time had passed.
    #[test]
    fn an_arm_without_commands_brakes_and_its_motion_may_go_on() {
        let (arm, mut robot) = Ideal::at_home();
        for period in 1..500 {
            let torques = robot.controller.torques(&course(&arm, period)).unwrap();
            robot.moves(torques);
        }
        assert!((robot.velocities()[0] - 0.3).abs() < 0.01, "{}", robot.velocities()[0]);
        for _ in 0..500 {
            let torques = robot.controller.late();
            robot.moves(torques);
        }
        let ArmCommand::JointPositions(target) = course(&arm, 499) else { panic!("no positions") };
        assert!(robot.velocities().amax() < 1e-3, "{}", robot.velocities());
        let off = robot.controller.state().positions - JointVector::from(target);
        assert!(off.amax() < 2e-3, "{off}");
        for period in 500..1000 {
            let torques = robot.controller.torques(&course(&arm, period)).unwrap();
            robot.moves(torques);
        }
        assert!((robot.velocities()[0] - 0.3).abs() < 0.01, "{}", robot.velocities()[0]);
    }

    /// An arm that something throws as it stops brakes at once, and stays where it comes to rest. With a
    /// target that slows down as a motion may, it would swing for long.
    #[test]
    fn an_arm_that_is_thrown_as_it_stops_is_held() {
        let (arm, mut robot) = Ideal::at_home();
        let home = JointVector::from(arm.home);
        let thrown = JointVector::from([2.0, -2.0, 2.0, 2.0, -3.0, 4.0, 3.0]);
        robot.reports(home, thrown);
        robot.controller.stopped();
        let mut farthest = JointVector::zeros();
        for _ in 0..400 {
            let torques = robot.controller.hold();
            robot.moves(torques);
            farthest = farthest.sup(&(robot.controller.state().positions - home).abs());
        }
        assert!(robot.velocities().amax() < 0.1, "{}", robot.velocities());
        // A motion begins where the arm stands by then, as its encoders tell it.
        let begin = robot.controller.state().positions.map(|it| it + 5e-5);
        robot.controller.stopped();
        assert!(robot.controller.torques(&ArmCommand::JointPositions(begin.into())).is_ok());
        let back = farthest - (robot.controller.state().positions - home).abs();
        assert!(farthest.amax() < 0.5 && back.amax() < 0.05, "{farthest}{back}");
    }

    /// A single late command hardly slows the arm.
    #[test]
    fn one_late_command_is_hardly_felt() {
        let (arm, mut robot) = Ideal::at_home();
        let mut slowest = f64::MAX;
        for period in 1..800 {
            if period == 500 {
                let torques = robot.controller.late();
                robot.moves(torques);
            }
            let torques = robot.controller.torques(&course(&arm, period)).unwrap();
            robot.moves(torques);
            if period > 400 {
                slowest = slowest.min(robot.velocities()[0]);
            }
        }
        assert!(slowest > 0.27, "{slowest}");
    }

    /// The arm refuses torques that differ too much from those that it has, not from those that were lost.
    #[test]
    fn the_rate_of_torques_counts_from_what_the_arm_received() {
        let (arm, mut robot) = Ideal::at_home();
        let mut far = arm.home;
        far[0] += 0.009;
        let command = ArmCommand::JointPositions(far);
        for _ in 0..5 {
            // All are lost: the arm has no torque, and stands.
            let torques = robot.controller.torques(&command).unwrap();
            assert!(torques.amax() <= RATE * PERIOD * 1.0001, "{torques}");
            robot.reports(arm.home.into(), JointVector::zeros());
        }
    }
}
