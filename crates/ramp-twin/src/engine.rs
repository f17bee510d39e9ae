//! Poses of bodies and rotations from the engine's numbers.

use std::sync::Arc;

use mujoco_rs::prelude::*;
use nalgebra::{Matrix3, Translation3, UnitQuaternion};
use ramp_robot::Pose;

/// Pose in the world of a body of the scene.
pub(crate) fn body_pose(data: &MjData<Arc<MjModel>>, id: usize) -> Pose {
    let p = data.xpos()[id];
    let [w, x, y, z] = data.xquat()[id];
    let rotation = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, x, y, z));
    Pose::from_parts(Translation3::new(p[0], p[1], p[2]), rotation)
}

/// The rotation matrix of row-major numbers.
pub(crate) fn rotation_from_rows(rows: &[f64; 9]) -> UnitQuaternion<f64> {
    let matrix = Matrix3::from_row_slice(rows);
    UnitQuaternion::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(matrix))
}
