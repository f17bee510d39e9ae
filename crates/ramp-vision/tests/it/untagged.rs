//! Parts without tags: found in pictures from where they are believed to be.

use std::sync::Arc;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::Pose;
use ramp_render::{Looks, Sensor, StereoErrors, StereoSensor};
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;
use ramp_robot::{Camera, CameraModel, Image};
use ramp_testing::table::{TIP, Table, tip_above};
use ramp_vision::untagged::{Believed, Found, Scene, SceneFinder, Seen, Trace};
use ramp_vision::{Lying, SightError};

/// Distance between the fingers, m.
pub const WIDTH: f64 = 0.06;

pub struct Cell {
    pub table: Table,
    pub finder: SceneFinder,
    pub holders: Vec<(String, Pose)>,
    lying: Vec<Lying>,
    /// Whether images come with depth.
    depth: bool,
}

impl Cell {
    pub fn new() -> Cell {
        let mut table = Table::new();
        let arm = ArmModel::read(&ramp_testing::data().join("arms/panda.json")).unwrap();
        table.looks = Arc::new(Looks::new(&table.kit, Some(&arm)).unwrap().without_tags(&table.kit).unwrap());
        let finder = SceneFinder::new(&table.kit, &arm).unwrap();
        let kit = &table.kit;
        let holder = |holder: &ramp_kit::Holder| {
            let at = kit.sheet_to_world(holder.centre);
            (holder.name.clone(), Pose::translation(at.x, at.y, 0.0))
        };
        let holders = kit.holders.iter().map(holder).collect();
        let lying = Lying::at_start(kit);
        Cell { table, finder, holders, lying, depth: false }
    }

    /// An image with the open hand in it.
    pub fn look(&self, camera: Camera, x_wt: Pose, seed: u64) -> Image {
        let model = CameraModel::nominal(camera, TIP);
        let mut scene = self.table.scene();
        let x_wh = x_wt * Translation3::new(0.0, 0.0, -TIP);
        let over = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI);
        let mut add = |name: &str, x: Pose| scene.bodies.push((self.table.looks.body(name).unwrap(), x));
        add("hand", x_wh);
        add("finger1", x_wh * Translation3::new(0.0, WIDTH / 2.0, 0.0584));
        add("finger2", x_wh * Pose::from_parts(Translation3::new(0.0, -WIDTH / 2.0, 0.0584), over));
        let mut renderer = self.table.renderer(&model);
        let pixels = renderer.render(&scene, &model.x_wc(&x_wt), &mut Sensor::new(seed, camera.name()));
        let errors = StereoErrors { noise: 0.08, bias: 0.1, spread: 0.7, holes: 0.25 };
        let depth = self.depth.then(|| StereoSensor::new(seed, camera, errors).measure(&renderer));
        Image { camera, time: 0.0, x_wt, width: model.width, height: model.height, pixels, depth }
    }

    /// Finds all parts, each of which is believed to be up to `shift` (m, 1 σ) and `turn` (rad, 1 σ) off.
    fn find(&mut self, image: &Image, sigma: (f64, f64), seed: u64) -> Vec<Found> {
        self.see(image, sigma, seed).found
    }

    /// The same, with the parts that are not there.
    fn see(&mut self, image: &Image, (shift, turn): (f64, f64), seed: u64) -> Seen {
        let mut stream = Stream::new(seed, "belief");
        let sigma = [shift, shift, 0.5e-3, 0.004, 0.004, turn];
        let parts: Vec<Believed> = self
            .table
            .parts
            .iter()
            .map(|(part, x_wp)| {
                let [x, y, yaw] = [shift, shift, turn].map(|sigma| stream.symmetric(1.7 * sigma));
                let middle = self.table.kit.beam(part).map_or(0.0, |beam| beam.span() / 2.0);
                let lever = x_wp.rotation * Vector3::new(middle, 0.0, 0.0);
                let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
                let at = x_wp.translation.vector + lever - turn * lever + Vector3::new(x, y, 0.0);
                Believed {
                    part: part.clone(),
                    x_wp: Pose::from_parts(Translation3::from(at), turn * x_wp.rotation),
                    covariance: nalgebra::Matrix6::from_diagonal(
                        &nalgebra::Vector6::from(sigma).map(|s| s * s),
                    ),
                    lying: self.lying.iter().find(|lying| lying.part == *part).cloned(),
                    held: false,
                }
            })
            .collect();
        let scene = Scene { parts: &parts, holders: &self.holders, width: WIDTH };
        let model = CameraModel::nominal(image.camera, TIP);
        self.finder.find(image, &model, &scene, &|_| true, 0.0).unwrap()
    }

    /// Errors along the table (mm) at the middle of what shows, and of the turn about the vertical (degrees);
    /// and the squared error in units of the covariance.
    fn error(&self, found: &Found) -> [f64; 3] {
        let truth = self.table.truth(&found.part);
        let count = found.points.len() as f64;
        let middle = Point3::from(found.points.iter().map(|p| p.coords).sum::<Vector3<f64>>() / count);
        let shift = found.x_wp * middle - truth * middle;
        let turn = (found.x_wp.rotation * truth.rotation.inverse()).scaled_axis();
        let origin = found.x_wp.translation.vector - truth.translation.vector;
        let both = nalgebra::Vector6::new(origin.x, origin.y, origin.z, turn.x, turn.y, turn.z);
        let squared = (both.transpose() * found.covariance.try_inverse().unwrap() * both)[0];
        [shift.xy().norm() * 1.0e3, turn.z.abs().to_degrees(), squared]
    }
}

fn wrist() -> CameraModel {
    CameraModel::nominal(Camera::Wrist, TIP)
}

/// The value below which a share of the values is.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[((sorted.len() as f64 * share) as usize).min(sorted.len() - 1)]
}

#[test]
fn parts_are_found_from_near() {
    let mut cell = Cell::new();
    let mut stream = Stream::new(3, "views");
    let (mut shifts, mut turns, mut squares) = (Vec::new(), Vec::new(), Vec::new());
    for view in 0..8 {
        let eye = [0.15 + 0.4 * stream.uniform(), 0.25 + 0.25 * stream.uniform(), 0.23];
        let tilt = [stream.symmetric(0.2), stream.symmetric(0.2)];
        let x_wt = tip_above(&wrist(), eye, stream.symmetric(1.5), tilt);
        let image = cell.look(Camera::Wrist, x_wt, view);
        for found in cell.find(&image, (1.0e-3, 0.01), view) {
            let [shift, turn, squared] = cell.error(&found);
            shifts.push(shift);
            turns.push(turn);
            squares.push(squared);
        }
    }
    assert!(shifts.len() > 60, "{}", shifts.len());
    assert!(quantile(&shifts, 0.5) < 0.15, "{:.3} mm", quantile(&shifts, 0.5));
    assert!(quantile(&shifts, 0.9) < 0.8, "{:.3} mm", quantile(&shifts, 0.9));
    assert!(quantile(&turns, 0.5) < 0.1, "{:.3} degrees", quantile(&turns, 0.5));
    // Six numbers each: the covariance must be neither boastful nor useless.
    let usual = quantile(&squares, 0.5);
    assert!((1.0..12.0).contains(&usual), "{usual}");
}

/// From a few millimetres off, and from as far as a start may have moved parts.
#[test]
fn everything_on_the_sheet_is_found_from_above() {
    let mut cell = Cell::new();
    let image = cell.look(Camera::BirdsEye, Pose::translation(0.3, -0.3, 0.5), 1);
    for sigma in [(1.0e-3, 0.01), (3.0e-3, 0.05)] {
        let all = cell.find(&image, sigma, 5);
        assert!(all.len() + 1 >= cell.table.parts.len(), "{} parts", all.len());
        for found in &all {
            let [shift, turn, _] = cell.error(found);
            assert!(shift < 2.0, "{} {shift:.2} mm", found.part);
            assert!(turn < 0.5 || found.part.starts_with('p'), "{} {turn:.2} degrees", found.part);
        }
    }
}

/// A part that is not there is not found where it is believed to be, however well its neighbours are.
#[test]
fn a_part_that_is_gone_is_not_found() {
    let mut cell = Cell::new();
    let gone = ["b4", "p2", "p13"];
    let there = cell.table.parts.clone();
    cell.table.parts.retain(|(part, _)| !gone.contains(&part.as_str()));
    let at = there.iter().find(|(part, _)| part == "p2").unwrap().1.translation.vector;
    let near = tip_above(&wrist(), [at.x, at.y, 0.25], 0.0, [0.0; 2]);
    let views = [(Camera::BirdsEye, Pose::translation(0.3, -0.3, 0.5)), (Camera::Wrist, near)];
    for (camera, x_wt) in views {
        let image = cell.look(camera, x_wt, 2);
        let all = std::mem::replace(&mut cell.table.parts, there.clone());
        let found = cell.find(&image, (1.0e-3, 0.01), 2);
        cell.table.parts = all;
        assert!(found.iter().all(|part| !gone.contains(&part.part.as_str())), "{camera:?}");
        assert!(found.iter().any(|part| part.part == "p1"), "{camera:?}");
    }
}

#[test]
fn black_and_cut_images_are_refused() {
    let mut cell = Cell::new();
    let image = cell.look(Camera::Wrist, tip_above(&wrist(), [0.3, 0.3, 0.25], 0.0, [0.0; 2]), 1);
    let scene = Scene { parts: &[], holders: &[], width: WIDTH };
    let mut find =
        |image: &Image| cell.finder.find(image, &wrist(), &scene, &|_| true, 0.0).map(|it| it.found.len());
    assert!(matches!(find(&image), Ok(0)));
    let black = Image { pixels: vec![3; image.pixels.len()], ..image.clone() };
    assert!(matches!(find(&black), Err(SightError::Black { .. })));
    let mut cut = image;
    cut.pixels.truncate(1000);
    assert!(matches!(find(&cut), Err(SightError::Size { .. })));
}

/// A peg that was lost is found where it is: standing elsewhere, leaning, or lying on the table.
#[test]
fn a_lost_peg_is_found() {
    let mut cell = Cell::new();
    let index = cell.table.parts.iter().position(|(part, _)| part == "p1").unwrap();
    let place = Vector3::new(0.62, 0.28, 0.0);
    let lean = |degrees: f64, height: f64| {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), degrees.to_radians());
        let about = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.9);
        Pose::from_parts(Translation3::from(place + Vector3::new(0.0, 0.0, height)), about * turn)
    };
    for (degrees, height) in [(0.0, 0.036), (17.0, 0.04), (76.0, 0.02)] {
        cell.table.parts[index].1 = lean(degrees, height);
        let x_wt = tip_above(&wrist(), [0.6, 0.25, 0.25], 0.3, [0.1, 0.0]);
        let image = cell.look(Camera::Wrist, x_wt, 4);
        let parts: Vec<Believed> = cell
            .table
            .parts
            .iter()
            .map(|(part, x_wp)| {
                let lost = part == "p1";
                let sigma = if lost { [0.1, 0.1, 0.1, 1.0, 1.0, 1.0] } else { [0.5e-3; 6] };
                Believed {
                    part: part.clone(),
                    x_wp: if lost { Pose::translation(0.5, 0.3, 0.1) } else { *x_wp },
                    covariance: nalgebra::Matrix6::from_diagonal(
                        &nalgebra::Vector6::from(sigma).map(|s| s * s),
                    ),
                    lying: None,
                    held: false,
                }
            })
            .collect();
        let scene = Scene { parts: &parts, holders: &cell.holders, width: WIDTH };
        let lost = &parts[index];
        let Some(Trace::Pose(found)) = cell.finder.find_lost(&image, &wrist(), &scene, lost).unwrap() else {
            panic!("{degrees} degrees: no pose");
        };
        let truth = cell.table.truth("p1");
        let head = Point3::new(0.0, 0.0, 0.013);
        let off = (found.x_wp * head - truth * head).norm() * 1.0e3;
        let axis = (found.x_wp.rotation * Vector3::z()).angle(&(truth.rotation * Vector3::z())).to_degrees();
        assert!(off < 2.0 && axis < 6.0, "{degrees} degrees: {off:.2} mm, {axis:.2} degrees");
        // Without it, there is nothing to be found.
        cell.table.parts[index].1 = Pose::translation(-0.8, 0.0, 0.05);
        let image = cell.look(Camera::Wrist, x_wt, 4);
        assert!(cell.finder.find_lost(&image, &wrist(), &scene, lost).unwrap().is_none());
    }
}

/// Depth tells that a part has gone from where it is believed to be, and of none that it has gone where it
/// is.
#[test]
fn depth_tells_what_is_not_there() {
    let mut cell = Cell::new();
    cell.depth = true;
    for gone in ["b4", "p2"] {
        let there = cell.table.parts.clone();
        let at = there.iter().find(|(part, _)| part == gone).unwrap().1.translation.vector;
        let x_wt = tip_above(&wrist(), [at.x, at.y, 0.25], 0.0, [0.0; 2]);
        let image = cell.look(Camera::Wrist, x_wt, 2);
        assert_eq!(cell.see(&image, (1.0e-3, 0.01), 2).absent, Vec::<String>::new());
        cell.table.parts.retain(|(part, _)| part != gone);
        let image = cell.look(Camera::Wrist, x_wt, 2);
        cell.table.parts = there;
        let seen = cell.see(&image, (1.0e-3, 0.01), 2);
        assert_eq!(seen.absent, [gone]);
        assert!(seen.found.len() > 2 && seen.found.iter().all(|part| part.part != gone), "{gone}");
    }
}

/// A peg's height that is not known is measured, as well as the sensor can.
#[test]
fn depth_tells_heights() {
    let mut cell = Cell::new();
    let index = cell.table.parts.iter().position(|(part, _)| part == "p1").unwrap();
    let believed = cell.table.parts[index].1;
    let raised = Translation3::new(0.0, 0.0, 0.004) * believed;
    cell.lying.retain(|lying| lying.part != "p1");
    let at = believed.translation.vector;
    let (mut with, mut without) = (Vec::new(), Vec::new());
    for seed in 1..=6 {
        for (depth, errors) in [(true, &mut with), (false, &mut without)] {
            cell.depth = depth;
            cell.table.parts[index].1 = raised;
            let image =
                cell.look(Camera::Wrist, tip_above(&wrist(), [at.x, at.y, 0.25], 0.0, [0.0; 2]), seed);
            cell.table.parts[index].1 = believed;
            let parts: Vec<Believed> = [Believed {
                part: "p1".to_string(),
                x_wp: believed,
                covariance: nalgebra::Matrix6::from_diagonal(&nalgebra::Vector6::new(
                    1.0e-6, 1.0e-6, 2.5e-5, 4.0e-4, 4.0e-4, 4.0e-4,
                )),
                lying: None,
                held: false,
            }]
            .to_vec();
            let scene = Scene { parts: &parts, holders: &cell.holders, width: WIDTH };
            let seen = cell.finder.find(&image, &wrist(), &scene, &|_| true, 0.0).unwrap();
            let Some(found) = seen.found.first() else { continue };
            let off = found.x_wp.translation.z - raised.translation.z;
            let sigma = found.covariance[(2, 2)].sqrt();
            assert!(off.abs() < 4.0 * sigma, "{off} with {sigma}");
            errors.push(sigma * 1.0e3);
        }
    }
    assert!(with.len() >= 5 && without.len() >= 5, "{} {}", with.len(), without.len());
    assert!(quantile(&with, 0.5) < 0.8 * quantile(&without, 0.5), "{with:?} {without:?}");
}

/// The hand throws its shadow on the pegs below it, and their tops become as dark as their sides: they are
/// found all the same.
#[test]
fn pegs_in_the_shadow_of_the_hand_are_found() {
    let mut cell = Cell::new();
    let pegs = cell.table.parts.iter().filter(|(part, _)| part.starts_with('p'));
    let pegs: Vec<(String, Point3<f64>)> =
        pegs.map(|(part, x)| (part.clone(), Point3::from(x.translation.vector))).collect();
    let (mut shown, mut seen) = (0, 0);
    for (view, (_, at)) in (0u32..).zip(&pegs) {
        let x_wt = tip_above(&wrist(), [at.x, at.y, 0.21], 0.8 * f64::from(view) - 5.0, [0.0; 2]);
        let image = cell.look(Camera::Wrist, x_wt, u64::from(view));
        let found = cell.find(&image, (1.0e-3, 0.01), u64::from(view));
        let x_cw = wrist().x_wc(&x_wt).inverse();
        // Away from the border and from the fingers.
        let is_inside = |[x, y]: [f64; 2]| (150.0..1130.0).contains(&x) && (150.0..550.0).contains(&y);
        for (peg, _) in pegs.iter().filter(|(_, at)| wrist().project(&(x_cw * at)).is_some_and(is_inside)) {
            shown += 1;
            seen += usize::from(found.iter().any(|it| it.part == *peg && cell.error(it)[0] < 2.0));
        }
    }
    assert!(shown > 60 && seen * 20 >= shown * 19, "{seen} of {shown}");
}
