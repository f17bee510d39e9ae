//! State of the arm, as input of the inner loops.

use nalgebra::{SMatrix, SVector};
use ramp_robot::{DOF, Pose};

/// A six-row Jacobian: linear velocity above, angular below, axes of the world.
pub type Jacobian = SMatrix<f64, 6, DOF>;
/// One number for each joint.
pub type JointVector = SVector<f64, DOF>;

/// The arm as sensed.
#[derive(Clone, Debug)]
pub struct ArmState {
    /// rad.
    pub positions: JointVector,
    /// rad/s.
    pub velocities: JointVector,
    /// Pose of the tip in the world.
    pub x_wt: Pose,
    /// Of the tip.
    pub jacobian: Jacobian,
    /// Joint-space inertia, kg·m².
    pub inertia: SMatrix<f64, DOF, DOF>,
}
