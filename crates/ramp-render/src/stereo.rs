//! A depth sensor with two lenses: from the distances that a picture shows to those that it measures.
//!
//! It finds for each pixel the disparity, the shift of what it shows between the images of both lenses, in
//! steps of a fraction of a pixel. So its errors are those of the disparity, and grow with the square of the
//! distance: white noise; a bias that changes slowly over the image and stays as it is from image to image;
//! and nearer surfaces that spread over what is beside them, since a window of pixels is compared. There is
//! no depth where the second lens does not see what the first one sees, nearer than the largest disparity
//! that is looked for, and in patches of shiny metal. Points between two surfaces, and steps of the matching
//! other than those of the disparity, are not modelled.

use ramp_robot::random::Stream;
use ramp_robot::{Camera, DEPTH_UNIT, ImageWidth};

use crate::draw::Renderer;

/// Steps of a disparity to a pixel: datasheets of the RealSense D400 series.
const STEPS: f32 = 32.0;
/// The largest disparity that is looked for, pixels: the same.
const MOST_DISPARITY: f32 = 126.0;
/// Entries in the table of noise.
const TABLE: usize = 1 << 16;
/// Share of its neighbour's noise that a pixel's noise has, since windows overlap: what is left over a
/// pixel and a half.
const CORRELATION: f64 = 0.5;
/// Distance over which the bias changes, pixels.
const SLOW: usize = 160;
/// Side of a patch in which surfaces spread, or metal has no depth, pixels.
const PATCH: usize = 16;
/// Half of the window that is compared, pixels.
const WINDOW: usize = 2;
/// Difference of places in the second image from which on the nearer one hides the other, pixels.
const HIDES: f32 = 1.0;

/// Errors of a depth sensor, at the full size of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StereoErrors {
    /// White noise of the disparity, pixels (1 σ).
    pub noise: f64,
    /// Slow bias of the disparity, pixels (1 σ).
    pub bias: f64,
    /// Share of the image in which nearer surfaces spread.
    pub spread: f64,
    /// Share of metal without depth.
    pub holes: f64,
}

/// A depth sensor, with its own random numbers.
#[derive(Clone, Debug)]
pub struct StereoSensor {
    baseline: f64,
    errors: StereoErrors,
    stream: Stream,
    noise: Vec<f32>,
    /// The bias at nodes that are [`SLOW`] apart, row by row.
    bias: Vec<f32>,
}

/// Nodes of the bias in a row: one beyond each side of an image of full size.
fn columns() -> usize {
    ImageWidth::full().pixels() / SLOW + 2
}

impl StereoSensor {
    /// The sensor of a camera in the episode of this seed.
    pub fn new(seed: u64, camera: Camera, errors: StereoErrors) -> StereoSensor {
        let mut stream = Stream::new(seed, &format!("depth-{}", camera.name()));
        let fresh = (1.0 - CORRELATION * CORRELATION).sqrt();
        let mut last = stream.normal(1.0);
        let noise = (0..TABLE)
            .map(|_| {
                last = CORRELATION * last + fresh * stream.normal(1.0);
                (last * errors.noise) as f32
            })
            .collect();
        let bias = (0..columns() * columns()).map(|_| stream.normal(errors.bias) as f32).collect();
        StereoSensor { baseline: camera.baseline(), errors, stream, noise, bias }
    }

    /// Measures the last picture of a renderer: the distance along the optical axis in each pixel, in
    /// [`DEPTH_UNIT`], 0 where there is none.
    pub fn measure(&mut self, renderer: &Renderer) -> Vec<u16> {
        let [width, height] = renderer.size();
        // The sensor measures at its own size, whatever the size of the image.
        let scale = ImageWidth::full().pixels() as f32 / width as f32;
        let factor = (renderer.focal() * f64::from(scale) * self.baseline) as f32;
        let mut seen = renderer.nearness();
        seen.iter_mut().for_each(|near| *near *= factor);
        // The first pixel of each patch in a row of the image.
        let own = |index: usize| (index as f32 * scale) as usize;
        let begins: Vec<usize> =
            (0..width).filter(|x| *x == 0 || own(*x) / PATCH != own(*x - 1) / PATCH).collect();
        let ends = || begins[1..].iter().chain([&width]);
        let mut patches = vec![(false, false); begins.len()];
        let window = (WINDOW as f32 / scale).round() as usize;
        let mut patch_row = usize::MAX;
        let (mut row, mut wide, mut high) = (vec![0.0f32; width], vec![0.0f32; width], vec![0.0f32; width]);
        let mut depth = Vec::with_capacity(width * height);
        for y in 0..height {
            if own(y) / PATCH != patch_row {
                patch_row = own(y) / PATCH;
                for (spreads, hole) in &mut patches {
                    *spreads = self.stream.uniform() < self.errors.spread;
                    *hole = self.stream.uniform() < self.errors.holes;
                }
            }
            let here = &seen[y * width..][..width];
            spread(&seen, (width, window), y, &mut high, &mut wide);
            self.add_errors(own(y), scale, &mut row);
            for ((from, to), (spreads, hole)) in begins.iter().zip(ends()).zip(&patches) {
                let shown = if *spreads { &wide } else { here };
                for (row, shown) in row[*from..*to].iter_mut().zip(&shown[*from..*to]) {
                    *row += shown;
                }
                if *hole {
                    for (x, row) in (*from..*to).zip(&mut row[*from..*to]) {
                        *row = if renderer.shows_metal(y * width + x) { 0.0 } else { *row };
                    }
                }
            }
            hide(here, scale, &mut row);
            depth.extend(row.iter().map(|disparity| to_depth(*disparity, factor)));
        }
        depth
    }

    /// Noise and bias of a row: `y` is its number at the full size, of which a pixel has `scale`.
    fn add_errors(&mut self, y: usize, scale: f32, row: &mut [f32]) {
        let room = self.noise.len().saturating_sub(row.len());
        let from = (self.stream.uniform() * room as f64) as usize;
        let nodes = columns();
        let (below, v) = (y / SLOW, (y % SLOW) as f32 / SLOW as f32);
        let node = |column: usize| {
            let at = |row: usize| self.bias[row * nodes + column];
            at(below) * (1.0 - v) + at(below + 1) * v
        };
        let at_nodes: Vec<f32> = (0..nodes).map(node).collect();
        for ((error, noise), x) in row.iter_mut().zip(&self.noise[from..]).zip(0..) {
            let place = x as f32 * (scale / SLOW as f32);
            let column = place as usize;
            let u = place - column as f32;
            *error = noise + at_nodes[column] * (1.0 - u) + at_nodes[column + 1] * u;
        }
    }
}

/// The largest disparity within `window` pixels of each pixel of a row, in `wide`; `high` holds the largest
/// of each column meanwhile.
fn spread(seen: &[f32], (width, window): (usize, usize), y: usize, high: &mut [f32], wide: &mut [f32]) {
    let rows = seen.len() / width;
    high.fill(0.0);
    for other in y.saturating_sub(window)..(y + window + 1).min(rows) {
        for (high, seen) in high.iter_mut().zip(&seen[other * width..][..width]) {
            *high = if *seen > *high { *seen } else { *high };
        }
    }
    wide.copy_from_slice(high);
    for shift in 1..=window.min(width - 1) {
        for (wide, other) in wide.iter_mut().zip(&high[shift..]) {
            *wide = if *other > *wide { *other } else { *wide };
        }
        for (wide, other) in wide[shift..].iter_mut().zip(&*high) {
            *wide = if *other > *wide { *other } else { *wide };
        }
    }
}

/// Takes the disparity from what a nearer surface to the right hides from the second lens, and from what that
/// lens does not see at all.
fn hide(here: &[f32], scale: f32, row: &mut [f32]) {
    let mut least = f32::INFINITY;
    for ((row, here), x) in row.iter_mut().zip(here).zip(0..here.len()).rev() {
        let place = x as f32 * scale - here;
        *row = if place < 0.0 || place > least + HIDES { 0.0 } else { *row };
        least = if place < least { place } else { least };
    }
}

/// The depth of a disparity, of which `factor` is that at a distance of 1 m.
fn to_depth(disparity: f32, factor: f32) -> u16 {
    let steps = (disparity * STEPS + 0.5) as i32;
    // Beyond what 16 bits hold it is 0, as where there is none.
    let units = factor * (STEPS / DEPTH_UNIT as f32) / steps.max(1) as f32 + 0.5;
    let measured = steps > 0 && steps <= (MOST_DISPARITY * STEPS) as i32 && units < f32::from(u16::MAX);
    if measured { units as i32 as u16 } else { 0 }
}
