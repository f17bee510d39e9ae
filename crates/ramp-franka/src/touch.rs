//! Tactile sensors in the fingers of a real arm.

use ramp_robot::Touch;

/// A driver of the tactile sensors in both fingers. The program has none of its own: implement this for the
/// sensors that are mounted, and give it to [`FrankaRobot::with_touch`](crate::FrankaRobot::with_touch).
pub trait TouchSource: Send {
    /// The newest reading, without waiting for another one; `None` while there is none. Forces are those of
    /// the fingers on what they touch, N, and places m, in axes of the tip.
    fn newest(&mut self) -> Option<Touch>;
}
