//! A lens: from points to pixels and, from a table, from pixels to directions.

use ramp_robot::CameraModel;

/// Pixels between two directions that are worked out exactly; those between are interpolated, good to a
/// hundredth of a pixel for a lens of 90°.
const GRID: usize = 8;

/// A camera's lens.
#[derive(Clone, Debug)]
pub struct Lens {
    /// The camera.
    pub model: CameraModel,
    focal: [f32; 2],
    centre: [f32; 2],
    distortion: [f32; 5],
    /// Squared distance from the axis beyond which the distortion grows no further: far outside the image.
    limit: f32,
    /// Direction in the middle of each pixel, row by row: all x/z, and all y/z.
    directions: [Vec<f32>; 2],
}

impl Lens {
    /// The lens of a camera.
    pub fn new(model: &CameraModel) -> Lens {
        let (width, height) = (model.width, model.height);
        let (columns, rows) = (width.div_ceil(GRID) + 1, height.div_ceil(GRID) + 1);
        let exact: Vec<[f64; 2]> = (0..rows * columns)
            .map(|index| {
                let (row, column) = (index / columns, index % columns);
                model.direction([(column * GRID) as f64 + 0.5, (row * GRID) as f64 + 0.5])
            })
            .collect();
        let mut directions = [0, 1].map(|_| Vec::with_capacity(width * height));
        for y in 0..height {
            let (row, v) = (y / GRID, (y % GRID) as f64 / GRID as f64);
            for x in 0..width {
                let (column, u) = (x / GRID, (x % GRID) as f64 / GRID as f64);
                let corner = |row: usize, column: usize, axis: usize| exact[row * columns + column][axis];
                for (axis, directions) in directions.iter_mut().enumerate() {
                    let top = corner(row, column, axis) * (1.0 - u) + corner(row, column + 1, axis) * u;
                    let low =
                        corner(row + 1, column, axis) * (1.0 - u) + corner(row + 1, column + 1, axis) * u;
                    directions.push((top * (1.0 - v) + low * v) as f32);
                }
            }
        }
        let corner = exact.iter().map(|[x, y]| x * x + y * y).fold(0.0, f64::max);
        Lens {
            model: model.clone(),
            focal: model.focal.map(|value| value as f32),
            centre: model.centre.map(|value| value as f32),
            distortion: model.distortion.map(|value| value as f32),
            limit: 1.5 * corner as f32,
            directions,
        }
    }

    /// The pixel of a point of the optical frame (m) that lies in front of the camera.
    #[inline]
    pub fn project(&self, [x, y, z]: [f32; 3]) -> [f32; 2] {
        let one = 1.0 / z;
        let (x, y) = (x * one, y * one);
        let [k1, k2, p1, p2, k3] = self.distortion;
        let r2 = (x * x + y * y).min(self.limit);
        let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        let xd = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
        let yd = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
        [self.focal[0] * xd + self.centre[0], self.focal[1] * yd + self.centre[1]]
    }

    /// Directions of the pixels of a row: x/z, and y/z.
    pub fn row(&self, y: usize) -> [&[f32]; 2] {
        let width = self.model.width;
        let [xs, ys] = &self.directions;
        [&xs[y * width..][..width], &ys[y * width..][..width]]
    }

    /// Change of direction from a pixel to the next one on the right and to the one below.
    #[inline]
    pub fn step(&self, x: usize, y: usize) -> [[f32; 2]; 2] {
        let (width, height) = (self.model.width, self.model.height);
        let at = |x: usize, y: usize| [0, 1].map(|axis| self.directions[axis][y * width + x]);
        let (left, right) = (x.saturating_sub(1), (x + 1).min(width - 1));
        let (up, down) = (y.saturating_sub(1), (y + 1).min(height - 1));
        let between =
            |a: [f32; 2], b: [f32; 2], n: usize| [(b[0] - a[0]) / n as f32, (b[1] - a[1]) / n as f32];
        [between(at(left, y), at(right, y), right - left), between(at(x, up), at(x, down), down - up)]
    }
}
