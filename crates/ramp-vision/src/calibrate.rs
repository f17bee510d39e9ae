//! True pose of a camera, from tags with known poses in the world: those of the sheet, and those on the
//! clamped beam.

use std::collections::BTreeMap;

use nalgebra::{Matrix6, Point3, Translation3, UnitQuaternion, Vector6};
use ramp_kit::tags::TagPlace;
use ramp_robot::camera::Mount;
use ramp_robot::{CameraModel, Pose};

use crate::find::{SeenPart, corner_points};

/// Usual error of a corner, pixels.
const CORNER: f64 = 0.15;

/// Collects sights of known points, and moves a camera until it would have seen them so.
#[derive(Clone, Debug)]
pub struct Calibration {
    nominal: CameraModel,
    sigma: [f64; 2],
    /// Pose of the mount in the world, a known point in the world, and the pixel it was seen in.
    sights: Vec<(Pose, Point3<f64>, [f64; 2])>,
}

impl Calibration {
    /// For a camera that is within `sigma` (m and rad, 1 σ) of where it is said to be.
    pub fn new(nominal: &CameraModel, sigma: [f64; 2]) -> Calibration {
        Calibration { nominal: nominal.clone(), sigma, sights: Vec::new() }
    }

    /// Adds a point of the world (m) that was seen in a pixel while the tip was at `x_wt`.
    pub fn add(&mut self, x_wt: &Pose, p_w: Point3<f64>, pixel: [f64; 2]) {
        let x_wm = match self.nominal.mount {
            Mount::Tip(_) => *x_wt,
            Mount::World(_) => Pose::identity(),
        };
        self.sights.push((x_wm, p_w, pixel));
    }

    /// Adds a part that was seen while the tip was at `x_wt` and whose pose in the world is known: the
    /// clamped beam, or the sheet (whose pose is the identity). `places` are the tags of
    /// [`crate::PartFinder::places`].
    pub fn add_part(&mut self, x_wt: &Pose, seen: &SeenPart, x_wp: &Pose, places: &BTreeMap<u32, TagPlace>) {
        let x_cw = self.nominal.x_wc(x_wt).inverse();
        for place in seen.tags.iter().filter_map(|id| places.get(id)) {
            for p_p in corner_points(place) {
                // The corner's pixel as the whole of the part has it: better than the detector's.
                if let Some(pixel) = self.nominal.project(&(x_cw * seen.x_wp * p_p)) {
                    self.add(x_wt, x_wp * p_p, pixel);
                }
            }
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.sights.len()
    }

    /// Are there none?
    pub fn is_empty(&self) -> bool {
        self.sights.is_empty()
    }

    /// The most likely camera pose, and the covariance of a small translation (m) and rotation (rad) of it,
    /// in its own axes.
    pub fn solve(&self) -> (CameraModel, Matrix6<f64>) {
        let x_mc = match self.nominal.mount {
            Mount::Tip(x) | Mount::World(x) => x,
        };
        let mut change = Vector6::zeros();
        let mut covariance = Matrix6::zeros();
        for _ in 0..8 {
            // The prior.
            let mut matrix = Matrix6::zeros();
            let mut vector = Vector6::zeros();
            for axis in 0..6 {
                let weight = 1.0 / self.sigma[usize::from(axis >= 3)].powi(2);
                matrix[(axis, axis)] = weight;
                vector[axis] = weight * change[axis];
            }
            for (x_wm, p_w, pixel) in &self.sights {
                let see = |change: &Vector6<f64>| {
                    self.nominal.project(&((x_wm * x_mc * motion(change)).inverse() * p_w))
                };
                let Some(at) = see(&change) else { continue };
                for axis in 0..2 {
                    let residual = at[axis] - pixel[axis];
                    let weight = 1.0 / (CORNER * CORNER).max(residual * residual / 9.0);
                    let mut row = Vector6::zeros();
                    for index in 0..6 {
                        let mut there = change;
                        there[index] += 1e-6;
                        let moved = see(&there).map_or(at[axis], |moved| moved[axis]);
                        row[index] = (moved - at[axis]) / 1e-6;
                    }
                    matrix += row * row.transpose() * weight;
                    vector += row * (residual * weight);
                }
            }
            let Some(cholesky) = matrix.cholesky() else { break };
            change -= cholesky.solve(&vector);
            covariance = cholesky.inverse();
        }
        let x_mc = x_mc * motion(&change);
        let mut camera = self.nominal.clone();
        camera.mount = match camera.mount {
            Mount::Tip(_) => Mount::Tip(x_mc),
            Mount::World(_) => Mount::World(x_mc),
        };
        (camera, covariance)
    }
}

fn motion(change: &Vector6<f64>) -> Pose {
    Pose::from_parts(
        Translation3::from(change.fixed_rows::<3>(0).into_owned()),
        UnitQuaternion::from_scaled_axis(change.fixed_rows::<3>(3).into_owned()),
    )
}
