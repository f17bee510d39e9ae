//! Grasps: beams by the slots of a link, pegs by the sides of the head.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::{Beam, Link, joint};

use crate::Pose;
use crate::parameters::hand::GripParameters;
use crate::parameters::motion::TravelParameters;
use crate::way::Way;

/// Height of the tip over a beam's axis when the fingertips' ribs are in its slots, m.
pub const BEAM_HEIGHT: f64 = 17.0e-3;
/// Height of the tip over the underside of a peg's head when the blocks hold the head, m.
pub const PEG_HEIGHT: f64 = 20.0e-3;
/// Distance between the fingers when they hold an extrusion, m.
pub const BEAM_WIDTH: f64 = 22.0e-3;
/// Distance between the fingers when their ribs stand on the sides of an extrusion, beside its slots, m.
pub const RIBS_BESIDE: f64 = 30.0e-3;
/// Distance between the fingers when the blocks over their ribs stand on the sides of an extrusion, m: the
/// hand is too low.
pub const BLOCKS_BESIDE: f64 = 40.0e-3;
/// Distance between the fingers when they hold a peg's head, m.
pub const PEG_WIDTH: f64 = 49.0e-3;

/// Least angle between a beam and one that is level with which the hand leans as well: a beam that lies on
/// another one, or on a holder. With less, the ribs of an upright hand have room enough in its slots. rad.
const LEANS: f64 = 0.06;
/// The largest: one that leans by more lies on its side, or stands on its end. rad.
const TOO_FAR: f64 = 0.6;

/// Grasp of a beam: distance of the tip from its j1 hole, m, and a flag for a hand rotated by 180°.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamGrasp {
    /// m.
    pub s: f64,
    /// By 180° from the beam's own x.
    pub reverse: bool,
}

/// A grasp of a part: the tip's pose and the gripper before and after it closes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grasp {
    /// The pose of the tip, in the world.
    pub x_wt: Pose,
    /// Distance of the fingers before they close, m.
    pub open: f64,
    /// Distance of the fingers that hold the part, m.
    pub width: f64,
    /// The grasp in terms of the beam; `None` for a peg.
    pub beam: Option<BeamGrasp>,
}

impl Grasp {
    /// A grasp of the beam at `x_wb` (world).
    pub fn of_beam(x_wb: &Pose, grasp: BeamGrasp, grip: &GripParameters) -> Grasp {
        let x_wt = beam_grasp(x_wb, grasp.s, grasp.reverse);
        Grasp { x_wt, open: grip.beam_open, width: BEAM_WIDTH, beam: Some(grasp) }
    }
}

/// The grasps of a link of the beam at `x_wb` (world): for each point of the link, the one nearest to the
/// middle of the beam first, both senses of the hand, the better one first. The hand turns with the beam, so
/// its way leads by `goal` (world) as well; `way` measures a way of the tip.
pub fn beam_grasps(
    beam: &Beam,
    link: &Link,
    x_wb: &Pose,
    goal: Option<&Pose>,
    grip: &GripParameters,
    travel: &TravelParameters,
    way: impl Fn(&[Pose]) -> Way,
) -> Vec<[(Grasp, Way); 2]> {
    let points = points_on(link, beam.span() / 2.0, grip).into_iter();
    points.map(|s| senses(s, x_wb, goal, grip, travel, &way)).collect()
}

/// The two grasps of the beam at `x_wb` (world) at `s` metres from its j1 hole, the better one first: see
/// [`beam_grasps`].
pub fn senses(
    s: f64,
    x_wb: &Pose,
    goal: Option<&Pose>,
    grip: &GripParameters,
    travel: &TravelParameters,
    way: impl Fn(&[Pose]) -> Way,
) -> [(Grasp, Way); 2] {
    let mut senses = [false, true].map(|reverse| {
        let stops = [Some(x_wb), goal].into_iter().flatten();
        let stops: Vec<Pose> = stops.map(|x_wb| beam_grasp(x_wb, s, reverse)).collect();
        (Grasp::of_beam(x_wb, BeamGrasp { s, reverse }, grip), way(&stops))
    });
    senses.sort_by(|(_, a), (_, b)| b.compare(a, travel));
    senses
}

/// The grasps of the peg at `x_wp` (world) in its holder. Pegs stand close together along x: the hand closes
/// across it.
pub fn peg_grasps(x_wp: &Pose, grip: &GripParameters) -> [Grasp; 2] {
    [0, 2].map(|quarter| {
        let x_wt = peg_grasp(x_wp, quarter);
        Grasp { x_wt, open: grip.peg_open, width: PEG_WIDTH, beam: None }
    })
}

/// The rotations in which a hand can bring a peg over its hole, with its x axis at `yaw` (rad) now, the
/// nearest first: any turn of the square head fits.
pub fn peg_rotations(yaw: f64) -> [UnitQuaternion<f64>; 12] {
    [0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 4.0, -4.0, 5.0, -5.0, 6.0]
        .map(|step| hand_down(yaw + step * std::f64::consts::TAU / 12.0))
}

/// The poses of the tip (world) with a peg over the mouth of a hole at `p_wm`, and with the peg seated in it.
/// The peg's tip is the sum of `heights` (m) over the mouth.
pub fn peg_over_hole(p_wm: &Vector3<f64>, heights: [f64; 2], rotation: UnitQuaternion<f64>) -> [Pose; 2] {
    let over = p_wm.z + heights[0] + heights[1] + joint::STEM_LENGTH + PEG_HEIGHT;
    [over, p_wm.z + PEG_HEIGHT].map(|z| Pose::from_parts(Translation3::new(p_wm.x, p_wm.y, z), rotation))
}

/// The rotation of a hand that points down with its x axis at `yaw` (rad) in the world; it closes across x.
pub fn hand_down(yaw: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw)
        * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
}

/// The direction of a frame's +x (a beam's, a peg's, the tip's) in the world, as an angle about the vertical,
/// rad.
pub fn yaw_of(x_wf: &Pose) -> f64 {
    let x = x_wf.rotation * Vector3::x();
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

/// Points of a link's stretch, the nearest to `wanted` first, then one for each step along it; all in metres
/// from the j1 hole.
pub fn points_on(link: &Link, wanted: f64, grip: &GripParameters) -> Vec<f64> {
    let nearest = point_on(link, wanted, grip);
    let [from, to] = span(link, grip);
    let steps = ((to - from) / grip.step).max(0.0) as usize;
    let mut points: Vec<f64> = (0..=steps).map(|step| from + step as f64 * grip.step).collect();
    points.sort_by(|a, b| (a - nearest).abs().total_cmp(&(b - nearest).abs()));
    points.insert(0, nearest);
    points
}

/// The pose of the tip that grips the beam at `x_wb` (world) at `s` metres from its j1 hole; `reverse` turns
/// the hand by 180°. The hand leans with a beam that leans.
pub fn beam_grasp(x_wb: &Pose, s: f64, reverse: bool) -> Pose {
    let p = x_wb * Point3::new(s, 0.0, 0.0);
    let yaw = yaw_of(x_wb) + if reverse { std::f64::consts::PI } else { 0.0 };
    let lean = lean_of_beam(x_wb).unwrap_or_else(UnitQuaternion::identity);
    Pose::from_parts((p.coords + lean * Vector3::z() * BEAM_HEIGHT).into(), lean * hand_down(yaw))
}

/// The rotation in the world by which a beam at `x_wb` leans against a level one with the same direction and
/// the same side up; `None` for one that is about level, lies on its side, or stands on its end.
pub fn lean_of_beam(x_wb: &Pose) -> Option<UnitQuaternion<f64>> {
    let up = (x_wb.rotation * Vector3::z()).z;
    let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw_of(x_wb));
    let side = if up < 0.0 { std::f64::consts::PI } else { 0.0 };
    let level = yaw * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), side);
    let lean = x_wb.rotation * level.inverse();
    (LEANS..TOO_FAR).contains(&lean.angle()).then_some(lean)
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
