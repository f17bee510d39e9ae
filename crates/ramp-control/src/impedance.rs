//! Cartesian impedance: a spring and a damper between the tip and a target, with a posture in the null space.

use nalgebra::{Matrix6, UnitQuaternion, Vector3, Vector6};
use ramp_robot::{DOF, Impedance, Pose};

use crate::state::{ArmState, JointVector};

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
/// `target_acceleration` (m/s² and rad/s²) is fed forward with the mass that the arm shows at its tip:
/// without it a target that speeds up pulls the tip aside, since that mass is not the same in all directions.
pub fn impedance(
    state: &ArmState,
    command: &Impedance,
    target_velocity: &Vector6<f64>,
    target_acceleration: &Vector6<f64>,
) -> JointVector {
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
        + mass * target_acceleration
        + command.feed_forward;
    let posture = JointVector::from_fn(|joint, _| {
        POSTURE_STIFFNESS * (command.posture[joint] - state.positions[joint])
            - POSTURE_DAMPING * state.velocities[joint]
    });
    // Takes from the posture's torques what would accelerate the tip (Khatib's dynamically consistent null
    // space).
    let leak = mass * (state.jacobian * inertia.solve(&posture));
    jt * (wrench - leak) + posture
}

/// The damping matrix that gives the spring `stiffness` (diagonal) this damping ratio with the mass matrix
/// the arm shows at its tip: D = 2 ζ K^½ (K^-½ Λ K^-½)^½ K^½, which damps every mode of the pair alike.
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

#[cfg(test)]
mod tests {
    use nalgebra::{SMatrix, Translation3};

    use super::*;
    use crate::state::Jacobian;

    /// An arm at rest whose first six joints move the tip along and about the axes of the world.
    fn straight() -> ArmState {
        ArmState {
            positions: JointVector::zeros(),
            velocities: JointVector::zeros(),
            x_wt: Pose::identity(),
            jacobian: Jacobian::identity(),
            inertia: SMatrix::identity(),
        }
    }

    fn spring(x_wt: Pose) -> Impedance {
        Impedance {
            x_wt,
            stiffness: Vector6::repeat(100.0),
            damping_ratio: 1.0,
            feed_forward: Vector6::zeros(),
            posture: [0.0; DOF],
        }
    }

    #[test]
    fn the_spring_pulls_to_the_target_with_its_stiffness() {
        let target = Pose::from_parts(Translation3::new(0.01, 0.0, 0.0), UnitQuaternion::identity());
        let torques = impedance(&straight(), &spring(target), &Vector6::zeros(), &Vector6::zeros());
        assert!(
            (torques - JointVector::from([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])).norm() < 1e-9,
            "{torques}"
        );
    }

    #[test]
    fn the_posture_does_not_move_the_tip() {
        let mut command = spring(Pose::identity());
        command.posture = [0.3; DOF];
        let torques = impedance(&straight(), &command, &Vector6::zeros(), &Vector6::zeros());
        // Only the seventh joint does not move this tip. What is left on the others is what keeps a stretched
        // arm from a division by zero.
        assert!(torques.rows(0, 6).norm() < 0.01 * torques[6].abs(), "{torques}");
        assert!(torques[6] > 0.0);
    }

    #[test]
    fn a_moving_tip_is_braked() {
        let mut state = straight();
        state.velocities[0] = 0.1;
        let torques = impedance(&state, &spring(Pose::identity()), &Vector6::zeros(), &Vector6::zeros());
        // Critical damping of 100 N/m and 1 kg is 20 N·s/m.
        assert!((torques[0] + 2.0).abs() < 0.01, "{torques}");
    }
}
