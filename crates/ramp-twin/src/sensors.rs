//! The sensors of the arm and of the hand, and the readings of parts, as functions of the scene and of the
//! physics.

use std::sync::Arc;

use mujoco_rs::prelude::*;
use nalgebra::{Translation3, UnitQuaternion, Vector3, Vector6};
use ramp_control::{ArmState, Jacobian, JointVector};
use ramp_robot::random::Stream;
use ramp_robot::{DOF, GRAVITY, PartReading, Pose};
use ramp_world::Physics;

use crate::drive::reported;
use crate::engine::{body_pose, rotation_from_rows};
use crate::scene::Scene;

/// Standard deviation of a reading on track `noisy`: position of a part, m along each axis, and its rotation,
/// rad about each axis.
pub const READING_NOISE: [f64; 2] = [1.0e-3, std::f64::consts::PI / 180.0];
/// Share of the parts that a reading on track `noisy` leaves out.
pub const READING_DROPPED: f64 = 0.05;
/// Control periods that a reading on track `noisy` takes: as many as an image at 30 frames a second.
pub const READING_STEPS: u32 = 33;

type Data = MjData<Arc<MjModel>>;

/// Joint positions as their sensors report them, rad: the true ones, with the world's errors, and with the
/// `noise` and the step of the encoders.
pub(crate) fn positions(scene: &Scene, data: &Data, noise: &mut Stream) -> JointVector {
    reported(&scene.physics, noise, &JointVector::from_column_slice(&data.qpos()[..DOF]))
}

/// Joint velocities as their sensors report them, rad/s.
pub(crate) fn velocities(data: &Data) -> JointVector {
    JointVector::from_column_slice(&data.qvel()[..DOF])
}

/// Whether the arm of this world has a force/torque sensor at the wrist.
pub(crate) fn has_wrist_sensor(physics: &Physics) -> bool {
    physics.sensing.wrist_sensor >= 0.5
}

/// Reading of the wrist sensor without noise: wrench of the hand on the objects that it touches and holds, at
/// the wrist, axes of the world, N and N·m. The weight of the hand itself is removed.
pub(crate) fn read_wrist(scene: &Scene, data: &Data) -> Vector6<f64> {
    let sensor = data.sensordata();
    let rotation = rotation_from_rows(&data.site_xmat()[scene.wrist_site]);
    let p_wrist = Vector3::from(data.site_xpos()[scene.wrist_site]);
    let mut force = rotation * Vector3::new(sensor[0], sensor[1], sensor[2]);
    let mut moment = rotation * Vector3::new(sensor[3], sensor[4], sensor[5]);
    // MuJoCo gives the wrench that carries the hand: up, at rest. The hand's own weight is known.
    for body in scene.hand_bodies {
        let weight = Vector3::new(0.0, 0.0, scene.model.body_mass()[body] * GRAVITY);
        force -= weight;
        moment -= (Vector3::from(data.xipos()[body]) - p_wrist).cross(&weight);
    }
    // Carried from outside with +f, the hand presses on the outside with −f.
    Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z)
}

/// Constant bias of this world's wrist sensor, N and N·m, axes of the world.
pub(crate) fn sensor_bias(scene: &Scene, data: &Data) -> Vector6<f64> {
    let rotation = rotation_from_rows(&data.site_xmat()[scene.wrist_site]);
    let sensing = &scene.physics.sensing;
    let [force, moment] = [sensing.force_bias, sensing.moment_bias].map(|it| rotation * Vector3::from(it));
    Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z)
}

/// The Jacobian of the wrist in the world, from that of the tip, which is `tip` (m) before the wrist.
pub(crate) fn wrist_jacobian(tip: f64, state: &ArmState) -> Jacobian {
    let lever = state.x_wt.rotation * Vector3::new(0.0, 0.0, -tip);
    let mut jacobian = state.jacobian;
    for joint in 0..DOF {
        let axis = Vector3::from(jacobian.fixed_view::<3, 1>(3, joint));
        let linear = jacobian.fixed_view::<3, 1>(0, joint) + axis.cross(&lever);
        jacobian.fixed_view_mut::<3, 1>(0, joint).copy_from(&linear);
    }
    jacobian
}

/// The true poses of all beams and pegs.
pub(crate) fn exact_reading(scene: &Scene, data: &Data) -> Vec<PartReading> {
    let read = |(name, id): &(String, usize)| PartReading {
        part: name.clone(),
        x_wp: body_pose(data, *id),
        sigma: [0.0; 2],
    };
    scene.parts.iter().map(read).collect()
}

/// The poses of beams and pegs with noise. Some parts are left out.
pub(crate) fn noisy_reading(scene: &Scene, data: &Data, noise: &mut Stream) -> Vec<PartReading> {
    let [position, rotation] = READING_NOISE;
    let mut readings = Vec::new();
    for (name, id) in &scene.parts {
        // A part that is left out draws as many numbers as any other.
        let dropped = noise.uniform() < READING_DROPPED;
        let shift = Vector3::from_fn(|_, _| noise.normal(position));
        let rotation_vector = Vector3::from_fn(|_, _| noise.normal(rotation));
        if !dropped {
            let x_wp = body_pose(data, *id);
            let p = x_wp.translation.vector + shift;
            let rotation = UnitQuaternion::from_scaled_axis(rotation_vector) * x_wp.rotation;
            let x_wp = Pose::from_parts(Translation3::from(p), rotation);
            readings.push(PartReading { part: name.clone(), x_wp, sigma: READING_NOISE });
        }
    }
    readings
}
