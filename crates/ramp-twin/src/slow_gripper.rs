//! A gripper with a dead time between a command and the motion of the fingers. It finishes a motion before it
//! starts the next, and reports its width a few times a second.

use ramp_robot::{GripperCommand, PERIOD};
use ramp_world::groups::Gripper;

/// Fingers that move less than this in a period are still, m.
const STILL: f64 = 2e-6;
/// Number of still periods after which a motion counts as finished. Chosen: a rib that slides into a slot
/// pauses.
const STILL_PERIODS: u32 = 60;
/// Largest number of periods of a motion: the longest takes 0.8 s.
const LONGEST: u32 = 2000;

/// Stage of the gripper.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// It holds the last command.
    Done,
    /// It has received a command and does nothing for this number of periods.
    Dead(u32),
    /// Its fingers move: number of periods so far, and number of still ones at the end.
    Moving(u32, u32),
}

/// A gripper with a dead time.
#[derive(Clone, Debug)]
pub(crate) struct SlowGripper {
    /// In periods.
    dead_time: u32,
    report_every: u32,
    stage: Stage,
    /// Command that the fingers execute, and the last one received.
    done: GripperCommand,
    heard: GripperCommand,
    /// Last reported width, m, and number of periods since.
    width: f64,
    since_report: u32,
    last_width: f64,
}

impl SlowGripper {
    /// With the fingers at `width` (m).
    pub fn new(gripper: &Gripper, width: f64) -> SlowGripper {
        let start = GripperCommand { width, force: 10.0 };
        SlowGripper {
            dead_time: (gripper.dead_time / PERIOD).round() as u32,
            report_every: ((gripper.told_every / PERIOD).round() as u32).max(1),
            stage: Stage::Done,
            done: start,
            heard: start,
            width,
            since_report: 0,
            last_width: width,
        }
    }

    /// The command that the fingers execute in this period, when the agent commands `command`.
    pub fn step(&mut self, command: GripperCommand) -> GripperCommand {
        if self.dead_time == 0 {
            return command;
        }
        self.stage = match self.stage {
            Stage::Done if command == self.heard => Stage::Done,
            Stage::Done => {
                self.heard = command;
                Stage::Dead(self.dead_time)
            }
            Stage::Dead(0) => {
                self.done = self.heard;
                Stage::Moving(0, 0)
            }
            Stage::Dead(left) => Stage::Dead(left - 1),
            moving @ Stage::Moving(..) => moving,
        };
        self.done
    }

    /// Takes the true `width` (m) after a period. Returns the reported width, m, and whether the gripper is
    /// still busy.
    pub fn sensed(&mut self, width: f64, command: GripperCommand) -> (f64, bool) {
        if self.since_report == 0 {
            self.width = width;
        }
        self.since_report = (self.since_report + 1) % self.report_every;
        if let Stage::Moving(periods, still) = self.stage {
            let still = if (width - self.last_width).abs() < STILL { still + 1 } else { 0 };
            self.stage = if still >= STILL_PERIODS || periods >= LONGEST {
                // A motion ends with an answer that holds the width.
                self.width = width;
                Stage::Done
            } else {
                Stage::Moving(periods + 1, still)
            };
        }
        self.last_width = width;
        let busy = self.dead_time > 0 && (self.stage != Stage::Done || command != self.heard);
        (self.width, busy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After a command nothing moves for the dead time; a second command waits until the first is done.
    #[test]
    fn a_command_is_heard_late_and_finished() {
        let mut gripper =
            SlowGripper::new(&Gripper { dead_time: 0.5, told_every: 0.1, width_step: 0.0 }, 0.04);
        let command = |width| GripperCommand { width, force: 20.0 };
        let (mut width, mut began, mut ended) = (0.04, None, None);
        let mut reported = Vec::new();
        for period in 0..3000 {
            // The program closes, and opens again 100 ms later.
            let wanted = command(if period < 100 { 0.02 } else { 0.06 });
            let aim = gripper.step(wanted).width;
            width += (aim - width).clamp(-1e-4, 1e-4);
            let (known, busy) = gripper.sensed(width, wanted);
            if began.is_none() && width < 0.04 {
                began = Some(period);
            }
            if ended.is_none() && width > 0.0599 && !busy {
                ended = Some(period);
            }
            if reported.last() != Some(&known) {
                reported.push(known);
            }
        }
        assert_eq!(began, Some(501));
        // Closed at 700, still for 60 periods, dead for 500, 400 to open, still again.
        assert!(matches!(ended, Some(1650..1760)), "{ended:?}");
        assert!(reported.len() < 20, "{reported:?}");
    }
}
