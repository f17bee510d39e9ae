//! Fits the pose of a part to its measurements: Gauss and Newton's method in the optical frame.

use nalgebra::{
    Matrix2x3, Matrix3, Matrix6, Point3, Rotation3, RowVector6, SMatrix, SVector, Translation3,
    UnitQuaternion, Vector3, Vector6,
};
use ramp_kit::tags::TagPlace;
use ramp_robot::{CameraModel, Pose};

use crate::edges::Place;

/// Residuals beyond this many of their usual size count less and less.
const HUBER: f64 = 3.0;
/// Usual error of a measured corner, pixels.
pub const CORNER_ERROR: f64 = 0.25;
/// Usual error of a measured place on an edge, pixels.
pub const EDGE_ERROR: f64 = 0.05;

/// Something that is measured of a part, to be brought to zero.
pub trait Terms {
    /// Calls `take` with each residual, in units of its usual error, and its derivative by a small shift and
    /// turn of the part (about its origin, axes of the optical frame).
    fn each(&self, x_cp: &Pose, take: &mut dyn FnMut(f64, &RowVector6<f64>));
}

/// Corners of tags: their places on the part and their pixels.
pub struct Corners<'a> {
    /// The camera.
    pub camera: &'a CameraModel,
    /// Points on the part, m, and where they are seen, pixels.
    pub points: &'a [(Point3<f64>, [f64; 2])],
}

/// Places on edges of tags.
pub struct Edges<'a> {
    /// The camera.
    pub camera: &'a CameraModel,
    /// The measurements.
    pub places: &'a [Place],
}

/// Prior of the pose of a part.
#[derive(Clone, Copy, Debug)]
pub struct Level {
    /// Turn from the optical frame to the world.
    pub r_wc: Rotation3<f64>,
    /// Height of the optical frame's origin in the world, m.
    pub eye: f64,
    /// A point of the part, m.
    pub p_p: Point3<f64>,
    /// Height of that point in the world, m, and how sure it is (1 σ).
    pub height: [f64; 2],
    /// Uncertainty of its z axis against the vertical (1 σ), rad.
    pub tilt: f64,
    /// Does its z axis point down?
    pub flipped: bool,
}

/// Image position of a point of the optical frame, and its derivative by the point.
fn project(camera: &CameraModel, p_c: &Point3<f64>) -> Option<([f64; 2], Matrix2x3<f64>)> {
    let at = camera.project(p_c)?;
    let step = 1e-6 * p_c.z;
    let mut slope = Matrix2x3::zeros();
    for axis in 0..3 {
        let mut moved = *p_c;
        moved[axis] += step;
        let there = camera.project(&moved)?;
        slope[(0, axis)] = (there[0] - at[0]) / step;
        slope[(1, axis)] = (there[1] - at[1]) / step;
    }
    Some((at, slope))
}

/// Derivative of a point of the part, in the optical frame, by a small translation and rotation.
pub(crate) fn motion(x_cp: &Pose, p_p: &Point3<f64>) -> SMatrix<f64, 3, 6> {
    let arm = x_cp.rotation * p_p.coords;
    let mut motion = SMatrix::<f64, 3, 6>::zeros();
    motion.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::identity());
    motion.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-arm.cross_matrix()));
    motion
}

impl Edges<'_> {
    /// Sum of the squares of the residuals of a pose, each in units of its usual error.
    pub fn cost(&self, x_cp: &Pose) -> f64 {
        let mut cost = 0.0;
        self.each(x_cp, &mut |residual, _| cost += residual * residual);
        cost
    }
}

impl Terms for Corners<'_> {
    fn each(&self, x_cp: &Pose, take: &mut dyn FnMut(f64, &RowVector6<f64>)) {
        for (p_p, pixel) in self.points {
            let Some((at, slope)) = project(self.camera, &(x_cp * p_p)) else { continue };
            let rows = slope * motion(x_cp, p_p);
            for axis in 0..2 {
                take((at[axis] - pixel[axis]) / CORNER_ERROR, &(rows.row(axis) / CORNER_ERROR));
            }
        }
    }
}

impl Terms for Edges<'_> {
    fn each(&self, x_cp: &Pose, take: &mut dyn FnMut(f64, &RowVector6<f64>)) {
        for place in self.places {
            let Some((at, slope)) = project(self.camera, &(x_cp * place.p_p)) else { continue };
            let rows = slope * motion(x_cp, &place.p_p);
            let [nx, ny] = place.normal;
            let residual = nx * at[0] + ny * at[1] - place.along;
            take(residual / EDGE_ERROR, &((rows.row(0) * nx + rows.row(1) * ny) / EDGE_ERROR));
        }
    }
}

impl Terms for Level {
    fn each(&self, x_cp: &Pose, take: &mut dyn FnMut(f64, &RowVector6<f64>)) {
        let r_wc = self.r_wc.matrix();
        let [height, sigma] = self.height;
        let z = self.eye + (self.r_wc * (x_cp * self.p_p).coords).z;
        let row = r_wc.row(2) * motion(x_cp, &self.p_p) / sigma;
        take((z - height) / sigma, &row);
        let sign = if self.flipped { -1.0 } else { 1.0 };
        let up = x_cp.rotation * Vector3::z() * sign;
        let up_w = self.r_wc * up;
        let slope = -r_wc * up.cross_matrix();
        for axis in 0..2 {
            let mut row = RowVector6::zeros();
            row.fixed_view_mut::<1, 3>(0, 3).copy_from(&(slope.row(axis) / self.tilt));
            take(up_w[axis] / self.tilt, &row);
        }
    }
}

/// Both of two.
pub struct Both<'a, A, B>(pub &'a A, pub Option<&'a B>);

impl<A: Terms, B: Terms> Terms for Both<'_, A, B> {
    fn each(&self, x_cp: &Pose, take: &mut dyn FnMut(f64, &RowVector6<f64>)) {
        self.0.each(x_cp, take);
        if let Some(other) = self.1 {
            other.each(x_cp, take);
        }
    }
}

/// A pose that was fitted.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Pose of the part in the optical frame.
    pub x_cp: Pose,
    /// Sum of the squares of all residuals, each in units of its usual error.
    pub cost: f64,
    /// Number of residuals.
    pub count: usize,
    /// Inverse of the covariance of shift (m) and turn (rad) about the part's origin, axes of the optical
    /// frame, for residuals of their usual size.
    pub information: Matrix6<f64>,
}

pub(crate) fn moved(x: &Pose, delta: &Vector6<f64>) -> Pose {
    let turn = UnitQuaternion::from_scaled_axis(delta.fixed_rows::<3>(3).into_owned());
    Pose::from_parts(Translation3::from(x.translation.vector + delta.fixed_rows::<3>(0)), turn * x.rotation)
}

/// Moves the part from `start` until the residuals are as small as can be; `None` when that leads nowhere.
pub fn fit(terms: &impl Terms, start: &Pose, steps: usize) -> Option<Fit> {
    let mut x_cp = *start;
    let mut damping = 1e-3;
    let sum = |x_cp: &Pose| -> (Matrix6<f64>, Vector6<f64>, f64, f64, usize) {
        let (mut matrix, mut vector) = (Matrix6::zeros(), Vector6::zeros());
        let (mut robust, mut cost, mut count) = (0.0, 0.0, 0);
        terms.each(x_cp, &mut |residual, row| {
            let size = residual.abs();
            let weight = if size > HUBER { HUBER / size } else { 1.0 };
            matrix += row.transpose() * row * weight;
            vector += row.transpose() * (residual * weight);
            robust += if size > HUBER { HUBER * (2.0 * size - HUBER) } else { size * size };
            cost += residual * residual;
            count += 1;
        });
        (matrix, vector, robust, cost, count)
    };
    let mut now = sum(&x_cp);
    for _ in 0..steps {
        let mut matrix = now.0;
        for axis in 0..6 {
            matrix[(axis, axis)] *= 1.0 + damping;
        }
        let delta = matrix.cholesky()?.solve(&(-now.1));
        if !delta.iter().all(|value| value.is_finite()) {
            return None;
        }
        let next_x = moved(&x_cp, &delta);
        let next = sum(&next_x);
        if next.4 == now.4 && next.2 <= now.2 {
            let gain = now.2 - next.2;
            (x_cp, now) = (next_x, next);
            damping *= 0.2;
            if gain < 1e-6 * (1.0 + now.2) {
                break;
            }
        } else {
            damping *= 10.0;
            if damping > 1e6 {
                break;
            }
        }
    }
    let (information, _, _, cost, count) = now;
    (x_cp.translation.z > 0.0).then_some(Fit { x_cp, cost, count, information })
}

/// The two poses that one tag alone may have: from the map of its plane to the image, and the same with its
/// face turned to the other side of the line of sight. Pose of the part in the optical frame.
pub fn candidates(camera: &CameraModel, tag: &TagPlace, corners: &[[f64; 2]; 4]) -> Option<[Pose; 2]> {
    let half = tag.edge / 2.0;
    // Eight equations for the eight numbers of the map.
    let mut matrix = SMatrix::<f64, 8, 8>::zeros();
    let mut vector = SVector::<f64, 8>::zeros();
    for (index, ([x, y], pixel)) in
        [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].iter().zip(corners).enumerate()
    {
        let [u, v] = camera.direction(*pixel);
        matrix.row_mut(2 * index).copy_from_slice(&[*x, *y, 1.0, 0.0, 0.0, 0.0, -u * x, -u * y]);
        matrix.row_mut(2 * index + 1).copy_from_slice(&[0.0, 0.0, 0.0, *x, *y, 1.0, -v * x, -v * y]);
        vector[2 * index] = u;
        vector[2 * index + 1] = v;
    }
    let h = matrix.lu().solve(&vector)?;
    let columns = [
        Vector3::new(h[0], h[3], h[6]) / half,
        Vector3::new(h[1], h[4], h[7]) / half,
        Vector3::new(h[2], h[5], 1.0),
    ];
    let scale = 2.0 / (columns[0].norm() + columns[1].norm());
    let [x, y, t] = columns.map(|column| column * scale);
    if !(t.z > 0.0 && t.norm() < 10.0) {
        return None;
    }
    let rotation = UnitQuaternion::from_matrix(&Matrix3::from_columns(&[x, y, x.cross(&y)]));
    let first = Pose::from_parts(Translation3::from(t), rotation);
    // The face turned about the line of sight.
    let (normal, sight) = (rotation * Vector3::z(), t.normalize());
    let other = 2.0 * normal.dot(&sight) * sight - normal;
    let turn = UnitQuaternion::rotation_between(&normal, &other)?;
    let second = Pose::from_parts(Translation3::from(t), turn * rotation);
    Some([first, second].map(|x_cg| x_cg * tag.x_pg.inverse()))
}
