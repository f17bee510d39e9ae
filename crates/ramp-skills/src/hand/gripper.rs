//! Opens and closes the gripper, and waits for it.

use ramp_robot::{GripperCommand, PERIOD, RobotError};

use super::access::Hand;
use crate::fault::SkillError;

/// The longest wait for a gripper, periods.
const SLOWEST_GRIPPER: u32 = 10_000;
impl Hand<'_> {
    /// Opens or closes to `width` (m) with at most `force` (N) and waits until the fingers are still or,
    /// where they open, nearly as wide.
    ///
    /// # Errors
    /// [`Fault::Overload`](crate::Fault::Overload), and the robot's.
    pub fn grip(&mut self, width: f64, force: f64) -> Result<(), SkillError> {
        self.gripper = GripperCommand { width, force };
        let opens = width > self.seen.width;
        let mut still = 0;
        let mut before = self.seen.width;
        let mut period = 0;
        let mut busy = 0;
        while period < 3000 {
            self.tick()?;
            // A gripper that reports when it is done need not be watched.
            if self.seen.gripper_busy && busy < SLOWEST_GRIPPER {
                busy += 1;
                continue;
            }
            if busy > 0 {
                break;
            }
            period += 1;
            // Fingers that are as far open as they were told to are not waited for.
            if opens && width - self.seen.width < self.parameters.opened {
                break;
            }
            still = if (self.seen.width - before).abs() < 2e-6 { still + 1 } else { 0 };
            before = self.seen.width;
            // Fingers that squeeze a part hold still for a while before they open.
            let unloading = opens && period <= 600 && width - self.seen.width > self.parameters.opened;
            if still > (self.parameters.still / PERIOD).round() as u32 && !unloading {
                break;
            }
        }
        Ok(())
    }

    /// Commands the fingers to open if they are known to follow a command only after a dead time of at least
    /// `within`, s. Returns the robot time (s) until which they surely stay as they are; `None` if nothing
    /// was commanded.
    pub fn open_ahead(&mut self, width: f64, force: f64, within: f64) -> Option<f64> {
        let least = self.dead_time.least.filter(|least| !self.seen.gripper_busy && *least > within)?;
        self.gripper = GripperCommand { width, force };
        Some(self.time() + least)
    }

    /// Whether the fingers are commanded to open wider than they are.
    pub fn opens(&self) -> bool {
        self.gripper.width > self.seen.width + self.parameters.opened
    }

    /// Repeats the last command until the gripper has carried out its command.
    ///
    /// # Errors
    /// The robot's.
    pub fn wait_for_gripper(&mut self) -> Result<(), RobotError> {
        for _ in 0..SLOWEST_GRIPPER {
            if !self.seen.gripper_busy {
                break;
            }
            self.hold(PERIOD)?;
        }
        Ok(())
    }
}
