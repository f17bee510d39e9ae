//! Geometry of the images: each object is at the pixel that the camera model predicts.

use std::path::Path;
use std::sync::Arc;

use nalgebra::Point3;
use ramp_kit::{Pose, read_kit, tags};
use ramp_render::{Lens, Looks, Renderer, Scene, Sensor};
use ramp_robot::{Camera, CameraModel};

const TIP: f64 = 0.1134;

#[test]
fn directions_and_pixels_belong_together() {
    for camera in Camera::ALL {
        let model = CameraModel::nominal(camera, TIP);
        let lens = Lens::new(&model);
        for y in (0..model.height).step_by(37) {
            let [xs, ys] = lens.row(y);
            for x in (0..model.width).step_by(41) {
                let ray = [f64::from(xs[x]), f64::from(ys[x])];
                let exact = model.direction([x as f64 + 0.5, y as f64 + 0.5]);
                let error = (ray[0] - exact[0]).hypot(ray[1] - exact[1]) * model.focal[0];
                assert!(error < 0.01, "{camera:?} {x} {y}: {error} pixels");
                let [px, py] = lens.project([xs[x] * 0.3, ys[x] * 0.3, 0.3]);
                let error = (px - x as f32 - 0.5).hypot(py - y as f32 - 0.5);
                assert!(error < 0.02, "{camera:?} {x} {y}: {error} pixels");
            }
        }
    }
}

#[test]
fn the_sheet_s_tag_is_where_the_kit_has_it() {
    let kit = read_kit(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/kit.xml")).unwrap();
    let looks = Arc::new(Looks::new(&kit, None).unwrap());
    let model = CameraModel::nominal(Camera::BirdsEye, TIP);
    let mut renderer = Renderer::new(Arc::clone(&looks), &model);
    let x_wc = model.x_wc(&Pose::identity());
    let picture = renderer.render(&Scene::default(), &x_wc, &mut Sensor::ideal());
    let x_cg = x_wc.inverse() * tags::x_wg_sheet(&kit);
    let cell = kit.sheet.tag_edge / tags::BLACK_CELLS as f64;
    for (row, line) in tags::cells(tags::SHEET_ID).unwrap().iter().enumerate() {
        for (column, black) in line.iter().enumerate() {
            let at = Point3::new((column as f64 - 4.0) * cell, (4.0 - row as f64) * cell, 0.0);
            let [x, y] = model.project(&(x_cg * at)).unwrap();
            let green = picture[(y as usize * model.width + x as usize) * 3 + 1];
            assert_eq!(green < 128, *black, "row {row}, column {column}: {green}");
        }
    }
}

#[test]
fn what_is_in_front_hides_what_is_behind_and_is_labelled() {
    let kit = read_kit(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/kit.xml")).unwrap();
    let looks = Arc::new(Looks::new(&kit, None).unwrap());
    let model = CameraModel::nominal(Camera::BirdsEye, TIP);
    let mut renderer = Renderer::new(Arc::clone(&looks), &model);
    let (low, high) = (looks.body("p1").unwrap(), looks.body("p2").unwrap());
    let at = |z: f64| Pose::translation(0.6, 0.0, z);
    // In either order.
    for bodies in [vec![(low, at(0.04)), (high, at(0.2))], vec![(high, at(0.2)), (low, at(0.04))]] {
        renderer.render(&Scene { bodies }, &model.x_wc(&Pose::identity()), &mut Sensor::ideal());
        let middle = model.height / 2 * model.width + model.width / 2;
        assert_eq!(usize::from(renderer.segmentation()[middle]), high);
        // The top of a head 24 mm high, 2.5 m below the camera.
        assert!((f64::from(renderer.depth()[middle]) - (2.5 - 0.224)).abs() < 2e-3);
        // Beside it, the table.
        assert!((f64::from(renderer.depth()[middle + 300]) - 2.5).abs() < 1e-3);
    }
}

#[test]
fn a_picture_depends_on_no_earlier_one() {
    let kit = read_kit(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/kit.xml")).unwrap();
    let looks = Arc::new(Looks::new(&kit, None).unwrap());
    let model = CameraModel::nominal(Camera::BirdsEye, TIP);
    let peg = looks.body("p1").unwrap();
    let scene = |y: f64| Scene { bodies: vec![(peg, Pose::translation(0.6, y, 0.05))] };
    let stays = model.x_wc(&Pose::identity());
    let goes = Pose::translation(0.1, 0.05, 0.0) * stays;
    let mut kept = Renderer::new(Arc::clone(&looks), &model);
    // The camera stays, goes, and comes back, while the peg moves.
    for (y, x_wc) in [(0.0, stays), (0.2, stays), (0.2, goes), (0.1, stays)] {
        let image = kept.render(&scene(y), &x_wc, &mut Sensor::ideal());
        let mut new = Renderer::new(Arc::clone(&looks), &model);
        assert!(image == new.render(&scene(y), &x_wc, &mut Sensor::ideal()), "{y} {x_wc}");
    }
}

/// A part between the lamp and another one takes its light, and one on the other side does not.
#[test]
fn a_part_throws_a_shadow_on_another() {
    let kit = read_kit(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/kit.xml")).unwrap();
    let looks = Arc::new(Looks::new(&kit, None).unwrap());
    let model = CameraModel::nominal(Camera::BirdsEye, TIP);
    let mut renderer = Renderer::new(Arc::clone(&looks), &model);
    let [low, high] = ["p1", "p2"].map(|name| looks.body(name).unwrap());
    let middle = 3 * (model.height / 2 * model.width + model.width / 2);
    let mut red = |beside: Option<f64>| {
        let mut bodies = vec![(low, Pose::translation(0.6, 0.0, 0.04))];
        // The lamp stands to the right and behind the camera: 0.30, −0.34, 0.89.
        let at = |along: f64| Pose::translation(0.6 + 0.30 * along, -0.34 * along, 0.04 + 0.89 * along.abs());
        bodies.extend(beside.map(|along| (high, at(along))));
        let image = renderer.render(&Scene { bodies }, &model.x_wc(&Pose::identity()), &mut Sensor::ideal());
        f64::from(image[middle])
    };
    let alone = red(None);
    assert_eq!(alone, red(Some(-0.13)), "the lamp is on the other side");
    // Of 1.04 of light 0.55 are left.
    let left = (red(Some(0.13)) / alone).powf(2.2);
    assert!((left - 0.55 / 1.04).abs() < 0.02, "{left}");
}
