//! Triangles into the depth buffer: which pixels each covers, and whether it is the nearest there.

use super::renderer::Renderer;
use super::rigid::Rigid;
use crate::mesh::Mesh;

/// Nothing nearer than this is drawn, m.
pub(super) const NEAR: f32 = 0.01;
/// More pixels from row to row than an edge needs to cross any image between two rows.
const STEEP: f32 = 4e6;

impl Renderer {
    /// Could a ball be in the image?
    pub(super) fn in_view(&self, camera: &Rigid, (centre, radius): ([f32; 3], f32)) -> bool {
        let [x, y, z] = camera.moved(&centre);
        if z + radius < NEAR {
            return false;
        }
        // The half angles of the image's sides, a little wider.
        let model = &self.lens.model;
        let side = |value: f32, pixels: usize, focal: f64| {
            let slope = 0.58 * pixels as f32 / focal as f32;
            value.abs() - radius * (1.0 + slope * slope).sqrt() < slope * z.max(0.0)
        };
        side(x, model.width, model.focal[0]) && side(y, model.height, model.focal[1])
    }

    /// Puts the corners of a mesh on the screen: pixels and one over the distance, or −1 behind the camera.
    pub(super) fn project(&mut self, camera: &Rigid, mesh: &Mesh) {
        self.screen.clear();
        for point in &mesh.points {
            let p = camera.moved(point);
            if p[2] < NEAR {
                self.screen.push([0.0, 0.0, -1.0]);
            } else {
                let [x, y] = self.lens.project(p);
                self.screen.push([x, y, 1.0 / p[2]]);
            }
        }
    }

    /// Draws a triangle that is seen from outside; says whether any pixel shows it so far.
    #[inline]
    pub(super) fn triangle(&mut self, corners: &[[f32; 3]; 3], shown: u32) -> bool {
        let [a, b, c] = corners;
        if a[2] < 0.0 || b[2] < 0.0 || c[2] < 0.0 {
            return false;
        }
        // y points down, so what is anticlockwise from outside is clockwise here: a negative area.
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        // Half of them are seen from inside.
        area < -1e-6 && self.fill(corners, area, shown)
    }

    /// Draws a triangle of this area, see [`Renderer::triangle`].
    #[inline(never)]
    fn fill(&mut self, corners: &[[f32; 3]; 3], area: f32, shown: u32) -> bool {
        let [a, b, c] = corners;
        let (width, height) = (self.lens.model.width, self.lens.model.height);
        let low = |axis: usize| a[axis].min(b[axis]).min(c[axis]);
        let high = |axis: usize| a[axis].max(b[axis]).max(c[axis]);
        // Pixels whose middles are inside.
        let first = (-floor(0.5 - low(1))).max(0);
        let last = floor(high(1) - 0.5).min(height as i32 - 1);
        let left = (-floor(0.5 - low(0))).max(0);
        let right = floor(high(0) - 0.5).min(width as i32 - 1);
        if first > last || left > right {
            return false;
        }
        let one = 1.0 / area;
        let slope = |axis: usize| {
            let (b, c) = ((b[2] - a[2]) * one, (c[2] - a[2]) * one);
            if axis == 0 {
                b * (corners[2][1] - a[1]) - c * (corners[1][1] - a[1])
            } else {
                c * (corners[1][0] - a[0]) - b * (corners[2][0] - a[0])
            }
        };
        let (dx, dy) = (slope(0), slope(1));
        // Anticlockwise on the screen: going up the inside lies to the left of an edge, going down to its
        // right.
        let (mut rights, mut lefts) =
            ([Edge::new(f32::INFINITY, 0.0); 2], [Edge::new(f32::NEG_INFINITY, 0.0); 2]);
        let (mut right_count, mut left_count) = (0, 0);
        let top = first as f32 + 0.5;
        for [p, q] in [[a, b], [b, c], [c, a]] {
            let rise = q[1] - p[1];
            let slope = ((q[0] - p[0]) / rise).clamp(-STEEP, STEEP);
            let edge = || Edge::new(p[0] - 0.5 + slope * (top - p[1]), slope);
            if rise < -1e-6 && right_count < 2 {
                rights[right_count] = edge();
                right_count += 1;
            } else if rise > 1e-6 && left_count < 2 {
                lefts[left_count] = edge();
                left_count += 1;
            }
        }
        let (left, right) = (i64::from(left), i64::from(right));
        let mut shows = 0;
        for y in first as usize..=last as usize {
            let middle = y as f32 + 0.5;
            let [[a_right, b_right], [a_left, b_left]] =
                [&mut rights, &mut lefts].map(|edges| edges.each_mut().map(Edge::next));
            let to = right.min(a_right.min(b_right) >> Edge::BITS);
            let from = left.max((a_left.max(b_left) + Edge::ALMOST) >> Edge::BITS);
            if from > to {
                continue;
            }
            let (from, to) = (from as usize, to as usize + 1);
            let start = a[2] + dx * (from as f32 + 0.5 - a[0]) + dy * (middle - a[1]);
            let near = &mut self.near[y * width + from..y * width + to];
            let pixels = &mut self.shown[y * width + from..y * width + to];
            // Without a branch: several pixels go at once, and which ones are hidden cannot be guessed.
            for ((near, pixel), step) in near.iter_mut().zip(pixels).zip(0i32..) {
                let value = start + dx * step as f32;
                let mask = u32::from(value > *near).wrapping_neg();
                *near = f32::from_bits(value.to_bits() & mask | near.to_bits() & !mask);
                *pixel = shown & mask | *pixel & !mask;
                shows |= mask;
            }
        }
        shows != 0
    }
}

/// Crossings of a triangle's edge with the middles of rows, in pixels from the middle of the first: whole
/// numbers of small parts of pixels, so that a row costs an addition.
#[derive(Clone, Copy)]
struct Edge {
    at: i64,
    step: i64,
}

impl Edge {
    /// So many bits are the parts of a pixel.
    const BITS: u32 = 24;
    /// A little less than a pixel.
    const ALMOST: i64 = (1 << Self::BITS) - 1;
    /// Further outside than any image, and far from the end of the numbers.
    const OUTSIDE: f32 = 1e10;

    #[inline]
    fn new(at: f32, step: f32) -> Edge {
        let fixed = |value: f32| {
            // Two comparisons; a NaN becomes the limit.
            let value = if value < Self::OUTSIDE { value } else { Self::OUTSIDE };
            let value = if value > -Self::OUTSIDE { value } else { -Self::OUTSIDE };
            (value * (1i64 << Self::BITS) as f32) as i64
        };
        Edge { at: fixed(at), step: fixed(step) }
    }

    /// Position in this row. Advances to the next row.
    #[inline]
    fn next(&mut self) -> i64 {
        let at = self.at;
        self.at += self.step;
        at
    }
}

/// The largest whole number that is not larger, for numbers of pixels: without a call to the mathematics
/// library.
#[inline]
fn floor(value: f32) -> i32 {
    const SHIFT: i32 = 4096;
    // Two comparisons; a NaN becomes the limit.
    let value = if value < 4000.0 { value } else { 4000.0 };
    let value = if value > -4000.0 { value } else { -4000.0 };
    (value + SHIFT as f32) as i32 - SHIFT
}
