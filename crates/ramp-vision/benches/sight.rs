//! Speed of drawing an image and of finding the parts in it, on one core, beside the reference detector at
//! its defaults on the same images in the same run.
//!
//! The reference only finds tags: fitting parts to them is on our account. The last columns are the same
//! image without tags, in which all parts are believed to be a millimetre off.

#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr)] // A failed unwrap here is a failed benchmark.

use std::sync::Arc;
use std::time::Instant;

use apriltag::{DetectorBuilder, Family};
use nalgebra::{Matrix6, Vector6};
use ramp_kit::Pose;
use ramp_render::{Looks, Sensor};
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;
use ramp_robot::{Camera, CameraModel};
use ramp_testing::table::{TIP, Table, tip_above};
use ramp_vision::image::Grey;
use ramp_vision::untagged::{Believed, Scene, SceneFinder};
use ramp_vision::{Lying, PartFinder};

/// Images of each kind.
const IMAGES: u32 = 40;

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// All parts, each believed to be 0.7 mm off along both axes, and known to a millimetre.
fn believed(table: &Table, lying: &[Lying]) -> Vec<Believed> {
    let sigma = Vector6::new(1.0e-3, 1.0e-3, 0.5e-3, 0.004, 0.004, 0.01);
    let believed = |(part, x_wp): &(String, Pose)| Believed {
        part: part.clone(),
        x_wp: Pose::translation(0.7e-3, 0.7e-3, 0.0) * x_wp,
        covariance: Matrix6::from_diagonal(&sigma.map(|sigma| sigma * sigma)),
        lying: lying.iter().find(|lying| lying.part == *part).cloned(),
        held: false,
    };
    table.parts.iter().map(believed).collect()
}

fn holders(table: &Table) -> Vec<(String, Pose)> {
    let place = |holder: &ramp_kit::Holder| {
        let at = table.kit.sheet_to_world(holder.centre);
        (holder.name.clone(), Pose::translation(at.x, at.y, 0.0))
    };
    table.kit.holders.iter().map(place).collect()
}

fn main() {
    // `-- --short` asks whether it still runs to its end.
    let short = std::env::args().any(|argument| argument == "--short");
    let images = if short { 2 } else { IMAGES };
    let table = Table::new();
    let lying = Lying::at_start(&table.kit);
    let mut finder = PartFinder::new(&table.kit).unwrap();
    let mut reference = DetectorBuilder::new().add_family_bits(Family::tag_25h9(), 2).build().unwrap();
    println!("1280 x 800, one core, median of {images} images");
    let arm = ArmModel::read(&ramp_testing::data().join("arms/panda.json")).unwrap();
    let mut bare = Table::new();
    bare.looks = Arc::new(Looks::clone(&bare.looks).without_tags(&bare.kit).unwrap());
    let mut scene_finder = SceneFinder::new(&bare.kit, &arm).unwrap();
    let (believed, holders) = (believed(&bare, &lying), holders(&bare));
    let scene = Scene { parts: &believed, holders: &holders, width: 0.08 };
    println!("                  draw ms   find ms  tags   reference ms  tags   untagged ms  parts");
    for (name, camera, height) in [
        ("wrist, 0.2 m", Camera::Wrist, 0.23),
        ("wrist, 0.5 m", Camera::Wrist, 0.53),
        ("bird's-eye", Camera::BirdsEye, 0.0),
    ] {
        let model = CameraModel::nominal(camera, TIP);
        let mut renderer = table.renderer(&model);
        let mut bare_renderer = bare.renderer(&model);
        let mut sensor = Sensor::new(1, camera.name());
        let mut stream = Stream::new(1, name);
        let (mut draw, mut find, mut others) = (Vec::new(), Vec::new(), Vec::new());
        let mut untagged = Vec::new();
        let (mut tags, mut other_tags, mut parts) = (0, 0, 0);
        for _ in 0..images {
            let eye = [0.15 + 0.4 * stream.uniform(), 0.25 + 0.25 * stream.uniform(), height];
            let tilt = [stream.symmetric(0.2), stream.symmetric(0.2)];
            let x_wt = tip_above(&model, eye, stream.symmetric(1.5), tilt);
            let begin = Instant::now();
            let image = table.look(&mut renderer, &mut sensor, camera, x_wt);
            draw.push(begin.elapsed().as_secs_f64() * 1e3);
            let begin = Instant::now();
            let sighting = finder.find(&image, &model, &lying).unwrap();
            find.push(begin.elapsed().as_secs_f64() * 1e3);
            tags += sighting.detections.len();
            let grey = Grey::new(&image, &model).unwrap();
            let mut copy = apriltag::Image::zeros_with_alignment(grey.width, grey.height, 96).unwrap();
            let stride = copy.stride();
            for (row, pixels) in grey.pixels.chunks_exact(grey.width).enumerate() {
                copy.as_slice_mut()[row * stride..][..grey.width].copy_from_slice(pixels);
            }
            let begin = Instant::now();
            let found = reference.detect(&copy);
            others.push(begin.elapsed().as_secs_f64() * 1e3);
            other_tags += found.len();
            let image = bare.look(&mut bare_renderer, &mut sensor, camera, x_wt);
            let begin = Instant::now();
            let found = scene_finder.find(&image, &model, &scene, &|_| true, 0.0).unwrap();
            untagged.push(begin.elapsed().as_secs_f64() * 1e3);
            parts += found.found.len();
        }
        println!(
            "{name:<14} {:>9.1} {:>9.1} {tags:>6} {:>13.1} {other_tags:>6} {:>13.1} {parts:>6}",
            median(&mut draw),
            median(&mut find),
            median(&mut others),
            median(&mut untagged)
        );
    }
}
