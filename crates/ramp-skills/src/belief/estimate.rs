//! A pose that is known only so well: its mean, its covariance, and how a new measurement changes them.
//!
//! The error of an estimate is six numbers on the axes of the frame in which the pose is given: a shift δp
//! (m) and a rotation vector δθ (rad), so that the true position is p + δp and the true rotation exp(δθ)·R.
//! Since a measurement is a pose as well, the Kalman filter's measurement matrix is the identity, and nothing
//! has to be made linear but the rotation, whose errors are a few degrees at most.

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

/// A diagonal covariance from the standard deviations of the position (m, each axis) and of the rotation
/// (rad, each axis).
pub fn covariance(position: [f64; 3], rotation: [f64; 3]) -> Matrix6<f64> {
    let [x, y, z] = position;
    let [a, b, c] = rotation;
    Matrix6::from_diagonal(&Vector6::new(x, y, z, a, b, c).map(|sigma| sigma * sigma))
}

impl Estimate {
    /// Difference of another pose from the mean, as an error of the estimate.
    pub fn error(&self, x: &Pose) -> Vector6<f64> {
        let shift = x.translation.vector - self.x.translation.vector;
        let turn = (x.rotation * self.x.rotation.inverse()).scaled_axis();
        Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
    }

    /// Normalised innovation squared of a measurement: around 6 when both covariances are correct, and
    /// infinite when one is not a valid covariance.
    pub fn surprise(&self, measured: &Estimate) -> f64 {
        let error = self.error(&measured.x);
        match Cholesky::new(self.covariance + measured.covariance) {
            Some(factor) => error.dot(&factor.solve(&error)),
            None => f64::INFINITY,
        }
    }

    /// The innovation of a measurement, whitened (six independent numbers of unit variance), and the root of
    /// its covariance, which makes an error of white numbers again.
    pub fn whitened(&self, measured: &Estimate) -> Option<(Vector6<f64>, Matrix6<f64>)> {
        let root = Cholesky::new(self.covariance + measured.covariance)?.l();
        Some((root.solve_lower_triangular(&self.error(&measured.x))?, root))
    }

    /// Takes a measurement in.
    pub fn fuse(&mut self, measured: &Estimate) {
        let Some(factor) = Cholesky::new(self.covariance + measured.covariance) else { return };
        // With P the covariance before and R that of the measurement: gain K = P (P + R)⁻¹, covariance after
        // K R.
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

    /// Forgets how far the part is turned about an axis (a unit vector) through the origin of the frame in
    /// which the pose is given, to `sigma` rad: far from there, its position goes along.
    pub fn spread_turn(&mut self, axis: &Vector3<f64>, sigma: f64) {
        let shift = axis.cross(&self.x.translation.vector);
        let error = sigma * Vector6::new(shift.x, shift.y, shift.z, axis.x, axis.y, axis.z);
        self.covariance += error * error.transpose();
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

    /// Covariance of where a point of the part is, m²: the point is given in the part's frame, the covariance
    /// on the axes of the estimate.
    pub fn point_covariance(&self, p: &Point3<f64>) -> Matrix3<f64> {
        let lever = self.x.rotation * p.coords;
        let mut jacobian = SMatrix::<f64, 3, 6>::identity();
        jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-lever.cross_matrix()));
        jacobian * self.covariance * jacobian.transpose()
    }
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use ramp_robot::random::Stream;

    use super::*;

    const SIGMA: ([f64; 3], [f64; 3]) = ([1.0e-3; 3], [0.0175; 3]);

    fn drawn(stream: &mut Stream, covariance: &Matrix6<f64>) -> Vector6<f64> {
        let white = Vector6::from_fn(|_, _| stream.normal(1.0));
        Cholesky::new(*covariance).unwrap().l() * white
    }

    fn moved(x: &Pose, error: &Vector6<f64>) -> Pose {
        let mut estimate = Estimate { x: *x, covariance: Matrix6::zeros() };
        estimate.step(error);
        estimate.x
    }

    /// A part that may have turned about an axis is as well known on the axis as before, and a pose rotated
    /// about it has a small innovation far from there too.
    #[test]
    fn a_turn_is_forgotten_with_what_goes_along() {
        let x = Pose::new(Vector3::new(0.2, 0.0, 0.01), Vector3::new(0.0, 0.0, 0.3));
        let known = Estimate { x, covariance: covariance(SIGMA.0, [0.002; 3]) };
        let mut turned = known.clone();
        turned.spread_turn(&Vector3::y(), 0.25);
        let by = |axis| UnitQuaternion::from_axis_angle(&axis, 0.1);
        let seen = |axis| Estimate { x: by(axis) * x, covariance: covariance(SIGMA.0, SIGMA.1) };
        assert!(known.surprise(&seen(Vector3::y_axis())) > 100.0);
        assert!(turned.surprise(&seen(Vector3::y_axis())) < 1.0);
        assert!(turned.surprise(&seen(Vector3::z_axis())) > 100.0);
        let origin = x.inverse() * Point3::origin();
        let [before, after] = [&known, &turned].map(|estimate| estimate.point_covariance(&origin));
        assert!((before - after).norm() < 1.0e-12, "{before} {after}");
    }

    /// The filter's covariance is consistent: over many series of readings, the normalised square of its
    /// innovations and of its error against the truth both have six degrees of freedom.
    #[test]
    fn the_covariance_is_that_of_the_error() {
        let mut stream = Stream::new(1, "filter");
        let prior = covariance([3.0e-3, 3.0e-3, 0.3e-3], [0.005, 0.005, 0.05]);
        let noise = covariance(SIGMA.0, SIGMA.1);
        let truth = Pose::new(Vector3::new(0.4, -0.1, 0.02), Vector3::new(0.1, -0.2, 2.5));
        let (series, length) = (300, 20);
        let (mut innovations, mut errors) = (0.0, 0.0);
        for _ in 0..series {
            let mut estimate = Estimate { x: moved(&truth, &drawn(&mut stream, &prior)), covariance: prior };
            for _ in 0..length {
                // The part creeps between readings, and the filter knows that it may.
                estimate.spread([0.1e-3; 3], [0.001; 3]);
                estimate.x = moved(&estimate.x, &drawn(&mut stream, &covariance([0.1e-3; 3], [0.001; 3])));
                let measured = Estimate { x: moved(&truth, &drawn(&mut stream, &noise)), covariance: noise };
                innovations += estimate.surprise(&measured);
                estimate.fuse(&measured);
            }
            let exact = Estimate { x: truth, covariance: Matrix6::identity() * 1e-18 };
            errors += estimate.surprise(&exact);
        }
        // Mean of n chi-squares with six degrees of freedom: 6 ± √(12/n); four standard deviations.
        let within = |sum: f64, n: f64| (sum / n - 6.0).abs() < 4.0 * (12.0 / n).sqrt();
        let n = f64::from(series);
        assert!(within(innovations, n * f64::from(length)), "{}", innovations / n / f64::from(length));
        assert!(within(errors, n), "{}", errors / n);
    }

    /// A point far from the origin is as uncertain as the rotation makes it.
    #[test]
    fn a_lever_turns_an_angle_into_a_distance() {
        let x = Pose::new(Vector3::new(0.3, 0.0, 0.0), Vector3::new(0.0, 0.0, 0.7));
        let estimate = Estimate { x, covariance: covariance([1e-4; 3], [0.0, 0.0, 1e-3]) };
        let at = estimate.point_covariance(&Point3::new(0.5, 0.0, 0.0));
        let across = x.rotation * Vector3::y();
        let along = x.rotation * Vector3::x();
        assert!((across.dot(&(at * across)).sqrt() - (1e-8f64 + 0.25e-6).sqrt()).abs() < 1e-9);
        assert!((along.dot(&(at * along)).sqrt() - 1e-4).abs() < 1e-9);
    }

    /// There and back into another frame changes nothing.
    #[test]
    fn a_change_of_frame_can_be_undone() {
        let mut stream = Stream::new(2, "frames");
        let mut estimate =
            Estimate { x: Pose::identity(), covariance: covariance(SIGMA.0, [0.01, 0.02, 0.03]) };
        estimate.constrain(&Vector6::new(0.0, 1.0, 0.0, 0.1, 0.0, 0.2), 1e-4, 1e-5);
        let x = moved(&Pose::identity(), &Vector6::from_fn(|_, _| stream.normal(1.0)));
        let back = estimate.seen_from(&x).seen_from(&x.inverse());
        assert!((back.covariance - estimate.covariance).amax() < 1e-15);
        assert!(back.error(&estimate.x).amax() < 1e-12);
    }
}
