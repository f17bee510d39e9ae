//! First estimates in closed form, from which [`adjust`](crate::adjust) starts.

use nalgebra::{DMatrix, Matrix3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::tags::TagPlace;
use ramp_robot::{CameraModel, Pose};
use ramp_vision::detect::Detection;
use ramp_vision::find::corner_points;

/// The map from a plane of the target to the image, of points (x, y) of the target's plane z = 0 (m) and
/// where they are seen: a homography with a Frobenius norm of 1. `None` for fewer than four points or for
/// points on a line.
pub fn homography(points: &[([f64; 2], [f64; 2])]) -> Option<Matrix3<f64>> {
    if points.len() < 4 {
        return None;
    }
    // Both sides about their mean and of unit size, so that the equations weigh alike.
    let (from, from_map) = normalised(points.iter().map(|(from, _)| *from).collect())?;
    let (to, to_map) = normalised(points.iter().map(|(_, to)| *to).collect())?;
    let mut equations = DMatrix::zeros(2 * points.len(), 9);
    for (index, ([x, y], [u, v])) in from.iter().zip(&to).enumerate() {
        let rows = [
            [*x, *y, 1.0, 0.0, 0.0, 0.0, -u * x, -u * y, -u],
            [0.0, 0.0, 0.0, *x, *y, 1.0, -v * x, -v * y, -v],
        ];
        for (row, values) in rows.iter().enumerate() {
            equations.row_mut(2 * index + row).copy_from_slice(values);
        }
    }
    let eigen = (equations.transpose() * &equations).symmetric_eigen();
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    // A second map that fits as well: the points lie on a line.
    if eigen.eigenvalues[order[1]] < 1e-9 * eigen.eigenvalues[order[8]] {
        return None;
    }
    let h = eigen.eigenvectors.column(order[0]);
    let h = Matrix3::new(h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8]);
    let h = to_map.try_inverse()? * h * from_map;
    Some(h / h.norm())
}

/// Points about their mean with a mean distance of 1, and the map that makes them so.
fn normalised(points: Vec<[f64; 2]>) -> Option<(Vec<[f64; 2]>, Matrix3<f64>)> {
    let count = points.len() as f64;
    let mean = [0, 1].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / count);
    let size = points.iter().map(|[x, y]| (x - mean[0]).hypot(y - mean[1])).sum::<f64>() / count;
    if size < 1e-12 {
        return None;
    }
    let scale = 1.0 / size;
    let map = Matrix3::new(scale, 0.0, -mean[0] * scale, 0.0, scale, -mean[1] * scale, 0.0, 0.0, 1.0);
    let moved = points.iter().map(|[x, y]| [(x - mean[0]) * scale, (y - mean[1]) * scale]);
    Some((moved.collect(), map))
}

/// The corners of tags in the target's plane z = 0, m, and in the image, pixels.
pub fn plane_points(tags: &[(TagPlace, Detection)]) -> Vec<([f64; 2], [f64; 2])> {
    tags.iter()
        .flat_map(|(place, detection)| {
            corner_points(place).into_iter().zip(detection.corners).map(|(p, pixel)| ([p.x, p.y], pixel))
        })
        .collect()
}

/// Pose of a flat target (its plane z = 0) in the optical frame of a camera whose lens is known about.
pub fn plane_pose(camera: &CameraModel, tags: &[(TagPlace, Detection)]) -> Option<Pose> {
    let points: Vec<_> =
        plane_points(tags).into_iter().map(|(point, pixel)| (point, camera.direction(pixel))).collect();
    let h = homography(&points)?;
    let [x, y, t] = [0, 1, 2].map(|column| h.column(column).into_owned());
    // The target lies in front of the camera.
    let scale = 2.0 / (x.norm() + y.norm()) * t.z.signum();
    let (x, y, t): (Vector3<f64>, Vector3<f64>, Vector3<f64>) = (x * scale, y * scale, t * scale);
    let rotation = UnitQuaternion::from_matrix(&Matrix3::from_columns(&[x, y, x.cross(&y)]));
    t.iter().all(|value| value.is_finite()).then(|| Pose::from_parts(Translation3::from(t), rotation))
}

/// The focal length, pixels, of a camera that sees flat targets by these homographies in pixels from the
/// middle of the image; `None` if they leave it open. The images of the axes x and y of a target are at right
/// angles and of equal length, seen from the camera.
pub fn focal_length(homographies: &[Matrix3<f64>]) -> Option<f64> {
    let (mut numerator, mut denominator) = (0.0, 0.0);
    for h in homographies {
        let (a, b) = (h.column(0), h.column(1));
        // Both say: across = -f² · along.
        let equations = [
            (a[0] * b[0] + a[1] * b[1], a[2] * b[2]),
            (a[0] * a[0] + a[1] * a[1] - b[0] * b[0] - b[1] * b[1], a[2] * a[2] - b[2] * b[2]),
        ];
        for (across, along) in equations {
            numerator -= across * along;
            denominator += along * along;
        }
    }
    let square = numerator / denominator;
    (square.is_finite() && square > 0.0).then(|| square.sqrt())
}
