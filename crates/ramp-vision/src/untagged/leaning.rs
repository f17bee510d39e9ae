//! Beams that lean on something, with one end on the table.
//!
//! Two black areas that the drawing does not explain may be the joints at the ends of such a beam. From above
//! they hardly tell how high its upper end is. So it is tried at some heights, with each of its sides up, and
//! the pose that the image supports best is the beam's. Its ends hardly differ: they are taken as they were.

use nalgebra::{Matrix6, Point3, Translation3, UnitQuaternion, Vector3, Vector6};
use ramp_robot::Pose;

use super::anywhere::{OFF, Strewn, black_areas, joints};
use super::canvas::Canvas;
use super::look::Look;
use super::lost::on_height;
use super::scene::{Believed, Found, Scene};

/// Heights of the upper end above the lower one that are tried: the step and the largest, m.
const HEIGHTS: (f64, f64) = (18.0e-3, 0.126);
/// Standard deviations of a start: along the world's axes, m, and of its rotation, degrees.
const START: (f64, f64) = (2.5e-3, 1.5);
/// Number of black areas that are looked at, the largest first.
const AREAS: usize = 6;
/// Share of the drawn steps that support a pose from which on no other one is tried.
const SURELY: f64 = 0.85;

/// A beam that leans on something, if the image shows it; `beam` tells how it lies flat, and `was` its pose
/// in the world before it was lost.
pub fn beam(look: &Look, canvas: &mut Canvas, beam: &Strewn, was: &Pose) -> Option<Found> {
    let joints = joints(look.bodies.surfaces.get(&beam.part)?);
    let ends = [*joints.first()?, *joints.last()?];
    let mut areas = black_areas(look, canvas);
    areas.sort_by_key(|area| std::cmp::Reverse(area.cells.len()));
    areas.truncate(AREAS);
    let mut best: Option<Found> = None;
    for below in &areas {
        let low = on_height(look, canvas, below.middle, beam.flat.translation.z);
        for above in areas.iter().filter(|area| area.middle != below.middle) {
            let count = (HEIGHTS.1 / HEIGHTS.0) as usize;
            for height in (1..=count).map(|step| step as f64 * HEIGHTS.0) {
                let high = on_height(look, canvas, above.middle, beam.flat.translation.z + height);
                if ((high - low).norm() - (ends[1] - ends[0]).abs()).abs() > 2.0 * OFF {
                    continue;
                }
                let back = (high - low).dot(&(was.rotation * Vector3::x())) < 0.0;
                for x_wb in poses(beam, ends, if back { [high, low] } else { [low, high] }) {
                    let found = fit(look, canvas, beam, &x_wb);
                    let better = |it: &Found| best.as_ref().is_none_or(|best| it.share > best.share);
                    best = found.filter(better).or(best);
                    if best.as_ref().is_some_and(|best| best.share > SURELY) {
                        return best;
                    }
                }
            }
        }
    }
    best
}

/// The poses of a beam whose joints at its ends (`along` its axis, m) are about at two points of the world,
/// with each side up.
fn poses(beam: &Strewn, along: [f64; 2], [from, to]: [Point3<f64>; 2]) -> Vec<Pose> {
    let direction = (to - from).normalize();
    let x = beam.flat.rotation * Vector3::x();
    let yaw = direction.y.atan2(direction.x) - x.y.atan2(x.x);
    let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw) * beam.flat.rotation;
    let Some(lean) = UnitQuaternion::rotation_between(&(turned * Vector3::x()), &direction) else {
        return Vec::new();
    };
    let origin = nalgebra::center(&from, &to).coords - direction * ((along[0] + along[1]) / 2.0);
    let side = |quarter: i32| {
        let angle = f64::from(quarter) * std::f64::consts::FRAC_PI_2;
        let roll = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
        Pose::from_parts(Translation3::from(origin), lean * turned * roll)
    };
    (0..4).map(side).collect()
}

/// Fits a beam that is known to be near a pose.
fn fit(look: &Look, canvas: &mut Canvas, beam: &Strewn, x_wb: &Pose) -> Option<Found> {
    let (shift, turn) = (START.0, START.1.to_radians());
    let sigma = Vector6::new(shift, shift, shift, turn, turn, turn);
    let start = Believed {
        part: beam.part.clone(),
        x_wp: *x_wb,
        covariance: Matrix6::from_diagonal(&sigma.map(|sigma| sigma * sigma)),
        lying: None,
        held: false,
    };
    let others = look.scene.parts.iter().filter(|it| it.part != beam.part).cloned();
    let parts: Vec<Believed> = others.chain([start]).collect();
    let scene = Scene { parts: &parts, ..*look.scene };
    look.of(&scene).all(canvas, &|it| it.part == beam.part).found.into_iter().next()
}
