//! How far a step of the image is from where the drawing has it, measured along the step's normal.
//!
//! The drawing's own profile across the step is the pattern that is looked for. So a step that is flanked by
//! another one, as on a thin edge, is not mistaken for it.

use ramp_robot::{CameraModel, Image};

use super::canvas::{Canvas, GROUND, Lens};
use super::contours::Step;
use super::solids::Colour;

/// Half of what is compared on both sides of a step, pixels.
const SUPPORT: f64 = 3.0;
/// Samples per pixel.
const FINE: f64 = 2.0;
/// Width of the pattern's weight about the step (1 σ), pixels.
const WEIGHT: f64 = 1.5;
/// Least contrast of a step in the image, as a share of the drawn one.
const LEAST_CONTRAST: f64 = 0.4;
/// Least difference between both sides of a step in the image, as a share of the drawn one.
const LEAST_NET: f64 = 0.1;
/// Contrast beyond which a step is no better a match.
const FULL_CONTRAST: f64 = 1.2;
/// Discount of a match at the border of the window against one in its middle.
const FAR: f64 = 0.35;
/// Shares of what a lens spreads a point over, in samples of half a pixel; and none, for larger ones.
const BLUR: [f64; 2 * MARGIN + 1] = [0.03, 0.11, 0.22, 0.28, 0.22, 0.11, 0.03];
const NO_BLUR: [f64; 2 * MARGIN + 1] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
const MARGIN: usize = 3;
/// Number of samples of a pattern, and on one side of its middle.
const SAMPLES: usize = 2 * HALF as usize + 1;
const HALF: i32 = (SUPPORT * FINE) as i32;
/// Least energy of a pattern that tells a place.
const LEAST_ENERGY: f64 = 1.0e-7;

/// A step of the image that is taken for one of the drawing.
#[derive(Clone, Copy, Debug)]
pub struct Match {
    /// Signed distance along the normal from where the step is drawn, pixels.
    pub off: f64,
    /// Whether both of its sides show the same, as a printed line does, and those of the drawing do not.
    pub is_line: bool,
}

/// An image, looked at by the pixels of a drawing.
#[derive(Clone)]
pub struct Photograph<'a> {
    image: &'a Image,
    camera: &'a CameraModel,
    lens: Lens,
    linear: [f32; 256],
}

impl<'a> Photograph<'a> {
    /// An image of a camera, which has the size that the model says.
    pub fn new(image: &'a Image, camera: &'a CameraModel, lens: &Lens) -> Photograph<'a> {
        let linear = std::array::from_fn(|value| (value as f32 / 255.0).powf(2.2));
        Photograph { image, camera, lens: lens.clone(), linear }
    }

    /// The image's place of a pixel of the drawing.
    pub fn place(&self, pixel: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.camera.distort(self.lens.direction(pixel));
        let (focal, centre) = (self.camera.focal, self.camera.centre);
        [focal[0] * x + centre[0], focal[1] * y + centre[1]]
    }

    /// Linear light of a channel between the four pixels around a place; `None` outside.
    #[inline]
    pub fn light(&self, channel: usize, [x, y]: [f64; 2]) -> Option<f64> {
        let (width, height) = (self.image.width, self.image.height);
        let (x, y) = (x - 0.5, y - 0.5);
        if !(x >= 0.0 && y >= 0.0 && x < (width - 1) as f64 && y < (height - 1) as f64) {
            return None;
        }
        let (column, row) = (x as usize, y as usize);
        let (u, v) = ((x - column as f64) as f32, (y - row as f64) as f32);
        let from = 3 * (row * width + column) + channel;
        let light = |index: usize| self.linear[usize::from(self.image.pixels[index])];
        let upper = light(from) * (1.0 - u) + light(from + 3) * u;
        let below = from + 3 * width;
        let lower = light(below) * (1.0 - u) + light(below + 3) * u;
        Some(f64::from(upper * (1.0 - v) + lower * v))
    }
}

/// Linear light of a channel of the drawing at a place; `None` outside of its window.
#[inline]
pub fn drawn(canvas: &Canvas, ground: &Colour, channel: usize, [x, y]: [f64; 2]) -> Option<f64> {
    let [[left, right], [top, bottom]] = canvas.window();
    let (x, y) = (x - 0.5, y - 0.5);
    if !(x >= left as f64 && y >= top as f64 && x < right as f64 - 1.0 && y < bottom as f64 - 1.0) {
        return None;
    }
    let (column, row) = (x as usize, y as usize);
    let (u, v) = ((x - column as f64) as f32, (y - row as f64) as f32);
    let width = canvas.lens.size[0];
    let from = row * width + column;
    let light = |index: usize| match canvas.shown[index] {
        GROUND => ground[channel],
        face => canvas.faces[face as usize].colour[channel],
    };
    let upper = light(from) * (1.0 - u) + light(from + 1) * u;
    let lower = light(from + width) * (1.0 - u) + light(from + width + 1) * u;
    Some(f64::from(upper * (1.0 - v) + lower * v))
}

/// The direction in which the drawn light grows at a step.
pub fn normal(canvas: &Canvas, step: &Step) -> Option<[f64; 2]> {
    const WEIGHTS: [f64; 5] = [1.0, 2.0, 3.0, 2.0, 1.0];
    let [x, y] = step.at;
    let light = |x: f64, y: f64| drawn(canvas, &step.ground, step.channel, [x, y]);
    let (mut gx, mut gy) = (0.0, 0.0);
    for (weight, along) in WEIGHTS.iter().zip([-2.0, -1.0, 0.0, 1.0, 2.0]) {
        gx += weight * (light(x + 1.5, y + along)? - light(x - 1.5, y + along)?);
        gy += weight * (light(x + along, y + 1.5)? - light(x + along, y - 1.5)?);
    }
    let length = gx.hypot(gy);
    (length > 1.0e-4).then(|| [gx / length, gy / length])
}

/// The drawing across a step: differences of light, weighted about the step.
#[derive(Clone, Debug)]
pub struct Profile {
    /// The channel of the step.
    channel: usize,
    /// Direction in which the drawn light grows, and the size of a sample along it, pixels.
    normal: [f64; 2],
    size: f64,
    /// The differences, blurred as lenses do.
    pattern: [f64; SAMPLES],
    /// Their product with themselves.
    energy: f64,
    /// The difference between both sides.
    net: f64,
}

impl Profile {
    /// Across a step of a drawing. To be looked for far off, its pixels are `scale` times as large.
    pub fn of(canvas: &Canvas, step: &Step, normal: [f64; 2], scale: f64) -> Option<Profile> {
        let size = scale / FINE;
        let light = |index: f64| {
            let at = [0, 1].map(|axis| step.at[axis] + index * size * normal[axis]);
            drawn(canvas, &step.ground, step.channel, at)
        };
        let mut sharp = [0.0; SAMPLES + 2 * MARGIN];
        let margin = HALF + MARGIN as i32;
        let mut before = light(f64::from(-margin) - 0.5)?;
        for (value, index) in sharp.iter_mut().zip(-margin..=margin) {
            let after = light(f64::from(index) + 0.5)?;
            *value = after - before;
            before = after;
        }
        let blur = if scale < 2.0 { BLUR } else { NO_BLUR };
        let mut pattern = [0.0; SAMPLES];
        let mut energy = 0.0;
        for ((value, from), index) in pattern.iter_mut().zip(sharp.windows(blur.len())).zip(-HALF..=HALF) {
            let difference: f64 = from.iter().zip(&blur).map(|(light, share)| light * share).sum();
            let t = f64::from(index) / FINE;
            *value = difference * (-0.5 * (t / WEIGHT).powi(2)).exp();
            energy += difference * *value;
        }
        let net = sharp[MARGIN..MARGIN + SAMPLES].iter().sum();
        let channel = step.channel;
        (energy >= LEAST_ENERGY).then_some(Profile { channel, normal, size, pattern, energy, net })
    }

    /// The step of the image nearest to where it is drawn, `at` (pixels of the drawing); looked for up to
    /// `reach` on both sides, pixels.
    pub fn distance(&self, photograph: &Photograph, at: [f64; 2], reach: f64) -> Option<Match> {
        let (size, normal) = (self.size, self.normal);
        let far = (reach / size).ceil() as i32;
        // The lens bends little over a window: a straight line through its ends.
        let ends = [-1.0, 1.0]
            .map(|side| photograph.place([0, 1].map(|axis| at[axis] + side * reach * normal[axis])));
        let middle = [0, 1].map(|axis| (ends[0][axis] + ends[1][axis]) / 2.0);
        let along = [0, 1].map(|axis| (ends[1][axis] - ends[0][axis]) / (2.0 * reach));
        let light = |index: f64| {
            let t = index * size;
            photograph.light(self.channel, [middle[0] + t * along[0], middle[1] + t * along[1]])
        };
        let total = HALF + far;
        let mut differences = Vec::with_capacity((2 * total + 1) as usize);
        let mut before = light(f64::from(-total) - 0.5)?;
        for index in -total..=total {
            let after = light(f64::from(index) + 0.5)?;
            differences.push(after - before);
            before = after;
        }
        let scores: Vec<f64> = differences
            .windows(SAMPLES)
            .map(|window| self.pattern.iter().zip(window).map(|(a, b)| a * b).sum::<f64>() / self.energy)
            .collect();
        let offset = |index: usize| (index as f64 - f64::from(far)) * size;
        let mut best: Option<(f64, usize)> = None;
        for index in 1..scores.len() - 1 {
            let score = scores[index];
            if score < LEAST_CONTRAST || score < scores[index - 1] || score < scores[index + 1] {
                continue;
            }
            let value = score.min(FULL_CONTRAST) - FAR * (offset(index) / reach).powi(2);
            if best.is_none_or(|(other, _)| value > other) {
                best = Some((value, index));
            }
        }
        let (_, index) = best?;
        let (a, b, c) = (scores[index - 1], scores[index], scores[index + 1]);
        let curve = a - 2.0 * b + c;
        let between = if curve < 0.0 { 0.5 * (a - c) / curve } else { 0.0 };
        let net: f64 = differences[index..index + SAMPLES].iter().sum();
        let is_line = net / self.net < LEAST_NET && self.net.powi(2) > self.energy;
        Some(Match { off: offset(index) + between * size, is_line })
    }
}
