//! One step: watches for the occasion, and continues a fault that has struck.

use super::state::{Action, Data, Injector};
use crate::fault::act::Progress;
use ramp_kit::Pose;
use ramp_robot::GripperCommand;
use ramp_robot::PERIOD;

/// Share of the fingers' force that remains while a part is moved in the grip.
const WEAKENED: f64 = 0.15;

impl Injector {
    /// Before each step of the physics: `fingers` are the width of the hand, m, and the speed at which it
    /// opens, m/s. Returns the command that the gripper executes.
    pub fn step(
        &mut self,
        data: &mut Data,
        x_wt: &Pose,
        steps: u64,
        fingers: [f64; 2],
        mut gripper: GripperCommand,
    ) -> GripperCommand {
        let time = steps as f64 * PERIOD;
        if steps.is_multiple_of(self.watch.every()) && !matches!(self.action, Action::Over) {
            let occasion = self.watch.look(&self.bodies, data, x_wt, fingers[1]);
            if let Some(occasion) = occasion.filter(|_| matches!(self.action, Action::Waiting)) {
                self.count += 1;
                if self.count >= self.draws.occasion {
                    self.strike(&occasion, data, time, fingers[0]);
                }
            }
        }
        self.action = match std::mem::replace(&mut self.action, Action::Over) {
            Action::Lifted { part, left } if left > 0.0 => Action::Lifted { part, left: left - PERIOD },
            Action::Lifted { part, .. } => self.strike_in_grip(part, data, x_wt, time),
            Action::Limp { left } if left > 0.0 => {
                gripper.force = 0.0;
                Action::Limp { left: left - PERIOD }
            }
            Action::InGrip { push, other } => {
                if push.pushes() {
                    gripper.force *= WEAKENED;
                }
                self.push_in_grip(push, other, data, x_wt)
            }
            Action::Bump { push, part, at, left } => self.bump(push, part, at, left, data, x_wt),
            Action::Shift(mut push) => {
                let progress = push.step(data, x_wt);
                self.report.size = Some(push.gone());
                if matches!(progress, Progress::Over(_)) { Action::Over } else { Action::Shift(push) }
            }
            Action::Jam(mut obstacle) => {
                if obstacle.step(data) {
                    Action::Jam(obstacle)
                } else {
                    Action::Over
                }
            }
            Action::Frozen { left } if left > 0.0 => Action::Frozen { left: left - PERIOD },
            Action::Short { width } if gripper.width < width => {
                gripper.width = width;
                Action::Short { width }
            }
            Action::Drift { force, growth, most, direction } => {
                Action::Drift { force: (force + growth * PERIOD).min(most), growth, most, direction }
            }
            Action::Waiting => Action::Waiting,
            _ => Action::Over,
        };
        gripper
    }
}
