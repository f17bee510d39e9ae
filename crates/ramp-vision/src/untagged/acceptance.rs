//! Which fitted poses are believed, and how sure they are.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Matrix6, Point3, Vector3, Vector6};
use ramp_robot::Pose;

use super::depths::Depths;
use super::marks::Mark;
use super::pose::{Fitted, Place};
use super::scene::{Believed, Found};
use super::solids::Surface;

/// Least share of the drawn steps that must support a pose.
pub const LEAST_SHARE: f64 = 0.65;
/// Least number of steps that must support a pose.
pub const LEAST_STEPS: usize = 20;
/// Largest share of them that may look like printed lines.
const MOST_LINES: f64 = 0.4;
/// Least number and share of the steps across a beam's axis that tell where it is along itself, and what is
/// added to its place along itself otherwise, m.
const ALONG: (usize, f64) = (8, 0.5);
const ALONG_OPEN: f64 = 2.0e-3;
/// Two small parts whose middles are nearer than this are in one place, and two long ones whose axes are, m.
const ONE_PLACE: f64 = 10.0e-3;
const ONE_AXIS: f64 = 12.0e-3;
/// Shorter parts are small, as pegs are, m.
pub const SMALL: f64 = 0.1;
/// Least cosine of the angle between axes in one place.
const PARALLEL: f64 = 0.97;
/// Error of the faces of a part (1 σ), m: all that is seen of it may be off by this against its drawing. So
/// its place is, its turn by this over its extent, and its distance as a size that is off by it makes it.
const FACES: f64 = 0.07e-3;
/// Number of points of a found part that are handed on for calibrating a camera.
const POINTS: usize = 12;

/// One part in work.
#[derive(Debug)]
pub struct Work {
    /// Its pose in the world by now.
    pub x_wp: Pose,
    /// The steps of its drawing that can be measured; `None` if it is to be drawn (again).
    pub marks: Option<Vec<Mark>>,
    /// The depths measured of it, in its frame.
    pub depths: Depths,
    /// The last fit.
    pub fitted: Option<Fitted>,
    /// Number of its steps.
    pub steps: usize,
    /// Number of those that tell whether it is there: a shadow may hide the others.
    pub candidates: usize,
    /// Steps that were found in the image.
    pub places: Vec<Place>,
    /// How far the last fit moved its steps, pixels.
    pub moved: f64,
    /// Whether nothing is left to be gained by measuring it again.
    pub done: bool,
    /// Those across the axis: all, and those that support the pose.
    pub across: [usize; 2],
    /// Whether depth shows that it is not there.
    pub absent: bool,
}

impl Work {
    /// The start of the work on a part that is believed to be at `x_wp`.
    pub fn at(x_wp: Pose) -> Work {
        Work {
            x_wp,
            marks: None,
            depths: Depths::default(),
            fitted: None,
            steps: 0,
            candidates: 0,
            places: Vec::new(),
            moved: 0.0,
            done: false,
            across: [0; 2],
            absent: false,
        }
    }
}

/// The pose of a part in the world, if the image supports it well enough.
pub fn accept(x_wc: &Pose, part: &Believed, work: &Work) -> Option<Found> {
    let fitted = work.fitted.as_ref().filter(|_| !work.absent)?;
    let share_of = |all: usize| fitted.agreeing as f64 / all.max(1) as f64;
    if fitted.agreeing < LEAST_STEPS || share_of(work.candidates) < LEAST_SHARE {
        return None;
    }
    // The printed outline of a part is not the part.
    let lines = work.places.iter().filter(|place| place.is_line).count();
    if lines as f64 > MOST_LINES * work.places.len() as f64 {
        return None;
    }
    let of_image = fitted.information.try_inverse()? + model_error(work, fitted);
    let covariance = (of_image.try_inverse()? + fitted.known).try_inverse()?;
    let turn = x_wc.rotation.to_rotation_matrix();
    let mut axes = Matrix6::zeros();
    axes.fixed_view_mut::<3, 3>(0, 0).copy_from(turn.matrix());
    axes.fixed_view_mut::<3, 3>(3, 3).copy_from(turn.matrix());
    let mut covariance = axes * covariance * axes.transpose();
    let [all, good] = work.across;
    if all < ALONG.0 || (good as f64) < ALONG.1 * all as f64 {
        let along = work.x_wp.rotation * Vector3::x();
        let row = Vector6::new(along.x, along.y, along.z, 0.0, 0.0, 0.0);
        covariance += row * row.transpose() * ALONG_OPEN.powi(2);
    }
    let stride = (work.places.len() / POINTS).max(1);
    Some(Found {
        part: part.part.clone(),
        x_wp: work.x_wp,
        covariance,
        points: work.places.iter().step_by(stride).map(|place| place.p_p).collect(),
        share: share_of(work.steps),
        agreeing: fitted.agreeing,
        pixels: fitted.pixels,
    })
}

/// Whether two parts, each by the ends of its axis, would be in one place: two small ones side by side, or
/// two long ones along one another for more than half of the shorter.
pub fn is_one_place(a: [Point3<f64>; 2], b: [Point3<f64>; 2]) -> bool {
    let [along, other] = [a, b].map(|[from, to]| to - from);
    let middles = nalgebra::center(&a[0], &a[1]) - nalgebra::center(&b[0], &b[1]);
    match (along.norm() < SMALL, other.norm() < SMALL) {
        (true, true) => middles.norm() < ONE_PLACE,
        (false, false) => {
            let axis = along.normalize();
            let share = b.map(|end| (end - a[0]).dot(&axis));
            let beside = b.map(|end| ((end - a[0]) - axis * (end - a[0]).dot(&axis)).norm());
            let common = share[0].max(share[1]).min(along.norm()) - share[0].min(share[1]).max(0.0);
            axis.dot(&other.normalize()).abs() > PARALLEL
                && beside.iter().all(|off| *off < ONE_AXIS)
                && common > 0.5 * along.norm().min(other.norm())
        }
        _ => false,
    }
}

/// Of parts that were found in one place, only the one that moved least from where it was believed is
/// there: another was taken for its neighbour.
pub fn apart(found: Vec<Found>, parts: &[Believed], surfaces: &BTreeMap<String, Surface>) -> Vec<Found> {
    let ends = |part: &str, x: &Pose| {
        let ([x_m, y, z], radius) = surfaces.get(part).map_or(([0.0; 3], 0.0), |surface| surface.ball);
        [x_m - radius, x_m + radius].map(|x_m| x * Point3::new(f64::from(x_m), f64::from(y), f64::from(z)))
    };
    let middle = |part: &str, x: &Pose| {
        let [from, to] = ends(part, x);
        nalgebra::center(&from, &to)
    };
    let moved: Vec<f64> = found
        .iter()
        .map(|part| {
            let believed = parts.iter().find(|it| it.part == part.part);
            let before = believed.map_or(part.x_wp, |it| it.x_wp);
            (middle(&part.part, &part.x_wp) - middle(&part.part, &before)).norm()
        })
        .collect();
    let is_alone = |index: usize| {
        let own = ends(&found[index].part, &found[index].x_wp);
        (0..found.len()).all(|other| {
            let it = &found[other];
            other == index || moved[other] > moved[index] || !is_one_place(own, ends(&it.part, &it.x_wp))
        })
    };
    let alone: Vec<bool> = (0..found.len()).map(is_alone).collect();
    found.into_iter().zip(alone).filter(|(_, alone)| *alone).map(|(part, _)| part).collect()
}

/// Covariance (axes of the optical frame) of what a part leaves that is not made quite as it is drawn.
fn model_error(work: &Work, fitted: &Fitted) -> Matrix6<f64> {
    let places: Vec<Point3<f64>> = work.places.iter().map(|place| fitted.x_cp * place.p_p).collect();
    let count = places.len().max(1) as f64;
    let middle = places.iter().map(|p| p.coords).sum::<Vector3<f64>>() / count;
    // Extent across the line of sight: twice the standard deviation, along the shorter side.
    let sight = middle.normalize();
    let mut spread = Matrix3::zeros();
    for p in &places {
        let off = p.coords - middle;
        let off = off - sight * sight.dot(&off);
        spread += off * off.transpose() / count;
    }
    let mut values: Vec<f64> = spread.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    let [short, long] = [values[1], values[2]].map(|value| 2.0 * value.max(0.0).sqrt().max(1.0e-3));
    // Of shift at the middle of what shows, and turn.
    let along = sight * (FACES * middle.norm() / long);
    let turn = FACES / short;
    let mut covariance = Matrix6::zeros();
    let shift = Matrix3::identity() * FACES.powi(2) + along * along.transpose();
    covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&shift);
    covariance.fixed_view_mut::<3, 3>(3, 3).copy_from(&(Matrix3::identity() * turn * turn));
    // At the part's origin.
    let lever = fitted.x_cp.translation.vector - middle;
    let mut slope = Matrix6::identity();
    slope.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-lever.cross_matrix()));
    slope * covariance * slope.transpose()
}
