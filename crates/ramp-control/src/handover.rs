//! From one kind of command to another without a jump of torque, and the limit of how fast torques may
//! change.
//!
//! A joint that is tracked stiffly and a tip that is held softly want different torques of the same arm.
//! [`Handover`] carries the difference over and lets it fade.

use ramp_robot::{ArmCommand, PERIOD};

use crate::state::JointVector;

/// Time constant with which the difference decays, s. Chosen: a tenth of a settling motion.
const FADE: f64 = 0.03;

/// The kinds of commands that want torques of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Joint positions are tracked.
    Positions,
    /// Joint velocities are.
    Velocities,
    /// The tip is held, stiffly or softly.
    Tip,
    /// Torques are commanded.
    Torques,
}

impl Mode {
    /// That of a command.
    pub fn of(command: &ArmCommand) -> Mode {
        match command {
            ArmCommand::JointPositions(_) => Mode::Positions,
            ArmCommand::JointVelocities(_) => Mode::Velocities,
            ArmCommand::CartesianPose(_) | ArmCommand::CartesianImpedance(_) => Mode::Tip,
            ArmCommand::JointTorques(_) => Mode::Torques,
        }
    }
}

/// Torque difference carried over from the previous mode.
#[derive(Clone, Debug, Default)]
pub struct Handover {
    mode: Option<Mode>,
    last: JointVector,
    carried: JointVector,
}

impl Handover {
    /// The torques (N·m) to command in place of those that `mode` wants. Torques that are commanded pass as
    /// they are.
    pub fn over(&mut self, mode: Mode, wanted: &JointVector) -> JointVector {
        if self.mode.is_some_and(|before| before != mode) {
            self.carried = self.last - wanted;
        }
        self.mode = Some(mode);
        if mode == Mode::Torques {
            self.carried = JointVector::zeros();
        }
        self.last = wanted + self.carried;
        self.carried *= (-PERIOD / FADE).exp();
        self.last
    }

    /// The torques of the last period, N·m; zero before the first, as a real arm demands.
    pub fn last(&self) -> JointVector {
        self.last
    }
}

/// `wanted` (N·m), as near as torques come to it in one period from `before` when they change by `rate`
/// (N·m/s) at most.
pub fn limit_rate(before: &JointVector, wanted: &JointVector, rate: f64) -> JointVector {
    let step = rate * PERIOD;
    wanted.zip_map(before, |wanted, before| wanted.clamp(before - step, before + step))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_mode_begins_where_the_last_one_ended() {
        let mut handover = Handover::default();
        let (stiff, soft) = (JointVector::repeat(8.0), JointVector::repeat(1.0));
        assert_eq!(handover.over(Mode::Positions, &stiff), stiff);
        assert_eq!(handover.over(Mode::Tip, &soft), stiff);
        let mut last = stiff;
        for _ in 0..300 {
            let now = handover.over(Mode::Tip, &soft);
            assert!((now - last).amax() < 1.0, "a jump of {} N·m", (now - last).amax());
            last = now;
        }
        assert!((last - soft).amax() < 1e-3);
    }
}
