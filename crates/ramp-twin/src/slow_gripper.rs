//! A gripper that takes its time: between a command and the motion of the fingers passes a dead time, what it has begun it
//! finishes, and it tells its width a few times a second.

use ramp_robot::{GripperCommand, PERIOD};
use ramp_world::groups::Gripper;

/// Fingers that move less than this in a period are still, m.
const STILL: f64 = 2e-6;
/// For so many periods they must be still until a motion counts as finished. Chosen: a rib that slides into a slot pauses.
const STILL_PERIODS: u32 = 60;
/// A motion is finished after so many periods at the latest: the longest takes 0.8 s.
const LONGEST: u32 = 2000;

/// What the gripper is at.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// It holds what it was told last.
    Done,
    /// It has heard a command, and does nothing yet: for so many periods more.
    Dead(u32),
    /// Its fingers move: for so many periods so far, and still for so many.
    Moving(u32, u32),
}

/// A gripper with a dead time.
#[derive(Clone, Debug)]
pub(crate) struct SlowGripper {
    /// In periods.
    dead_time: u32,
    told_every: u32,
    stage: Stage,
    /// What the fingers do, and what they have been told to do next.
    done: GripperCommand,
    heard: GripperCommand,
    /// The width that was told last, m, and so many periods ago.
    width: f64,
    told: u32,
    last_width: f64,
}

impl SlowGripper {
    /// With the fingers at `width` (m).
    pub fn new(gripper: &Gripper, width: f64) -> SlowGripper {
        let start = GripperCommand { width, force: 10.0 };
        SlowGripper {
            dead_time: (gripper.dead_time / PERIOD).round() as u32,
            told_every: ((gripper.told_every / PERIOD).round() as u32).max(1),
            stage: Stage::Done,
            done: start,
            heard: start,
            width,
            told: 0,
            last_width: width,
        }
    }

    /// What the fingers are to do in this period, when `command` is commanded.
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

    /// After a period: where the fingers are, m. Returns the width that is told, m, and whether the gripper is still at it.
    pub fn sensed(&mut self, width: f64, command: GripperCommand) -> (f64, bool) {
        if self.told == 0 {
            self.width = width;
        }
        self.told = (self.told + 1) % self.told_every;
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
        let mut gripper = SlowGripper::new(&Gripper { dead_time: 0.5, told_every: 0.1 }, 0.04);
        let command = |width| GripperCommand { width, force: 20.0 };
        let (mut width, mut began, mut ended) = (0.04, None, None);
        let mut told = Vec::new();
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
            if told.last() != Some(&known) {
                told.push(known);
            }
        }
        assert_eq!(began, Some(501));
        // Closed at 700, still for 60 periods, dead for 500, 400 to open, still again.
        assert!(matches!(ended, Some(1650..1760)), "{ended:?}");
        assert!(told.len() < 20, "{told:?}");
    }
}
