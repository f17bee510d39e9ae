//! Where and how a hand grips: beams by the slots of a link, pegs by the sides of the head.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::{Beam, Link, joint};

use crate::Pose;
use crate::parameters::hand::GripParameters;

/// Height of the tip over a beam's axis when the fingertips' ribs are in its slots, m.
pub const BEAM_HEIGHT: f64 = 17.0e-3;
/// Height of the tip over the underside of a peg's head when the blocks hold the head, m.
pub const PEG_HEIGHT: f64 = 20.0e-3;
/// Distance between the fingers when they hold an extrusion, m.
pub const BEAM_WIDTH: f64 = 22.0e-3;
/// Distance between the fingers when they hold a peg's head, m.
pub const PEG_WIDTH: f64 = 49.0e-3;

/// How a beam is gripped: distance of the tip from its j1 hole, m, and whether the hand is turned by 180°.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamGrasp {
    /// m.
    pub s: f64,
    /// By 180° from the beam's own x.
    pub reverse: bool,
}

/// The rotation of a hand that points down with its x axis at `yaw` (rad) in the world; it closes across x.
pub fn hand_down(yaw: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw)
        * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
}

/// The direction of a beam's +x in the world, as an angle about the vertical, rad.
pub fn yaw_of(x_wb: &Pose) -> f64 {
    let x = x_wb.rotation * Vector3::x();
    x.y.atan2(x.x)
}

/// The stretch of a link on which the hand may grip, in metres from the j1 hole.
pub fn span(link: &Link, grip: &GripParameters) -> [f64; 2] {
    [link.grasp[0] + grip.finger_room, link.grasp[1] - grip.finger_room]
}

/// The point of a link's stretch that is nearest to `wanted`, both in metres from the j1 hole.
pub fn point_on(link: &Link, wanted: f64, grip: &GripParameters) -> f64 {
    let [from, to] = span(link, grip);
    if from > to { (from + to) / 2.0 } else { wanted.clamp(from, to) }
}

/// Points of a link's stretch, the nearest to `wanted` first, then one for each step along it; all in metres from the j1 hole.
pub fn points_on(link: &Link, wanted: f64, grip: &GripParameters) -> Vec<f64> {
    let nearest = point_on(link, wanted, grip);
    let [from, to] = span(link, grip);
    let steps = ((to - from) / grip.step).max(0.0) as usize;
    let mut points: Vec<f64> = (0..=steps).map(|step| from + step as f64 * grip.step).collect();
    points.sort_by(|a, b| (a - nearest).abs().total_cmp(&(b - nearest).abs()));
    points.insert(0, nearest);
    points
}

/// The pose of the tip that grips the beam at `x_wb` (world) at `s` metres from its j1 hole; `reverse` turns the
/// hand by 180°.
pub fn beam_grasp(x_wb: &Pose, s: f64, reverse: bool) -> Pose {
    let p = x_wb * Point3::new(s, 0.0, 0.0);
    let yaw = yaw_of(x_wb) + if reverse { std::f64::consts::PI } else { 0.0 };
    Pose::from_parts(Translation3::new(p.x, p.y, p.z + BEAM_HEIGHT), hand_down(yaw))
}

/// The pose of the tip that grips the peg at `x_wp` (world) across two sides of its head; `quarter` turns the
/// hand by that many right angles from the peg's own x.
pub fn peg_grasp(x_wp: &Pose, quarter: i32) -> Pose {
    let x = x_wp.rotation * Vector3::x();
    let yaw = x.y.atan2(x.x) + f64::from(quarter) * std::f64::consts::FRAC_PI_2;
    let p = x_wp.translation.vector;
    Pose::from_parts(Translation3::new(p.x, p.y, p.z + PEG_HEIGHT), hand_down(yaw))
}

/// A beam's centre of mass in its frame, m: within 0.05 mm of the middle for every beam of the kit.
pub fn beam_centre(beam: &Beam) -> Point3<f64> {
    Point3::new(beam.span() / 2.0, 0.0, 0.0)
}

/// A peg's centre of mass in its frame, m (head and stem as solids).
pub fn peg_centre() -> Point3<f64> {
    let head = joint::HEAD_WIDTH * joint::HEAD_WIDTH * joint::HEAD_HEIGHT;
    let stem = std::f64::consts::PI * joint::STEM_RADIUS * joint::STEM_RADIUS * joint::STEM_LENGTH;
    let z = (head * joint::HEAD_HEIGHT - stem * joint::STEM_LENGTH) / (2.0 * (head + stem));
    Point3::new(0.0, 0.0, z)
}

/// Mass of a peg, kg: printed solid in PLA, its edges rounded.
pub const PEG_MASS: f64 = 26.9e-3;
