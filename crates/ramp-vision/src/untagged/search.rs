//! Starts for the fit of a part that is known only roughly: of many poses the one whose drawn steps the image
//! supports best.

use nalgebra::{Point3, Vector3};
use ramp_robot::Pose;

use super::canvas::{Canvas, Lens};
use super::contours::Step;
use super::profile::{Photograph, drawn, normal};

/// Number of steps that are compared.
const STEPS: usize = 72;
/// Distance from a step at which the light on both sides is taken, pixels.
const ASIDE: f64 = 2.0;
/// Least drawn difference of light between the two sides.
const LEAST: f64 = 0.05;

/// Number of steps after which it is asked whether a pose is still worth comparing.
const TOGETHER: usize = 8;

/// Shift over which places in the image are taken to move in proportion, m.
const SHIFT: f64 = 2.0e-3;

/// A step on a part: a point on each side, and the difference of light between them.
#[derive(Clone, Copy, Debug)]
struct Pair {
    bright: Point3<f64>,
    dark: Point3<f64>,
    channel: usize,
    difference: f64,
}

/// The steps of a part as pairs of points in its frame, for comparing poses.
#[derive(Clone, Debug, Default)]
pub struct Pattern {
    pairs: Vec<Pair>,
}

impl Pattern {
    /// Of a part that is drawn at `x_cp`, from its contour.
    pub fn new(canvas: &Canvas, contour: &[Step], x_cp: &Pose) -> Pattern {
        let x_pc = x_cp.inverse();
        let stride = contour.len().div_ceil(STEPS).max(1);
        let pair = |step: &Step| {
            let [nx, ny] = normal(canvas, step)?;
            let sides = [1.0, -1.0].map(|side| {
                let at = [step.at[0] + side * ASIDE * nx, step.at[1] + side * ASIDE * ny];
                (at, drawn(canvas, &step.ground, step.channel, at))
            });
            let z = 1.0 / f64::from(canvas.near[step.inside]);
            let [bright, dark] = sides.map(|(at, _)| {
                let [x, y] = canvas.lens.direction(at);
                x_pc * Point3::new(x * z, y * z, z)
            });
            let difference = sides[0].1? - sides[1].1?;
            (difference > LEAST).then_some(Pair { bright, dark, channel: step.channel, difference })
        };
        Pattern { pairs: contour.iter().step_by(stride).filter_map(pair).collect() }
    }

    /// The steps at `x_cp`, to be compared wherever the part is shifted along the two `axes` (optical frame)
    /// by up to some centimetres.
    pub fn at(&self, photograph: &Photograph, lens: &Lens, x_cp: &Pose, axes: [Vector3<f64>; 2]) -> Shifted {
        let place = |p: &Point3<f64>| {
            let p_c = x_cp * p;
            if p_c.z < 0.01 {
                return None;
            }
            let at = photograph.place(lens.project(&p_c));
            // The lens bends little over a few centimetres: a straight line.
            let along = axes.map(|axis| {
                let there = photograph.place(lens.project(&(p_c + axis * SHIFT)));
                [(there[0] - at[0]) / SHIFT, (there[1] - at[1]) / SHIFT]
            });
            Some(Line { at, along })
        };
        let both = |pair: &Pair| Some((place(&pair.bright)?, place(&pair.dark)?, *pair));
        Shifted { pairs: self.pairs.iter().filter_map(both).collect(), all: self.pairs.len() }
    }

    /// Number of steps.
    pub fn len(&self) -> usize {
        self.pairs.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }
}

/// A place in the image that moves with a part.
#[derive(Clone, Copy, Debug)]
struct Line {
    at: [f64; 2],
    /// By a shift along each of two axes, pixels per metre.
    along: [[f64; 2]; 2],
}

impl Line {
    fn shifted(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| self.at[axis] + u * self.along[0][axis] + v * self.along[1][axis])
    }
}

/// The steps of a part in one direction.
#[derive(Clone, Debug)]
pub struct Shifted {
    pairs: Vec<(Line, Line, Pair)>,
    all: usize,
}

impl Shifted {
    /// Mean share of the drawn contrasts that an image has where the part is shifted by `shift` (m along the
    /// two axes), 0 to 1; any smaller number where it is not above `least`.
    pub fn support(&self, photograph: &Photograph, shift: [f64; 2], least: f64) -> f64 {
        let share = |(bright, dark, pair): &(Line, Line, Pair)| {
            let light = |line: &Line| photograph.light(pair.channel, line.shifted(shift));
            let difference = light(bright)? - light(dark)?;
            Some((difference / pair.difference).clamp(0.0, 1.0))
        };
        let (here, all) = (self.pairs.len(), self.all.max(1) as f64);
        let mut sum = 0.0;
        for (some, left) in self.pairs.chunks(TOGETHER).zip((0..here).rev().step_by(TOGETHER)) {
            // Even if all others agree, it will not be enough.
            if sum + (left + 1) as f64 <= least * all {
                return 0.0;
            }
            sum += some.iter().filter_map(share).sum::<f64>();
        }
        sum / all
    }
}
