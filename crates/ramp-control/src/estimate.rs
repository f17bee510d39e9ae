//! The external wrench of an arm without a force sensor, estimated from the torques of its joints.
//!
//! The torques that the arm's motion needs beyond those of its joints are external. [`WrenchEstimate`]
//! filters them, as the observers of real arms do, and gives the wrench at a point that explains them best.
//! The estimate includes friction past the torque sensors, their errors and those of the model of the arm's
//! weight.

use nalgebra::{Matrix6, SMatrix, Vector6};
use ramp_robot::{DOF, PERIOD};

use crate::state::{Jacobian, JointVector};

/// Added to the squares of the Jacobian, so that a stretched arm does not divide by zero: m² and rad².
const LEAST: f64 = 1e-4;

/// Follows the external torques of the joints.
#[derive(Clone, Debug)]
pub struct WrenchEstimate {
    /// Share of a new value in the filter.
    step: f64,
    /// N·m.
    external: JointVector,
}

impl WrenchEstimate {
    /// With this bandwidth (Hz, −3 dB).
    pub fn new(bandwidth: f64) -> WrenchEstimate {
        WrenchEstimate {
            step: 1.0 - (-std::f64::consts::TAU * bandwidth * PERIOD).exp(),
            external: JointVector::zeros(),
        }
    }

    /// Updates after a period with the joints' accelerations (rad/s²), the inertia of the links (kg·m²,
    /// without the drives), the torques of Coriolis and centrifugal forces and those measured on the links
    /// (N·m).
    pub fn sensed(
        &mut self,
        inertia: &SMatrix<f64, DOF, DOF>,
        accelerations: &JointVector,
        coriolis: &JointVector,
        measured: &JointVector,
    ) {
        let raw = inertia * accelerations + coriolis - measured;
        self.external += (raw - self.external) * self.step;
    }

    /// The external torques of the joints, N·m.
    pub fn torques(&self) -> &JointVector {
        &self.external
    }

    /// The wrench of the hand on the world at the point of `jacobian`, in axes of the world: N, N·m.
    pub fn wrench(&self, jacobian: &Jacobian) -> Vector6<f64> {
        let squares: Matrix6<f64> = jacobian * jacobian.transpose() + Matrix6::identity() * LEAST;
        squares.cholesky().map_or(Vector6::zeros(), |factor| -factor.solve(&(jacobian * self.external)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A constant pull is known after some tenths of a second, and half known after the time of its
    /// bandwidth.
    #[test]
    fn a_pull_is_known_within_the_bandwidth() {
        let mut jacobian = Jacobian::zeros();
        for axis in 0..6 {
            jacobian[(axis, axis)] = 1.0;
        }
        let mut estimate = WrenchEstimate::new(10.0);
        let mut after = |periods: usize| {
            for _ in 0..periods {
                // The motors hold 5 N with the first joint, and nothing moves.
                let mut measured = JointVector::zeros();
                measured[0] = 5.0;
                let zero = JointVector::zeros();
                estimate.sensed(&SMatrix::identity(), &zero, &zero, &measured);
            }
            estimate.wrench(&jacobian)[0]
        };
        let time_constant = 1.0 / (std::f64::consts::TAU * 10.0);
        let early = after((time_constant / PERIOD) as usize);
        assert!((early / 5.0 - 0.63).abs() < 0.02, "{early}");
        assert!((after(300) - 5.0).abs() < 1e-3);
    }
}
