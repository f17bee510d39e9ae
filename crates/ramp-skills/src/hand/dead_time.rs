//! Measures the dead time of a gripper.

use ramp_robot::Observation;

/// Change of the width at which fingers have begun to move, m. Chosen: above the give of a held part.
const MOVED: f64 = 0.5e-3;
/// Least speed of the width as the fingers begin to move, m/s: half the speed of the two fingers of a Franka
/// hand.
const SLOWEST_FINGERS: f64 = 0.05;
/// The dead time of a gripper after a command, from the widths that it reports: never overestimated, and 0
/// until one was measured.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DeadTime {
    /// s.
    pub(super) least: Option<f64>,
    /// Time of the command that the gripper has not begun to follow (s), and the width then, m.
    waits: Option<(f64, f64)>,
}

impl DeadTime {
    /// A new command. A busy gripper follows it later: its dead time cannot be measured.
    pub(super) fn commanded(&mut self, seen: &Observation) {
        self.waits = (!seen.gripper_busy).then_some((seen.time, seen.width));
    }

    /// A width reported at a time, by a gripper that reports every `told_every` (s).
    pub(super) fn sensed(&mut self, time: f64, width: f64, told_every: f64) {
        let Some((since, before)) = self.waits else { return };
        if (width - before).abs() > MOVED {
            let least = (time - since - told_every - MOVED / SLOWEST_FINGERS).max(0.0);
            self.least = Some(self.least.map_or(least, |it| it.min(least)));
            self.waits = None;
        }
    }
}
