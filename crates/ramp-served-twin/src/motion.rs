//! The doings of the arm: it rests, follows the torques of a client, has stopped, or recovers.

use franka::wire::robot::v5;
use franka::{FciVersion, MoveStatus};
use ramp_robot::{DOF, PERIOD};

use crate::state::Commanded;

/// Number of commands lost in a row that stops the arm. From libfranka's documentation.
pub(crate) const MOST_LOST: u32 = 20;
/// Largest rate of a commanded torque, N·m/s. From Franka's specification of the robot.
const TORQUE_RATE: f64 = 1000.0;
/// Share by which the rate may be exceeded, for rounding: the numbers of version 10 have 24 bits, and the
/// largest torque is 87 N·m.
const ROUNDING: f64 = 1e-5;
/// The cycles over which the success rate is reported.
const REPORTED: usize = 100;

/// Modes of the robot in its state. From libfranka's `research_interface`.
pub(crate) mod robot_mode {
    pub const IDLE: u8 = 1;
    pub const MOVE: u8 = 2;
    pub const REFLEX: u8 = 4;
    pub const RECOVERY: u8 = 6;
}

/// The controller mode of a state in which nothing is controlled from outside, and of an external controller.
pub(crate) const CONTROLLER_OTHER: u8 = 3;
pub(crate) const CONTROLLER_EXTERNAL: u32 = 2;

/// Numbers of the motion generators in a request. A state counts them from one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Generator {
    JointPosition,
    JointVelocity,
    CartesianPosition,
    CartesianVelocity,
    None,
}

impl Generator {
    pub const ALL: [Generator; 5] = [
        Generator::JointPosition,
        Generator::JointVelocity,
        Generator::CartesianPosition,
        Generator::CartesianVelocity,
        Generator::None,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Generator::JointPosition => "joint positions",
            Generator::JointVelocity => "joint velocities",
            Generator::CartesianPosition => "Cartesian poses",
            Generator::CartesianVelocity => "Cartesian velocities",
            Generator::None => "torques",
        }
    }
}

/// A motion under torques.
pub(crate) struct Motion {
    /// The request that began it.
    pub command: u32,
    pub id: u32,
    /// Whether its first command has come.
    pub begun: bool,
    /// Number of its cycles.
    pub cycle: u32,
    /// Commands lost in a row.
    lost: u32,
    /// The last torques, N·m: zero before the first.
    pub torques: [f64; DOF],
    /// Whether the last cycles had a command.
    came: std::collections::VecDeque<bool>,
}

/// How a cycle of a motion goes on.
pub(crate) enum Cycle {
    /// The arm waits for the first command, at rest.
    Waits,
    /// These torques act, N·m.
    Acts([f64; DOF]),
    /// The motion ends as the client wished.
    Ends,
    /// The arm stops with the error of this name.
    Stops(&'static str),
}

impl Motion {
    pub fn new(command: u32, id: u32) -> Motion {
        Motion {
            command,
            id,
            begun: false,
            cycle: 0,
            lost: 0,
            torques: [0.0; DOF],
            came: std::collections::VecDeque::new(),
        }
    }

    /// The next cycle, with its command if one came. `received` are the torques (N·m) that the arm
    /// received last: what the line lost counts for nothing.
    pub fn next(&mut self, command: Option<Commanded>, received: &[f64; DOF]) -> Cycle {
        if command.is_none() && !self.begun {
            return Cycle::Waits;
        }
        self.begun = true;
        self.cycle += 1;
        self.came.push_back(command.is_some());
        if self.came.len() > REPORTED {
            self.came.pop_front();
        }
        match command {
            Some(command) => {
                self.lost = 0;
                let most = TORQUE_RATE * PERIOD * (1.0 + ROUNDING);
                let jumps = |joint: usize| {
                    let change = (command.torques[joint] - received[joint]).abs();
                    !change.is_finite() || change > most
                };
                if (0..DOF).any(jumps) {
                    return Cycle::Stops("controller_torque_discontinuity");
                }
                self.torques = command.torques;
                if command.finished { Cycle::Ends } else { Cycle::Acts(self.torques) }
            }
            None => {
                self.lost += 1;
                if self.lost >= MOST_LOST {
                    return Cycle::Stops("communication_constraints_violation");
                }
                Cycle::Acts(self.torques)
            }
        }
    }

    /// The share of the last cycles that had a command.
    pub fn success_rate(&self) -> f64 {
        let came = self.came.iter().filter(|came| **came).count();
        came as f64 / self.came.len().max(1) as f64
    }
}

/// The doing of the arm.
pub(crate) enum Doing {
    Rest,
    Move(Motion),
    Stopped,
    /// It recovers for so many more cycles; then the request is answered.
    Recover {
        cycles: u64,
        command: u32,
        id: u32,
    },
}

/// Numbers of the statuses that end a motion, by version.
pub(crate) fn status(version: FciVersion, status: MoveStatus) -> u8 {
    match (version, status) {
        (FciVersion::V5, MoveStatus::ReflexAborted) => v5::MoveStatus::ReflexAborted.to_u8(),
        (FciVersion::V5, MoveStatus::CommandNotPossibleRejected) => {
            v5::MoveStatus::CommandNotPossibleRejected.to_u8()
        }
        _ => status.to_u8(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REST: [f64; DOF] = [0.0; DOF];

    fn command(torque: f64) -> Option<Commanded> {
        Some(Commanded { message: 0, torques: [torque; DOF], finished: false })
    }

    /// Nineteen lost commands go on under the last torques; the twentieth stops the arm.
    #[test]
    fn twenty_lost_commands_stop_the_arm() {
        let mut motion = Motion::new(1, 1);
        assert!(matches!(motion.next(None, &REST), Cycle::Waits), "nothing is lost before the first command");
        assert!(matches!(motion.next(command(0.5), &[0.5; DOF]), Cycle::Acts(_)));
        for _ in 0..19 {
            assert!(matches!(motion.next(None, &REST), Cycle::Acts(torques) if torques == [0.5; DOF]));
        }
        assert!(matches!(motion.next(command(0.5), &[0.5; DOF]), Cycle::Acts(_)));
        for _ in 0..19 {
            assert!(matches!(motion.next(None, &REST), Cycle::Acts(_)));
        }
        assert!(matches!(motion.next(None, &REST), Cycle::Stops("communication_constraints_violation")));
    }

    /// Torques begin at zero and change by a newton metre a cycle at most.
    #[test]
    fn torques_that_jump_stop_the_arm() {
        for torques in [&[1.1][..], &[0.9, 2.0], &[f64::NAN]] {
            let mut motion = Motion::new(1, 1);
            let (last, before) = torques.split_last().unwrap_or((&0.0, &[]));
            let mut received = REST;
            for torque in before {
                assert!(matches!(motion.next(command(*torque), &received), Cycle::Acts(_)));
                received = [*torque; DOF];
            }
            assert!(matches!(
                motion.next(command(*last), &received),
                Cycle::Stops("controller_torque_discontinuity")
            ));
        }
    }

    /// After commands that the line lost, the next one goes on from what the arm has.
    #[test]
    fn lost_torques_are_no_reference() {
        let mut motion = Motion::new(1, 1);
        assert!(matches!(motion.next(command(0.9), &REST), Cycle::Acts(_)));
        assert!(matches!(motion.next(command(-0.9), &REST), Cycle::Acts(_)));
        assert!(matches!(
            motion.next(command(-0.9), &[0.9; DOF]),
            Cycle::Stops("controller_torque_discontinuity")
        ));
    }
}
