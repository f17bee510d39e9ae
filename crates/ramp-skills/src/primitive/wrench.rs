//! Contact point computed from force and moment at the wrist.

use nalgebra::{Point3, Vector3, Vector6};

use crate::cell::Workcell;
use crate::hand::Hand;

impl Workcell<'_, '_> {
    /// Horizontal offset from the hand of the contact point on the plate at a height (m), from a wrench at
    /// the wrist or the sum of many; m in the world.
    pub fn tip_beside(&self, measured: &Vector6<f64>, plate: f64) -> Vector3<f64> {
        moment_below(&self.hand, self.arm.hand.tip, measured, plate) / measured.z
    }

    /// The direction in which the tip of a peg that turned between the fingers is beside the hand: across the
    /// axis on which they close, along the table. Axes of the world.
    pub fn across(&self) -> Vector3<f64> {
        across(&self.hand)
    }
}

/// See [`Workcell::across`].
pub fn across(hand: &Hand) -> Vector3<f64> {
    let x = hand.seen.x_wt.rotation * Vector3::x();
    Vector3::new(x.x, x.y, 0.0).normalize()
}

/// Moment of a wrench at the wrist (N, N·m), `tip` (m) behind the fingers' tip, about the point below the
/// hand on the plate at a height (m): the downward force times the horizontal offset of the contact point,
/// N·m, axes of the world.
pub fn moment_below(hand: &Hand, tip: f64, measured: &Vector6<f64>, plate: f64) -> Vector3<f64> {
    let x_wt = hand.seen.x_wt;
    let wrist = x_wt * Point3::new(0.0, 0.0, -tip);
    let (force, moment) = (measured.fixed_rows::<3>(0), measured.fixed_rows::<3>(3));
    // The moment about the wrist is r × F, and the height of r is known.
    let height = plate - wrist.z;
    let x = height * force.x - moment.y + (wrist.x - x_wt.translation.x) * force.z;
    let y = moment.x + height * force.y + (wrist.y - x_wt.translation.y) * force.z;
    Vector3::new(x, y, 0.0)
}
