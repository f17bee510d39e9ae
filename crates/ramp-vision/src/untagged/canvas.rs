//! A drawing of the believed scene: for each pixel the triangle that shows there, and its distance.
//!
//! It is drawn through a lens without distortion, so that straight edges stay straight and a pixel's
//! direction is a division away. An image is looked at through its own lens ([`crate::untagged::profile`]).

use nalgebra::{Matrix2x3, Point3};
use ramp_robot::{CameraModel, Pose};

use super::solids::{Colour, Surface};

/// Nothing nearer than this is drawn, m.
const NEAR: f32 = 0.01;
/// Where no body shows.
pub const GROUND: u32 = 0;
/// Light from everywhere and light from above, shares of full light.
const AMBIENT: f32 = 0.5;
const ABOVE: f32 = 0.5;

/// A lens without distortion that shows all that a camera shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Lens {
    /// Pixels in a row, and rows.
    pub size: [usize; 2],
    /// Focal lengths, pixels.
    pub focal: [f64; 2],
    /// Principal point, pixels.
    pub centre: [f64; 2],
}

impl Lens {
    /// That of a camera, at its resolution in the middle of the image.
    pub fn of(camera: &CameraModel) -> Lens {
        const STEPS: usize = 16;
        let [w, h] = [camera.width as f64, camera.height as f64];
        let mut most = [0.0f64; 2];
        for step in 0..=STEPS {
            let share = step as f64 / STEPS as f64;
            for border in [[share * w, 0.0], [share * w, h], [0.0, share * h], [w, share * h]] {
                let direction = camera.direction(border);
                for axis in 0..2 {
                    most[axis] = most[axis].max((direction[axis] * camera.focal[axis]).abs());
                }
            }
        }
        let centre = most.map(f64::ceil);
        Lens { size: centre.map(|half| 2 * half as usize), focal: camera.focal, centre }
    }

    /// The pixel of a point in front of the camera (optical frame, m).
    #[inline]
    pub fn project(&self, p: &Point3<f64>) -> [f64; 2] {
        [self.focal[0] * p.x / p.z + self.centre[0], self.focal[1] * p.y / p.z + self.centre[1]]
    }

    /// The derivative of [`Lens::project`] by the point.
    pub fn slope(&self, p: &Point3<f64>) -> Matrix2x3<f64> {
        let [fx, fy] = self.focal.map(|focal| focal / p.z);
        Matrix2x3::new(fx, 0.0, -fx * p.x / p.z, 0.0, fy, -fy * p.y / p.z)
    }

    /// The direction (x/z, y/z) of a pixel.
    #[inline]
    pub fn direction(&self, pixel: [f64; 2]) -> [f64; 2] {
        [(pixel[0] - self.centre[0]) / self.focal[0], (pixel[1] - self.centre[1]) / self.focal[1]]
    }
}

/// What a number on the canvas stands for.
#[derive(Clone, Copy, Debug)]
pub struct Face {
    /// The number of the body, as it was given.
    pub body: u16,
    /// The colour of its material.
    pub material: Colour,
    /// The colour that it shows in even light from above.
    pub colour: Colour,
    /// Its normal, outwards, in the optical frame.
    pub normal: [f32; 3],
}

/// A drawing.
#[derive(Debug)]
pub struct Canvas {
    /// The lens.
    pub lens: Lens,
    /// One over the distance along the axis, 1/m, for each pixel; 0 on the ground.
    pub near: Vec<f32>,
    /// The number of the face for each pixel, [`GROUND`] where none is.
    pub shown: Vec<u32>,
    /// The faces by number.
    pub faces: Vec<Face>,
    /// First and last column and row (exclusive) that are drawn.
    window: [[usize; 2]; 2],
    screen: Vec<[f32; 3]>,
}

impl Canvas {
    /// An empty one for a camera.
    pub fn new(camera: &CameraModel) -> Canvas {
        let lens = Lens::of(camera);
        let [w, h] = lens.size;
        let count = w * h;
        Canvas {
            near: vec![0.0; count],
            shown: vec![GROUND; count],
            faces: Vec::new(),
            window: [[0, w], [0, h]],
            screen: Vec::new(),
            lens,
        }
    }

    /// The face that shows at a place; `None` on the ground and outside.
    pub fn face_at(&self, [x, y]: [f64; 2]) -> Option<&Face> {
        let [w, h] = self.lens.size;
        if !(x >= 0.0 && y >= 0.0 && x < w as f64 && y < h as f64) {
            return None;
        }
        let shown = self.shown[y as usize * w + x as usize];
        self.faces.get(shown as usize).filter(|_| shown != GROUND)
    }

    /// The columns and the rows that are drawn: first, and last exclusive.
    pub fn window(&self) -> [[usize; 2]; 2] {
        self.window
    }

    /// Clears a window (columns and rows, last exclusive) to be drawn in.
    pub fn begin(&mut self, window: [[usize; 2]; 2]) {
        let [w, h] = self.lens.size;
        self.window = [window[0].map(|x| x.min(w)), window[1].map(|y| y.min(h))];
        let [[x0, x1], [y0, y1]] = self.window;
        for y in y0..y1 {
            self.near[y * w + x0..y * w + x1].fill(0.0);
            self.shown[y * w + x0..y * w + x1].fill(GROUND);
        }
        self.faces.clear();
        self.faces.push(Face { body: u16::MAX, material: [0.0; 3], colour: [0.0; 3], normal: [0.0; 3] });
    }

    /// The window around a surface at `x_cb` in the optical frame; `None` where it is not in view.
    pub fn bounds(&self, surface: &Surface, x_cb: &Pose) -> Option<[[f64; 2]; 2]> {
        let ([x, y, z], radius) = surface.ball;
        let centre = x_cb * Point3::new(f64::from(x), f64::from(y), f64::from(z));
        let radius = f64::from(radius);
        let nearest = centre.z - radius;
        if centre.z <= 0.0 {
            return None;
        }
        let mut bounds = [[0.0; 2]; 2];
        for axis in 0..2 {
            let size = self.lens.size[axis] as f64;
            if nearest < f64::from(NEAR) {
                bounds[axis] = [0.0, size];
                continue;
            }
            // A ball at a slant looks longer than from the front.
            let slant = (1.0 + (centre[axis] / centre.z).powi(2)).sqrt();
            let middle = self.lens.focal[axis] * centre[axis] / centre.z + self.lens.centre[axis];
            let half = self.lens.focal[axis] * radius / nearest * slant;
            bounds[axis] = [(middle - half).max(0.0), (middle + half).min(size)];
            if bounds[axis][0] >= bounds[axis][1] {
                return None;
            }
        }
        Some(bounds)
    }

    /// Draws a body at `x_cb` in the optical frame. `up` is the vertical in that frame.
    pub fn draw(&mut self, surface: &Surface, x_cb: &Pose, body: u16, up: [f32; 3]) {
        let Some(bounds) = self.bounds(surface, x_cb) else { return };
        let outside = |axis: usize| {
            let [from, to] = self.window[axis].map(|value| value as f64);
            bounds[axis][1] < from || bounds[axis][0] > to
        };
        if outside(0) || outside(1) {
            return;
        }
        let rotation = x_cb.rotation.to_rotation_matrix().matrix().map(|value| value as f32);
        let shift = x_cb.translation.vector.map(|value| value as f32);
        let [fx, fy] = self.lens.focal.map(|value| value as f32);
        let [cx, cy] = self.lens.centre.map(|value| value as f32);
        self.screen.clear();
        self.screen.extend(surface.points.iter().map(|p| {
            let p = rotation * nalgebra::Vector3::from(*p) + shift;
            let near = 1.0 / p.z;
            if p.z < NEAR { [0.0, 0.0, -1.0] } else { [fx * p.x * near + cx, fy * p.y * near + cy, near] }
        }));
        let first = self.faces.len() as u32;
        self.faces.extend(surface.patches.iter().map(|(normal, colour)| {
            let normal = rotation * nalgebra::Vector3::from(*normal);
            let light = AMBIENT + ABOVE * (normal.dot(&nalgebra::Vector3::from(up))).max(0.0);
            let shows = colour.map(|share| share * light);
            Face { body, material: *colour, colour: shows, normal: normal.into() }
        }));
        for (triangle, patch) in surface.triangles.iter().zip(&surface.patch_of) {
            let corners = triangle.map(|corner| self.screen[corner as usize]);
            self.fill(&corners, first + patch);
        }
    }

    /// Fills a triangle that is seen from outside.
    fn fill(&mut self, corners: &[[f32; 3]; 3], number: u32) {
        let [a, b, c] = corners;
        if a[2] < 0.0 || b[2] < 0.0 || c[2] < 0.0 {
            return;
        }
        // Rows go down, so what is anticlockwise from outside has a negative area here.
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if area > -1.0e-6 {
            return;
        }
        let [columns, rows] = self.window;
        let width = self.lens.size[0];
        let span = |axis: usize, limits: [usize; 2]| {
            let low = a[axis].min(b[axis]).min(c[axis]) - 0.5;
            let high = a[axis].max(b[axis]).max(c[axis]) - 0.5;
            // The pixels whose middles are within.
            (ceil(low).max(limits[0] as i32), (ceil(high) + 1).min(limits[1] as i32))
        };
        let ((left, right), (top, bottom)) = (span(0, columns), span(1, rows));
        if left >= right || top >= bottom {
            return;
        }
        // One over the distance is linear on the image.
        let plane = |u: f32, v: f32| {
            ((u * (c[1] - a[1]) - v * (b[1] - a[1])) / area, (v * (b[0] - a[0]) - u * (c[0] - a[0])) / area)
        };
        let (dx, dy) = plane(b[2] - a[2], c[2] - a[2]);
        // Within: to the right of each edge that goes up, to the left of each that goes down.
        // Its crossings are computed from the same end for both triangles of an edge.
        let edges = [[a, b], [b, c], [c, a]].map(|[p, q]| {
            let rises = q[1] > p[1];
            let (low, high) = if rises { (p, q) } else { (q, p) };
            let height = high[1] - low[1];
            let slope = if height > 0.0 { (high[0] - low[0]) / height } else { 0.0 };
            (rises, height > 0.0, low[0] - 0.5, low[1], slope)
        });
        for y in top..bottom {
            let middle = y as f32 + 0.5;
            let (mut from, mut to) = (left, right);
            for (rises, has_height, x, y, slope) in &edges {
                let at = ceil(x + slope * (middle - y));
                if *rises {
                    from = from.max(at);
                } else if *has_height {
                    to = to.min(at);
                }
            }
            if from >= to {
                continue;
            }
            let (from, to) = (from as usize, to as usize);
            let row_start = y as usize * width;
            let start = a[2] + dx * (from as f32 + 0.5 - a[0]) + dy * (middle - a[1]);
            let row = row_start + from..row_start + to;
            let pixels = self.near[row.clone()].iter_mut().zip(&mut self.shown[row]);
            for ((near, shown), step) in pixels.zip(0i32..) {
                // Without a branch: several pixels go at once.
                let value = start + dx * step as f32;
                let nearer = value > *near;
                *near = if nearer { value } else { *near };
                *shown = if nearer { number } else { *shown };
            }
        }
    }
}

/// The smallest whole number that is not smaller, of what may be a pixel.
#[inline]
fn ceil(value: f32) -> i32 {
    let whole = value as i32;
    whole + i32::from(value > whole as f32)
}
