//! The arm's own model: from what the joints report to the state that the inner loops need.

use std::sync::Arc;

use nalgebra::SMatrix;
use ramp_motion::{Dynamics, Kinematics};
use ramp_robot::DOF;
use ramp_robot::arm::ArmModel;

use crate::state::{ArmState, JointVector};

/// Kinematics and masses of an arm with its empty hand. Copies share them.
#[derive(Clone, Debug)]
pub struct StateModel {
    shared: Arc<(Kinematics, Dynamics)>,
    /// Inertia of each drive at its joint, kg·m².
    armature: JointVector,
}

impl StateModel {
    /// The model of `arm`, whose drives have these inertias at the joints (kg·m²).
    pub fn new(arm: &ArmModel, armature: JointVector) -> StateModel {
        StateModel { shared: Arc::new((Kinematics::new(arm), Dynamics::new(arm))), armature }
    }

    /// The state at these joint positions (rad) and velocities (rad/s).
    pub fn state(&self, positions: &JointVector, velocities: &JointVector) -> ArmState {
        let (kinematics, dynamics) = &*self.shared;
        let frames = kinematics.frames(positions);
        let drives = SMatrix::<f64, DOF, DOF>::from_diagonal(&self.armature);
        ArmState {
            positions: *positions,
            velocities: *velocities,
            jacobian: kinematics.jacobian(&frames),
            x_wt: frames.tip,
            inertia: dynamics.at(positions).inertia() + drives,
        }
    }

    /// The torques that hold the arm up at these joint positions (rad), N·m.
    pub fn weight(&self, positions: &JointVector) -> JointVector {
        self.shared.1.at(positions).holding()
    }

    /// Inertia of each drive at its joint, kg·m².
    pub fn armature(&self) -> &JointVector {
        &self.armature
    }
}
