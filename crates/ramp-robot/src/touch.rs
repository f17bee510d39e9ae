//! Readings of tactile sensors in the pads of the fingers.

use nalgebra::Vector3;

/// The last readings of the tactile sensors of both fingers: first of the finger that is on the side +y of
/// the tip T, and closes along −y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Of each finger.
    pub fingers: [FingerTouch; 2],
}

/// Reading of the tactile sensor of a finger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FingerTouch {
    /// Force of the finger on the object that it touches, N, axes of the tip T: x along the width of the
    /// pad, y along the closing direction, z out of the hand. Noisy; it drifts, and ends at the range of
    /// the sensor.
    pub force: Vector3<f64>,
    /// Centre of pressure on the pad, m: its x and z in T. `None` while the finger presses too lightly.
    pub centre: Option<[f64; 2]>,
}
