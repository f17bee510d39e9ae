//! The observation at the end of a control period.

use crate::arm::DOF;
use crate::pose::Pose;
use crate::touch::Touch;
use nalgebra::Vector6;

/// The observation at the end of a control period.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// Robot time since the start of the episode, s.
    pub time: f64,
    /// Joint positions, rad.
    pub positions: [f64; DOF],
    /// Joint velocities, rad/s.
    pub velocities: [f64; DOF],
    /// Joint torques on top of gravity compensation, N·m.
    pub torques: [f64; DOF],
    /// Pose of the tip T in the world: origin between the fingertips, z out of the hand, y along the closing
    /// direction.
    pub x_wt: Pose,
    /// Wrench of the hand on the world, measured at the wrist and expressed at the wrist in axes of
    /// the world: force in N, then moment in N·m. The weight of the hand is compensated, that of a
    /// held part is not. Noisy.
    pub wrench: Vector6<f64>,
    /// Distance between the two fingers, m, as last reported by the gripper.
    pub width: f64,
    /// Whether the gripper is still executing its last command. Always false for a gripper without
    /// dead time.
    pub gripper_busy: bool,
    /// The last readings of the tactile sensors in the fingers; `None` for an arm without.
    pub touch: Option<Touch>,
}

/// A measured pose of a part.
#[derive(Clone, Debug, PartialEq)]
pub struct PartReading {
    /// Name in the kit, for example `b4` or `p1`.
    pub part: String,
    /// Pose of its frame in the world: a beam's at its j1 hole, a peg's at the underside of its head.
    pub x_wp: Pose,
    /// Standard deviation of its noise: of the position along each axis of the world, m, and of the
    /// rotation about each axis of the world, rad. Zero for an exact reading.
    pub sigma: [f64; 2],
}
