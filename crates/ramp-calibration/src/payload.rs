//! Mass and centre of what the flange carries, from joint torques at rest in several poses.
//!
//! At rest the torques hold up the links, which the arm file knows, and the payload. They are linear in the
//! payload's mass, in its mass times its centre, and in a constant offset of each sensor.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use ramp_motion::{Dynamics, Inertia, Joints};
use ramp_robot::DOF;
use ramp_robot::arm::{ArmModel, FLANGE};

use crate::error::CalibrationError;
use crate::jackknife::{kept, standard_error};
use crate::records::RestSample;
use crate::verdict::{Measure, Verdict};

/// Fewest poses: twice what the unknowns need.
pub const LEAST_POSES: usize = 8;
/// Largest residual of a good estimate, N·m: the bias of a torque sensor in world `real`.
pub const RESIDUAL: f64 = 0.2;
/// Largest standard error of the mass, kg: half of the bias of the force in world `real`.
pub const MASS_ERROR: f64 = 0.05;
/// Largest standard error of the centre, mm: with a hand it is a fifth of the bias of a torque sensor.
pub const CENTRE_ERROR_MM: f64 = 5.0;
/// Number of unknowns: the mass, its product with the centre, and the offset of each joint.
const UNKNOWNS: usize = 4 + DOF;

/// A payload that was estimated.
#[derive(Clone, Debug, PartialEq)]
pub struct Payload {
    /// kg.
    pub mass: f64,
    /// Centre of mass in the flange's frame, m.
    pub centre: Vector3<f64>,
    /// Offset of each joint's torque sensor, N·m.
    pub offsets: [f64; DOF],
    /// Root of the mean of the squares of the residuals, N·m.
    pub residual: f64,
    /// Standard errors of the mass (kg) and of the centre (m).
    pub errors: [f64; 2],
    /// Number of poses.
    pub poses: usize,
}

impl Payload {
    /// Is it good enough?
    pub fn verdict(&self) -> Verdict {
        let measure = |name, value, limit, unit| Measure { name, value, limit, unit };
        let [mass, centre] = self.errors;
        Verdict {
            measures: vec![
                measure("residual", self.residual, RESIDUAL, "N·m"),
                measure("standard error of the mass", mass, MASS_ERROR, "kg"),
                measure("standard error of the centre", centre * 1e3, CENTRE_ERROR_MM, "mm"),
            ],
        }
    }
}

/// The hand of `arm` as its file has it: mass (kg), and centre in the flange's frame (m).
pub fn of_arm_file(arm: &ArmModel) -> (f64, Vector3<f64>) {
    let hand = Inertia::of_hand(arm);
    (hand.mass, hand.centre - Vector3::z() * FLANGE)
}

/// Fits the payload of `arm` to its torques at rest.
///
/// # Errors
/// Fewer than [`LEAST_POSES`] poses, or poses that do not tell mass, centre and offsets apart.
pub fn calibrate(arm: &ArmModel, samples: &[RestSample]) -> Result<Payload, CalibrationError> {
    let help =
        "let the arm rest in ten or more poses that differ in all joints, with the hand tilted to all sides";
    if samples.len() < LEAST_POSES {
        let what = "poses at rest";
        return Err(CalibrationError::TooFew { what, found: samples.len(), least: LEAST_POSES, help });
    }
    let links = Dynamics::without_hand(arm);
    let rows: Vec<_> = samples.iter().map(|sample| equations(&links, sample)).collect();
    let unclear = || {
        let why = "the poses do not tell the payload from the offsets of the sensors".to_string();
        CalibrationError::Degenerate { why, help }
    };
    let all: Vec<usize> = (0..rows.len()).collect();
    let found = fit(&rows, &all).ok_or_else(unclear)?;
    let (mass, centre) = mass_and_centre(&found).ok_or_else(unclear)?;
    let squares: f64 = rows.iter().map(|(row, torques)| (torques - row * &found).norm_squared()).sum();
    let mut differences = [Vec::new(), Vec::new()];
    for kept in kept(rows.len()) {
        let other = fit(&rows, &kept).as_ref().and_then(mass_and_centre).ok_or_else(unclear)?;
        differences[0].push((other.0 - mass).powi(2));
        differences[1].push((other.1 - centre).norm_squared());
    }
    Ok(Payload {
        mass,
        centre: centre - Vector3::z() * FLANGE,
        offsets: std::array::from_fn(|joint| found[4 + joint]),
        residual: (squares / (DOF * rows.len()) as f64).sqrt(),
        errors: differences.map(|it| standard_error(&it)),
        poses: rows.len(),
    })
}

/// The equations of a pose: coefficients of the unknowns, and the torques beside those of the links.
type Equations = (DMatrix<f64>, DVector<f64>);

fn equations(links: &Dynamics, sample: &RestSample) -> Equations {
    let q = Joints::from(sample.positions);
    let bare = links.at(&q).holding();
    // The torques of a kilogram whose centre is here, in the frame of the last joint.
    let kilogram = |centre: Vector3<f64>| {
        let body = Inertia { mass: 1.0, centre, moment: Matrix3::zeros() };
        links.clone().ending_in(&body).at(&q).holding() - bare
    };
    let mut row = DMatrix::zeros(DOF, UNKNOWNS);
    let at_origin = kilogram(Vector3::zeros());
    row.set_column(0, &at_origin);
    for axis in 0..3 {
        row.set_column(1 + axis, &(kilogram(Vector3::ith(axis, 1.0)) - at_origin));
    }
    row.view_mut((0, 4), (DOF, DOF)).fill_with_identity();
    let torques = Joints::from(sample.torques) - bare;
    (row, DVector::from_column_slice(torques.as_slice()))
}

/// Least squares over the poses with these numbers.
fn fit(rows: &[Equations], kept: &[usize]) -> Option<DVector<f64>> {
    let (mut matrix, mut vector) = (DMatrix::zeros(UNKNOWNS, UNKNOWNS), DVector::zeros(UNKNOWNS));
    for (row, torques) in kept.iter().map(|&number| &rows[number]) {
        matrix += row.transpose() * row;
        vector += row.transpose() * torques;
    }
    Some(matrix.cholesky()?.solve(&vector))
}

/// The mass, and the centre in the frame of the last joint.
fn mass_and_centre(found: &DVector<f64>) -> Option<(f64, Vector3<f64>)> {
    let mass = found[0];
    (mass.abs() > 1e-3).then(|| (mass, Vector3::new(found[1], found[2], found[3]) / mass))
}
