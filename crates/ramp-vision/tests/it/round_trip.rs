//! From parts to a picture and back: perception must find the parts that were drawn.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::Pose;
use ramp_render::Sensor;
use ramp_robot::camera::Mount;
use ramp_robot::random::Stream;
use ramp_robot::{Camera, CameraModel, Image};
use ramp_testing::table::{TIP, Table, tip_above};
use ramp_vision::{Calibration, Lying, Oddity, PartFinder, SightError};

fn wrist() -> CameraModel {
    CameraModel::nominal(Camera::Wrist, TIP)
}

/// The parts visible from 0.2 m above the sheet.
fn look(table: &Table, x_wt: Pose, seed: u64) -> Image {
    let mut renderer = table.renderer(&wrist());
    table.look(&mut renderer, &mut Sensor::new(seed, "wrist"), Camera::Wrist, x_wt)
}

#[test]
fn parts_are_found_where_they_are_drawn() {
    let table = Table::new();
    let mut finder = PartFinder::new(&table.kit).unwrap();
    let lying = Lying::at_start(&table.kit);
    let mut stream = Stream::new(3, "views");
    let (mut count, mut squares) = (0, 0.0);
    for view in 0..8 {
        let eye = [0.15 + 0.4 * stream.uniform(), 0.25 + 0.25 * stream.uniform(), 0.23];
        let tilt = [stream.symmetric(0.2), stream.symmetric(0.2)];
        let x_wt = tip_above(&wrist(), eye, stream.symmetric(1.5), tilt);
        let sighting = finder.find(&look(&table, x_wt, view), &wrist(), &lying).unwrap();
        for part in &sighting.parts {
            let truth = table.truth(&part.part);
            // Error at its tags: a beam's origin may be half a metre outside the image.
            let tag = finder.places()[&part.tags[0]].x_pg.translation.vector;
            let error = part.x_wp * Point3::from(tag) - truth * Point3::from(tag);
            let turn = part.x_wp.rotation.angle_to(&truth.rotation).to_degrees();
            assert!(error.norm() < 0.4e-3, "{} {:.3} mm", part.part, error.norm() * 1e3);
            assert!(turn < 0.6, "{} {turn:.3} degrees", part.part);
            let shift = part.x_wp.translation.vector - truth.translation.vector;
            let turn = (part.x_wp.rotation * truth.rotation.inverse()).scaled_axis();
            let both = nalgebra::Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z);
            squares += (both.transpose() * part.covariance.try_inverse().unwrap() * both)[0];
            count += 1;
        }
    }
    assert!(count > 30, "{count}");
    // Six numbers each: the covariance must be neither boastful nor useless.
    let ratio = squares / f64::from(6 * count);
    assert!((0.05..1.5).contains(&ratio), "{ratio}");
}

#[test]
fn the_birds_eye_finds_everything_on_the_sheet() {
    let table = Table::new();
    let model = CameraModel::nominal(Camera::BirdsEye, TIP);
    let mut renderer = table.renderer(&model);
    let image = table.look(&mut renderer, &mut Sensor::new(1, "eye"), Camera::BirdsEye, Pose::identity());
    let mut finder = PartFinder::new(&table.kit).unwrap();
    let sighting = finder.find(&image, &model, &Lying::at_start(&table.kit)).unwrap();
    assert_eq!(sighting.parts.len(), table.parts.len(), "{:?}", sighting.oddities);
    for part in &sighting.parts {
        let shift = part.x_wp.translation.vector - table.truth(&part.part).translation.vector;
        assert!(shift.norm() < 3e-3, "{} {:.2} mm", part.part, shift.norm() * 1e3);
    }
}

#[test]
fn the_same_bits_for_the_same_seed() {
    let table = Table::new();
    let x_wt = tip_above(&wrist(), [0.3, 0.3, 0.25], 0.1, [0.0, 0.1]);
    assert_eq!(look(&table, x_wt, 5), look(&table, x_wt, 5));
    assert_ne!(look(&table, x_wt, 5).pixels, look(&table, x_wt, 6).pixels);
}

#[test]
fn black_white_and_cut_images_are_refused() {
    let table = Table::new();
    let mut finder = PartFinder::new(&table.kit).unwrap();
    let x_wt = tip_above(&wrist(), [0.3, 0.3, 0.25], 0.0, [0.0; 2]);
    let mut renderer = table.renderer(&wrist());
    let mut shot = |gain: f64| {
        let mut sensor = Sensor::new(1, "wrist").with_gain(gain);
        let image = table.look(&mut renderer, &mut sensor, Camera::Wrist, x_wt);
        finder.find(&image, &wrist(), &[])
    };
    assert!(matches!(shot(0.0), Err(SightError::Black { .. })));
    assert!(matches!(shot(30.0), Err(SightError::Saturated { .. })));
    assert!(!shot(1.0).unwrap().parts.is_empty());
    let mut cut = look(&table, x_wt, 1);
    cut.pixels.truncate(1000);
    assert!(matches!(finder.find(&cut, &wrist(), &[]), Err(SightError::Size { .. })));
}

#[test]
fn a_tag_that_is_there_twice_leads_to_no_pose() {
    let mut table = Table::new();
    // A second p1 beside the first.
    let index = table.parts.iter().position(|(name, _)| name == "p1").unwrap();
    let x_wp = table.parts[index].1;
    table.parts.push(("p1".into(), Translation3::new(0.0, -0.05, 0.0) * x_wp));
    let at = x_wp.translation.vector;
    let image = look(&table, tip_above(&wrist(), [at.x, at.y, 0.26], 0.0, [0.0; 2]), 1);
    let sighting = PartFinder::new(&table.kit).unwrap().find(&image, &wrist(), &[]).unwrap();
    assert!(sighting.parts.iter().all(|part| part.part != "p1"));
    let twice =
        |oddity: &Oddity| matches!(oddity, Oddity::SameTagTwice { part, count: 2, .. } if part == "p1");
    assert!(sighting.oddities.iter().any(twice), "{:?}", sighting.oddities);
}

#[test]
fn stickers_that_were_swapped_are_told() {
    let table = Table::new();
    // Somebody stuck b4's second tag on b5 and the other way round.
    let mut kit = table.kit.clone();
    let beam = |kit: &ramp_kit::Kit, name: &str| kit.beams.iter().position(|beam| beam.name == name).unwrap();
    let (b4, b5) = (beam(&kit, "b4"), beam(&kit, "b5"));
    let (first, second) = (kit.beams[b4].joints[2].tag, kit.beams[b5].joints[2].tag);
    kit.beams[b4].joints[2].tag = second;
    kit.beams[b5].joints[2].tag = first;
    let x_wt = tip_above(&wrist(), [0.33, 0.22, 0.5], 0.0, [0.0; 2]);
    let image = look(&table, x_wt, 1);
    let sighting = PartFinder::new(&kit).unwrap().find(&image, &wrist(), &Lying::at_start(&kit)).unwrap();
    let reported =
        |oddity: &Oddity| matches!(oddity, Oddity::TagsDisagree { part, .. } if part == "b4" || part == "b5");
    assert!(sighting.oddities.iter().any(reported), "{:?}", sighting.oddities);
    assert!(sighting.parts.iter().all(|part| part.part != "b4" && part.part != "b5"));
}

#[test]
fn a_part_that_is_tilted_is_not_pressed_flat() {
    let mut table = Table::new();
    let index = table.parts.iter().position(|(name, _)| name == "b1").unwrap();
    let x_wb = table.parts[index].1;
    let tilt = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.2);
    table.parts[index].1 = Pose::from_parts(x_wb.translation, tilt * x_wb.rotation);
    let at = (x_wb * Point3::new(0.05, 0.0, 0.0)).coords;
    let image = look(&table, tip_above(&wrist(), [at.x, at.y, 0.25], 0.0, [0.0, 0.1]), 1);
    let mut finder = PartFinder::new(&table.kit).unwrap();
    let sighting = finder.find(&image, &wrist(), &Lying::at_start(&table.kit)).unwrap();
    assert!(sighting.parts.iter().all(|part| part.part != "b1"));
    assert!(
        sighting.oddities.iter().any(|oddity| matches!(oddity, Oddity::NotLying { part } if part == "b1"))
    );
    // Nothing said about it, it is found as it is.
    let sighting = finder.find(&image, &wrist(), &[]).unwrap();
    let found = sighting.parts.iter().find(|part| part.part == "b1").unwrap();
    assert!(found.x_wp.rotation.angle_to(&table.truth("b1").rotation).to_degrees() < 1.0);
}

#[test]
fn a_camera_that_is_not_where_it_should_be_is_found() {
    let table = Table::new();
    let mut finder = PartFinder::new(&table.kit).unwrap();
    let nominal = wrist();
    let error = Pose::from_parts(
        Translation3::new(0.5e-3, -0.8e-3, 0.3e-3),
        UnitQuaternion::from_scaled_axis(Vector3::new(0.004, -0.003, 0.005)),
    );
    let Mount::Tip(x_tc) = nominal.mount else { panic!() };
    let real = CameraModel { mount: Mount::Tip(x_tc * error), ..nominal.clone() };
    let mut renderer = table.renderer(&real);
    let mut sensor = Sensor::new(1, "wrist");
    let mut calibration = Calibration::new(&nominal, [0.5e-3, 0.0035]);
    let [x, y] = [0.577, 0.28];
    let views = [
        (0.0, [0.3, 0.0], 0.25),
        (1.5, [-0.3, 0.1], 0.25),
        (-1.5, [0.0, -0.3], 0.25),
        (0.7, [0.0, 0.3], 0.25),
        (0.0, [0.0, 0.0], 0.2),
    ];
    for (turn, tilt, height) in views {
        let x_wt = tip_above(&nominal, [x, y, height], turn, tilt);
        let pixels = renderer.render(&table.scene(), &real.x_wc(&x_wt), &mut sensor);
        let image =
            Image { camera: Camera::Wrist, time: 0.0, x_wt, width: 1280, height: 800, pixels, depth: None };
        let sighting = finder.find(&image, &nominal, &[]).unwrap();
        calibration.add_part(&x_wt, &sighting.sheet.unwrap(), &Pose::identity(), finder.places());
    }
    let (found, covariance) = calibration.solve();
    let Mount::Tip(x_tc_found) = found.mount else { panic!() };
    let left = (x_tc * error).inverse() * x_tc_found;
    assert!(left.translation.vector.norm() < 0.3e-3, "{:.3} mm", left.translation.vector.norm() * 1e3);
    assert!(left.rotation.angle().to_degrees() < 0.06, "{:.3} degrees", left.rotation.angle().to_degrees());
    assert!(covariance[(0, 0)].sqrt() < 0.5e-3);
}
