//! The table's plane, from points that the tip touched.

use nalgebra::{Matrix2, Matrix3, Vector3};

use crate::error::CalibrationError;
use crate::verdict::{Measure, Verdict};

/// Fewest points: three make a plane.
pub const LEAST_POINTS: usize = 3;
/// Least extent of the points across the line that is nearest to them, m (root of the mean square): they
/// would say nothing of the tilt about that line.
pub const LEAST_EXTENT: f64 = 0.02;
/// Usual error of a touched point along the vertical, m: what an arm stops late at light contact, with its
/// repeatability of 0.1 mm.
pub const TOUCH: f64 = 0.2e-3;
/// Largest distance of a point from a good plane, mm: the height that world `real` draws a table to be off
/// by.
pub const RESIDUAL_MM: f64 = 0.5;
/// Largest standard error of the height of a good plane on the start sheet, mm: the same.
pub const HEIGHT_MM: f64 = 0.5;
/// Largest tilt of a table that the skills are made for, degrees: ten times what world `real` draws.
pub const TILT: f64 = 0.6;

/// A plane that was estimated, in the robot's base frame.
#[derive(Clone, Debug)]
pub struct Table {
    /// Its upward normal, of length 1.
    pub normal: Vector3<f64>,
    /// Its height at the origin of the base frame, m.
    pub height: f64,
    /// Largest distance of a point from it, m.
    pub residual: f64,
    /// Standard error of its height at the least certain corner of the start sheet, m.
    pub error: f64,
    /// Number of points.
    pub points: usize,
}

impl Table {
    /// Its height at a place of the base frame, m.
    pub fn height_at(&self, x: f64, y: f64) -> f64 {
        self.height - (self.normal.x * x + self.normal.y * y) / self.normal.z
    }

    /// Angle between it and the horizontal, rad.
    pub fn tilt(&self) -> f64 {
        self.normal.angle(&Vector3::z())
    }

    /// Is it good enough?
    pub fn verdict(&self) -> Verdict {
        let measure = |name, value, limit, unit| Measure { name, value, limit, unit };
        Verdict {
            measures: vec![
                measure("residual", self.residual * 1e3, RESIDUAL_MM, "mm"),
                measure("standard error of the height on the sheet", self.error * 1e3, HEIGHT_MM, "mm"),
                measure("tilt", self.tilt().to_degrees(), TILT, "°"),
            ],
        }
    }
}

/// Fits z = h + a x + b y to points that were touched (m, in the base frame). `sheet` are the corners of the
/// start sheet there, m.
///
/// # Errors
/// Fewer than [`LEAST_POINTS`] points, or points on a line.
pub fn calibrate(points: &[[f64; 3]], sheet: &[[f64; 2]]) -> Result<Table, CalibrationError> {
    let help = "touch the table at four or more places around the start sheet";
    if points.len() < LEAST_POINTS {
        let what = "touched points";
        return Err(CalibrationError::TooFew { what, found: points.len(), least: LEAST_POINTS, help });
    }
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / count;
    let [mx, my, mz] = [mean(0), mean(1), mean(2)];
    let mut spread = Matrix2::zeros();
    let mut moments = Matrix3::zeros();
    let mut right = Vector3::zeros();
    for [x, y, z] in points {
        let (x, y, z) = (x - mx, y - my, z - mz);
        spread += Matrix2::new(x * x, x * y, x * y, y * y) / count;
        let row = Vector3::new(1.0, x, y);
        moments += row * row.transpose();
        right += row * z;
    }
    let extent = spread.symmetric_eigenvalues().min().max(0.0).sqrt();
    let on_a_line = || {
        let why = format!(
            "the touched points lie on a line: {:.0} mm across it, expected {:.0} mm or more",
            extent * 1e3,
            LEAST_EXTENT * 1e3
        );
        CalibrationError::Degenerate { why, help }
    };
    if extent < LEAST_EXTENT {
        return Err(on_a_line());
    }
    let inverse = moments.try_inverse().ok_or_else(on_a_line)?;
    let found = inverse * right;
    let [a, b] = [found[1], found[2]];
    let distances = points.iter().map(|[x, y, z]| {
        (z - mz - found[0] - a * (x - mx) - b * (y - my)).abs() / (1.0 + a * a + b * b).sqrt()
    });
    let distances: Vec<f64> = distances.collect();
    let residual = distances.iter().copied().fold(0.0, f64::max);
    // With three points there is no rest to judge by.
    let free = (count - 3.0).max(1.0);
    let scatter = (distances.iter().map(|it| it * it).sum::<f64>() / free).sqrt().max(TOUCH);
    let variance = |[x, y]: &[f64; 2]| {
        let row = Vector3::new(1.0, x - mx, y - my);
        (row.transpose() * inverse * row)[0]
    };
    let error = scatter * sheet.iter().map(variance).fold(0.0, f64::max).sqrt();
    let normal = Vector3::new(-a, -b, 1.0).normalize();
    let height = mz + found[0] - a * mx - b * my;
    Ok(Table { normal, height, residual, error, points: points.len() })
}
