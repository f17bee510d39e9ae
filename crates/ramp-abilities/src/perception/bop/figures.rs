//! Errors of poses as BOP and its forerunners count them, beside millimetres and degrees.

use nalgebra::Point3;
use ramp_robot::{CameraModel, Pose};

use super::objects::Object;

/// Share of an object's diameter within which its pose counts as right by the mean distance (ADD-S).
const RIGHT: f64 = 0.1;
/// Limits of the largest distance in the image (MSPD), pixels of an image 640 wide: BOP's 5 to 50.
const LIMITS: [f64; 10] = [5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0];

/// A pose and the truth.
pub struct Pair<'a> {
    /// The object.
    pub object: &'a Object,
    /// The camera.
    pub camera: &'a CameraModel,
    /// The given pose in the optical frame.
    pub found: Pose,
    /// The true one.
    pub truth: Pose,
}

impl Pair<'_> {
    /// The true pose and those that look the same.
    fn truths(&self) -> impl Iterator<Item = Pose> {
        let same = self.object.symmetries.iter().map(|symmetry| self.truth * symmetry);
        std::iter::once(self.truth).chain(same)
    }

    /// Mean distance of the points of the object from the nearest one of the true object, m (ADD-S).
    pub fn mean_distance(&self) -> f64 {
        let place = |x: &Pose| -> Vec<Point3<f64>> { self.object.points.iter().map(|p| x * p).collect() };
        let truth = place(&self.truth);
        let nearest = |p: &Point3<f64>| {
            truth
                .iter()
                .map(|other| nalgebra::distance_squared(p, other))
                .fold(f64::INFINITY, f64::min)
                .sqrt()
        };
        let all = place(&self.found);
        all.iter().map(nearest).sum::<f64>() / all.len().max(1) as f64
    }

    /// Largest distance in the image of a point from its true place, pixels; the least over all poses that
    /// look the same (MSPD).
    pub fn image_distance(&self) -> f64 {
        let pixel = |x: &Pose, p: &Point3<f64>| self.camera.project(&(x * p));
        let largest = |truth: Pose| {
            let off = |p: &Point3<f64>| match (pixel(&self.found, p), pixel(&truth, p)) {
                (Some(a), Some(b)) => (a[0] - b[0]).hypot(a[1] - b[1]),
                _ => f64::INFINITY,
            };
            self.object.points.iter().map(off).fold(0.0, f64::max)
        };
        self.truths().map(largest).fold(f64::INFINITY, f64::min)
    }

    /// Distance of the middles of both, m, and angle, rad; the least over all poses that look the same.
    pub fn shift_and_turn(&self) -> [f64; 2] {
        let middle = nalgebra::Vector3::from(
            self.object.points.iter().map(|p| p.coords).sum::<nalgebra::Vector3<f64>>()
                / self.object.points.len().max(1) as f64,
        );
        let middle = Point3::from(middle);
        let both = |truth: Pose| {
            [(self.found * middle - truth * middle).norm(), self.found.rotation.angle_to(&truth.rotation)]
        };
        self.truths().map(both).min_by(|a, b| a[1].total_cmp(&b[1])).unwrap_or([f64::INFINITY; 2])
    }
}

/// The poses of one object.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Parts to be found.
    pub parts: usize,
    /// Distances of the middles, m.
    shifts: Vec<f64>,
    /// Angles, rad.
    turns: Vec<f64>,
    /// Mean distances, m, and whether they are within the limit.
    means: Vec<(f64, bool)>,
    /// Largest distances in the image, pixels of an image 640 wide.
    pixels: Vec<f64>,
}

impl Tally {
    /// Takes the pose of a part that was to be found.
    pub fn add(&mut self, pair: &Pair) {
        let [shift, turn] = pair.shift_and_turn();
        self.shifts.push(shift);
        self.turns.push(turn);
        let mean = pair.mean_distance();
        self.means.push((mean, mean < RIGHT * pair.object.diameter));
        self.pixels.push(pair.image_distance() * 640.0 / pair.camera.width as f64);
    }

    /// Takes over those of another object.
    pub fn extend(&mut self, other: &Tally) {
        self.parts += other.parts;
        self.shifts.extend(&other.shifts);
        self.turns.extend(&other.turns);
        self.means.extend(&other.means);
        self.pixels.extend(&other.pixels);
    }

    /// Number of parts that were found.
    pub fn found(&self) -> usize {
        self.shifts.len()
    }

    /// Median and 95 % of the distances of the middles, m.
    pub fn shift(&self) -> [f64; 2] {
        quantiles(&self.shifts)
    }

    /// The same of the angles, rad.
    pub fn turn(&self) -> [f64; 2] {
        quantiles(&self.turns)
    }

    /// Share of all parts whose mean distance is below a tenth of the diameter (recall by ADD-S).
    pub fn recall_by_mean_distance(&self) -> f64 {
        self.means.iter().filter(|(_, right)| *right).count() as f64 / self.parts.max(1) as f64
    }

    /// Mean over BOP's ten limits of the share of all parts whose distance in the image is below (average
    /// recall by MSPD).
    pub fn recall_by_image_distance(&self) -> f64 {
        let right = |limit: &f64| self.pixels.iter().filter(|pixels| *pixels < limit).count() as f64;
        let sum: f64 = LIMITS.iter().map(right).sum();
        sum / (LIMITS.len() * self.parts.max(1)) as f64
    }
}

fn quantiles(values: &[f64]) -> [f64; 2] {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    [0.5, 0.95].map(|share| {
        let index = (sorted.len() as f64 * share) as usize;
        sorted.get(index.min(sorted.len().saturating_sub(1))).copied().unwrap_or(f64::NAN)
    })
}
