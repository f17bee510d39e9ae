//! Where something presses on the hand, from force and moment at the wrist.

use nalgebra::{Point3, Vector3, Vector6};

use crate::cell::Workcell;

impl Workcell<'_, '_> {
    /// Where something presses on the plate at a height (m) beside the hand, by a wrench at the wrist, or the sum of many:
    /// along the table, m in the world.
    pub fn tip_beside(&self, measured: &Vector6<f64>, plate: f64) -> Vector3<f64> {
        let x_wt = self.hand.seen.x_wt;
        let wrist = x_wt * Point3::new(0.0, 0.0, -self.arm.hand.tip);
        let (force, moment) = (measured.fixed_rows::<3>(0), measured.fixed_rows::<3>(3));
        // The moment about the wrist is r × F, and the height of r is known.
        let height = plate - wrist.z;
        let x = (height * force.x - moment.y) / force.z;
        let y = (moment.x + height * force.y) / force.z;
        Vector3::new(wrist.x + x - x_wt.translation.x, wrist.y + y - x_wt.translation.y, 0.0)
    }

    /// The direction in which the tip of a peg that turned between the fingers is beside the hand: across the axis on which
    /// they close, along the table. Axes of the world.
    pub fn across(&self) -> Vector3<f64> {
        let x = self.hand.seen.x_wt.rotation * Vector3::x();
        Vector3::new(x.x, x.y, 0.0).normalize()
    }
}
