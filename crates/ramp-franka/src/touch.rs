//! Tactile sensors in the fingers: of a real arm by a driver, of a served twin by its cell.

use ramp_robot::Touch;

use crate::cell_client::Cell;
use crate::connection::Pace;
use crate::error::FrankaError;

/// Time between two readings of a cell, s: that of the twin's sensors.
const EVERY: f64 = 0.01;

/// A driver of the tactile sensors in both fingers. The program has none of its own: implement this for the
/// sensors that are mounted, and give it to [`FrankaRobot::with_touch`](crate::FrankaRobot::with_touch).
pub trait TouchSource: Send {
    /// The newest reading, without waiting for another one; `None` while there is none. Forces are those of
    /// the fingers on what they touch, N, and places m, in axes of the tip.
    fn newest(&mut self) -> Option<Touch>;
}

/// The sensors of a served twin, which its cell tells.
pub(crate) struct CellTouch {
    newest: Touch,
    /// Time of the last question, s.
    asked: f64,
}

impl CellTouch {
    /// Of a cell, at a time (s); `None` without sensors.
    ///
    /// # Errors
    /// When the cell does not answer.
    pub fn of(cell: &mut Cell, time: f64) -> Result<Option<CellTouch>, FrankaError> {
        cell.ask_touch()?;
        Ok(cell.touch_asked()?.map(|newest| CellTouch { newest, asked: time }))
    }

    /// The newest reading at a time, s. In lock step the twin stands still until it has answered; in real
    /// time its answer is taken up a period later, so that the arm does not wait for it.
    ///
    /// # Errors
    /// When the cell does not answer.
    pub fn newest(&mut self, cell: &mut Cell, time: f64, pace: Pace) -> Result<Touch, FrankaError> {
        if let Some(touch) = cell.touch_asked()? {
            self.newest = touch;
        }
        if time - self.asked > EVERY - 1e-6 {
            self.asked = time;
            cell.ask_touch()?;
            if pace == Pace::LockStep {
                self.newest = cell.touch_asked()?.unwrap_or(self.newest);
            }
        }
        Ok(self.newest)
    }
}
