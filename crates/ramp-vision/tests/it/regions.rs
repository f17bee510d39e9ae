//! The regions that the detector looks at: they hold every tag that it finds in the whole image.

use std::collections::BTreeMap;

use nalgebra::Point3;
use ramp_kit::Pose;
use ramp_kit::tags::TagPlace;
use ramp_render::Sensor;
use ramp_robot::random::Stream;
use ramp_robot::{Camera, CameraModel, Image};
use ramp_testing::table::{TIP, Table, tip_above};
use ramp_vision::PartFinder;
use ramp_vision::detect::{Detection, TagFinder};
use ramp_vision::find::corner_points;
use ramp_vision::image::Grey;
use ramp_vision::regions::{Region, regions};

/// Images of each kind, from random places: near and far from the wrist, and from above.
const IMAGES: usize = 4;
/// Least difference of light that the regions are looked for with here.
const CONTRAST: u8 = 30;

struct View {
    image: Image,
    model: CameraModel,
}

fn views(table: &Table) -> Vec<View> {
    let mut stream = Stream::new(11, "regions");
    let mut views = Vec::new();
    for (camera, height) in [(Camera::Wrist, 0.19), (Camera::Wrist, 0.53), (Camera::BirdsEye, 0.0)] {
        let model = CameraModel::nominal(camera, TIP);
        let mut renderer = table.renderer(&model);
        let mut sensor = Sensor::new(11, camera.name());
        for _ in 0..IMAGES {
            let eye = [0.15 + 0.4 * stream.uniform(), 0.25 + 0.25 * stream.uniform(), height];
            let tilt = [stream.symmetric(0.4), stream.symmetric(0.4)];
            let x_wt = tip_above(&model, eye, stream.symmetric(3.0), tilt);
            let image = table.look(&mut renderer, &mut sensor, camera, x_wt);
            views.push(View { image, model: model.clone() });
        }
    }
    views
}

/// Sum of the squares of the errors of a tag's corners, pixels².
fn error(table: &Table, places: &BTreeMap<u32, TagPlace>, view: &View, tag: &Detection) -> f64 {
    let place = &places[&tag.id];
    let x_wp = if place.part == "sheet" { Pose::identity() } else { table.truth(&place.part) };
    let x_cp = view.model.x_wc(&view.image.x_wt).inverse() * x_wp;
    let square = |(p_p, [u, v]): (Point3<f64>, [f64; 2])| {
        let [x, y] = view.model.project(&(x_cp * p_p)).unwrap();
        (u - x).powi(2) + (v - y).powi(2)
    };
    corner_points(place).into_iter().zip(tag.corners).map(square).sum()
}

#[test]
fn tags_are_the_same_as_in_the_whole_image_and_as_exact() {
    let table = Table::new();
    let places = PartFinder::new(&table.kit).unwrap().places().clone();
    let mut finder = TagFinder::new().unwrap();
    let (mut tags, mut squares) = (0, [0.0; 2]);
    for (index, view) in views(&table).iter().enumerate() {
        let grey = Grey::new(&view.image, &view.model).unwrap();
        let found = finder.find(&grey).unwrap();
        let whole = finder.find_in(&grey, &[Region::whole(&grey)]).unwrap();
        let ids = |tags: &[Detection]| tags.iter().map(|tag| tag.id).collect::<Vec<_>>();
        assert_eq!(ids(&found), ids(&whole), "image {index}");
        for (a, b) in found.iter().zip(&whole) {
            let [square, other] = [a, b].map(|tag| error(&table, &places, view, tag));
            squares = [squares[0] + square, squares[1] + other];
        }
        tags += found.len();
    }
    assert!(tags > 20 * 2 * IMAGES, "{tags}");
    let [found, whole] = squares.map(|sum| (sum / (4 * tags) as f64).sqrt());
    assert!(found < 1.02 * whole, "{found:.3} and {whole:.3} pixels");
}

#[test]
fn most_of_the_images_is_left_out() {
    let (mut looked, mut all) = (0, 0);
    for View { image, model } in views(&Table::new()) {
        let grey = Grey::new(&image, &model).unwrap();
        let pixels = |region: &Region| -> usize {
            (region.top..region.top + region.height).map(|row| region.columns(row).len()).sum()
        };
        looked += regions(&grey, CONTRAST).iter().map(pixels).sum::<usize>();
        all += grey.width * grey.height;
    }
    assert!(5 * looked < 2 * all, "{looked} of {all} pixels");
}

#[test]
fn an_image_without_black_squares_has_none() {
    let (width, height) = (320, 200);
    // Plain, and with a black line and a black square without white inside.
    let mut grey = Grey { width, height, pixels: vec![200; width * height] };
    assert_eq!(regions(&grey, CONTRAST), []);
    for [width, height] in [[1, 9], [9, 1]] {
        assert_eq!(regions(&Grey { width, height, pixels: vec![0; 9] }, CONTRAST), []);
    }
    for y in 50..100 {
        grey.pixels[y * width + 50..][..50].fill(10);
        grey.pixels[y * width + 150..][..2].fill(10);
    }
    assert_eq!(regions(&grey, CONTRAST), []);
    // A square of 7 by 7 cells, of which those inside are black and white in turn.
    let cell = |at: usize| (at - 50) / 7;
    for y in 57..92 {
        for x in (57..92).filter(|x| (cell(*x) + cell(y)) % 2 == 1) {
            grey.pixels[y * width + x] = 200;
        }
    }
    for y in 50..100 {
        grey.pixels[y * width + 99] = 200;
        if y == 99 {
            grey.pixels[y * width + 50..][..50].fill(200);
        }
    }
    let found = regions(&grey, CONTRAST);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].is_for([74.5, 74.5], 2400.0), "{found:?}");
    assert!(!found[0].is_for([74.5, 74.5], 900.0) && !found[0].is_for([125.0, 74.5], 2400.0));
    // The white around it is a cell wide.
    assert!((43..106).all(|row| found[0].columns(row).contains(&74)), "{found:?}");
    assert!((43..106).all(|column| found[0].columns(74).contains(&column)), "{found:?}");
}
