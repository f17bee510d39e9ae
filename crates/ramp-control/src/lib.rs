//! The inner control loop of the arm and the gripper: from a command to joint torques, once each millisecond.
//!
//! Pure mathematics on plain numbers: what was sensed and what was commanded go in, torques come out.

use nalgebra::{Matrix3, Matrix6, SMatrix, SVector, UnitQuaternion, Vector3, Vector6};
use ramp_robot::arm::ArmModel;
use ramp_robot::{DOF, Impedance, Pose};

/// A six-row Jacobian: linear velocity above, angular below, axes of the world.
pub type Jacobian = SMatrix<f64, 6, DOF>;
/// One number for each joint.
pub type JointVector = SVector<f64, DOF>;

/// Stiffness of joint tracking, N·m/rad.
const JOINT_STIFFNESS: [f64; DOF] = [4000.0, 4000.0, 3000.0, 3000.0, 1200.0, 1200.0, 600.0];
/// Damping of joint tracking, N·m·s/rad: about critical with the inertia each joint carries.
const JOINT_DAMPING: [f64; DOF] = [140.0, 140.0, 90.0, 90.0, 30.0, 30.0, 16.0];
/// Stiffness with which a commanded Cartesian pose is tracked, N/m and N·m/rad.
const POSE_STIFFNESS: [f64; 6] = [4000.0, 4000.0, 4000.0, 150.0, 150.0, 150.0];
/// Stiffness (N·m/rad) and damping (N·m·s/rad) towards the posture in the null space.
const POSTURE_STIFFNESS: f64 = 10.0;
/// See [`POSTURE_STIFFNESS`].
const POSTURE_DAMPING: f64 = 2.0;
/// Added to the mobility of the tip, 1/kg and 1/(kg·m²), so that a stretched arm does not divide by zero.
const LEAST_MOBILITY: f64 = 1e-3;
/// Least stiffness for which a damper is computed, N/m and N·m/rad.
const LEAST_STIFFNESS: f64 = 1e-3;
/// Stiffness of a finger's position loop, N/m, and of the gear that couples the two fingers.
const FINGER_STIFFNESS: f64 = 20_000.0;
/// Damping of a finger's position loop, N·s/m.
const FINGER_DAMPING: f64 = 200.0;
/// Largest speed of a finger, m/s. The Panda's hand allows 0.1 m/s for both together.
pub const FINGER_SPEED: f64 = 0.05;

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

/// Torques that track joint positions moving at `velocities`, N·m.
pub fn track_joints(state: &ArmState, positions: &JointVector, velocities: &JointVector) -> JointVector {
    JointVector::from_fn(|joint, _| {
        JOINT_STIFFNESS[joint] * (positions[joint] - state.positions[joint])
            + JOINT_DAMPING[joint] * (velocities[joint] - state.velocities[joint])
    })
}

/// Torques that brake towards joint velocities, N·m.
pub fn track_velocities(state: &ArmState, velocities: &JointVector) -> JointVector {
    JointVector::from_fn(|joint, _| JOINT_DAMPING[joint] * (velocities[joint] - state.velocities[joint]))
}

/// The impedance with which a bare pose is tracked.
pub fn pose_impedance(x_wt: &Pose, posture: [f64; DOF]) -> Impedance {
    Impedance {
        x_wt: *x_wt,
        stiffness: Vector6::from(POSE_STIFFNESS),
        damping_ratio: 1.0,
        feed_forward: Vector6::zeros(),
        posture,
    }
}

/// Torques of a Cartesian impedance with a posture in its null space, N·m. Damping acts on the tip's velocity
/// relative to `target_velocity`, that of the moving target (m/s and rad/s, axes of the world).
pub fn impedance(state: &ArmState, command: &Impedance, target_velocity: &Vector6<f64>) -> JointVector {
    let shift = command.x_wt.translation.vector - state.x_wt.translation.vector;
    let turn = rotation_error(&command.x_wt.rotation, &state.x_wt.rotation);
    let error = Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z);
    let velocity = state.jacobian * state.velocities - target_velocity;
    let Some(inertia) = state.inertia.cholesky() else { return JointVector::zeros() };
    let jt = state.jacobian.transpose();
    let mobility: Matrix6<f64> = state.jacobian * inertia.solve(&jt) + Matrix6::identity() * LEAST_MOBILITY;
    let mass = mobility.cholesky().map_or(Matrix6::identity(), |factor| factor.inverse());
    let wrench = command.stiffness.component_mul(&error)
        - damping(&mass, &command.stiffness, command.damping_ratio) * velocity
        + command.feed_forward;
    let posture = JointVector::from_fn(|joint, _| {
        POSTURE_STIFFNESS * (command.posture[joint] - state.positions[joint])
            - POSTURE_DAMPING * state.velocities[joint]
    });
    // Takes from the posture's torques what would accelerate the tip (Khatib's dynamically consistent null space).
    let leak = mass * (state.jacobian * inertia.solve(&posture));
    jt * (wrench - leak) + posture
}

/// The damping matrix that gives the spring `stiffness` (diagonal) this damping ratio with the mass matrix the arm
/// shows at its tip: D = 2 ζ K^½ (K^-½ Λ K^-½)^½ K^½, which damps every mode of the pair alike.
fn damping(mass: &Matrix6<f64>, stiffness: &Vector6<f64>, ratio: f64) -> Matrix6<f64> {
    let root = stiffness.map(|k| k.max(LEAST_STIFFNESS).sqrt());
    let scaled = Matrix6::from_fn(|i, j| mass[(i, j)] / (root[i] * root[j]));
    let eigen = scaled.symmetric_eigen();
    let roots = Matrix6::from_diagonal(&eigen.eigenvalues.map(|value| value.max(0.0).sqrt()));
    let square_root = eigen.eigenvectors * roots * eigen.eigenvectors.transpose();
    Matrix6::from_fn(|i, j| 2.0 * ratio * root[i] * square_root[(i, j)] * root[j])
}

/// The rotation vector that turns `from` into `to`, axes of the world, rad.
fn rotation_error(to: &UnitQuaternion<f64>, from: &UnitQuaternion<f64>) -> Vector3<f64> {
    (to * from.inverse()).scaled_axis()
}

/// Keeps each torque within its joint's limit, N·m.
pub fn limit_torques(arm: &ArmModel, torques: JointVector) -> JointVector {
    JointVector::from_fn(|joint, _| {
        let limit = arm.joints[joint].torque;
        torques[joint].clamp(-limit, limit)
    })
}

/// The gripper's loop: two fingers that move together at limited speed and press with limited force.
#[derive(Clone, Copy, Debug)]
pub struct GripperLoop {
    /// Where both fingers are told to be, m from closed.
    target: f64,
}

impl GripperLoop {
    /// Starts with the fingers at `q`, m from closed.
    pub fn new(q: f64) -> GripperLoop {
        GripperLoop { target: q }
    }

    /// Forces on the two fingers, N, for a wanted distance between them (m) and a largest force each (N). `q` (m)
    /// and `v` (m/s) are the fingers' positions and speeds, `period` is in s.
    pub fn forces(&mut self, width: f64, force: f64, q: [f64; 2], v: [f64; 2], period: f64) -> [f64; 2] {
        let wanted = width / 2.0;
        let step = FINGER_SPEED * period;
        self.target += (wanted - self.target).clamp(-step, step);
        // The target never runs away from blocked fingers, so that opening starts at once.
        let lead = 1.05 * force / FINGER_STIFFNESS;
        let mean = (q[0] + q[1]) / 2.0;
        self.target = self.target.clamp(mean - lead, mean + lead);
        // The real hand drives both fingers from one motor; its gear is a stiff spring between them here.
        let gear = FINGER_STIFFNESS * (q[0] - q[1]) / 2.0;
        std::array::from_fn(|finger| {
            let loop_force = FINGER_STIFFNESS * (self.target - q[finger]) - FINGER_DAMPING * v[finger];
            loop_force.clamp(-force, force) + if finger == 0 { -gear } else { gear }
        })
    }
}

/// The rotation matrix of row-major numbers.
pub fn rotation_from_rows(rows: &[f64; 9]) -> UnitQuaternion<f64> {
    let matrix = Matrix3::from_row_slice(rows);
    UnitQuaternion::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(matrix))
}
