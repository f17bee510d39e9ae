//! A pose that is known only so well: its mean, its covariance, and how a new measurement changes them.
//!
//! The error of an estimate is six numbers on the axes of the frame in which the pose is given: a shift δp (m) and a
//! rotation vector δθ (rad), so that the true position is p + δp and the true rotation exp(δθ)·R. Since a
//! measurement is a pose as well, the Kalman filter's measurement matrix is the identity, and nothing has to be made
//! linear but the rotation, whose errors are a few degrees at most.

use nalgebra::{Cholesky, Matrix3, Matrix6, Point3, SMatrix, Translation3, UnitQuaternion, Vector3, Vector6};

use crate::Pose;

/// A pose with its covariance.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The mean.
    pub x: Pose,
    /// Covariance of the error: m², m·rad, rad², on the axes of the frame in which the pose is given.
    pub covariance: Matrix6<f64>,
}

/// A diagonal covariance from the standard deviations of the position (m, each axis) and of the rotation (rad, each
/// axis).
pub fn covariance(position: [f64; 3], rotation: [f64; 3]) -> Matrix6<f64> {
    let [x, y, z] = position;
    let [a, b, c] = rotation;
    Matrix6::from_diagonal(&Vector6::new(x, y, z, a, b, c).map(|sigma| sigma * sigma))
}

impl Estimate {
    /// How far another pose lies from the mean, as an error of the estimate.
    pub fn error(&self, x: &Pose) -> Vector6<f64> {
        let shift = x.translation.vector - self.x.translation.vector;
        let turn = (x.rotation * self.x.rotation.inverse()).scaled_axis();
        Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
    }

    /// Normalised innovation squared of a measurement: around 6 when measurement and estimate are what they say they
    /// are, and infinite when a covariance is none.
    pub fn surprise(&self, measured: &Estimate) -> f64 {
        let error = self.error(&measured.x);
        match Cholesky::new(self.covariance + measured.covariance) {
            Some(factor) => error.dot(&factor.solve(&error)),
            None => f64::INFINITY,
        }
    }

    /// The innovation of a measurement, whitened (six independent numbers of unit variance), and the root of its
    /// covariance, which makes an error of white numbers again.
    pub fn whitened(&self, measured: &Estimate) -> Option<(Vector6<f64>, Matrix6<f64>)> {
        let root = Cholesky::new(self.covariance + measured.covariance)?.l();
        Some((root.solve_lower_triangular(&self.error(&measured.x))?, root))
    }

    /// Takes a measurement in.
    pub fn fuse(&mut self, measured: &Estimate) {
        let Some(factor) = Cholesky::new(self.covariance + measured.covariance) else { return };
        // With P the covariance before and R that of the measurement: gain K = P (P + R)⁻¹, covariance after K R.
        let gain = factor.solve(&self.covariance).transpose();
        let step = gain * self.error(&measured.x);
        let after = gain * measured.covariance;
        self.covariance = (after + after.transpose()) / 2.0;
        self.step(&step);
    }

    /// Takes in that `row · error = value`, with the standard deviation `sigma` in the units of `value`.
    pub fn constrain(&mut self, row: &Vector6<f64>, value: f64, sigma: f64) {
        let across = self.covariance * row;
        let variance = row.dot(&across) + sigma * sigma;
        if variance <= 0.0 {
            return;
        }
        let step = across * (value / variance);
        let after = self.covariance - across * across.transpose() / variance;
        self.covariance = (after + after.transpose()) / 2.0;
        self.step(&step);
    }

    fn step(&mut self, step: &Vector6<f64>) {
        let shift = Translation3::new(step[0], step[1], step[2]);
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(step[3], step[4], step[5]));
        let moved = shift.vector + self.x.translation.vector;
        self.x = Pose::from_parts(Translation3::from(moved), turn * self.x.rotation);
    }

    /// Forgets: adds a diagonal covariance ([`covariance`]).
    pub fn spread(&mut self, position: [f64; 3], rotation: [f64; 3]) {
        self.covariance += covariance(position, rotation);
    }

    /// The same estimate in frame A, given the pose `x_ab` in A of the frame B in which it is now.
    #[must_use]
    pub fn seen_from(&self, x_ab: &Pose) -> Estimate {
        let rotation = x_ab.rotation.to_rotation_matrix();
        let mut axes = SMatrix::<f64, 6, 6>::zeros();
        axes.fixed_view_mut::<3, 3>(0, 0).copy_from(rotation.matrix());
        axes.fixed_view_mut::<3, 3>(3, 3).copy_from(rotation.matrix());
        Estimate { x: x_ab * self.x, covariance: axes * self.covariance * axes.transpose() }
    }

    /// Covariance of where a point of the part is, m²: the point is given in the part's frame, the covariance on the
    /// axes of the estimate.
    pub fn point_covariance(&self, p: &Point3<f64>) -> Matrix3<f64> {
        let lever = self.x.rotation * p.coords;
        let mut jacobian = SMatrix::<f64, 3, 6>::identity();
        jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-lever.cross_matrix()));
        jacobian * self.covariance * jacobian.transpose()
    }
}
