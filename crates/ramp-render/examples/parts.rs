//! Draws the parts on their sheet, seen by both cameras, into two PNG files of the folder that is named.

#![allow(clippy::print_stdout, clippy::print_stderr)]

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use ramp_kit::Pose;
use ramp_render::{Looks, Renderer, Scene, Sensor};
use ramp_robot::{Camera, CameraModel};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".to_string());
    let kit = ramp_kit::read_kit(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/kit.xml"))?;
    let begin = Instant::now();
    let looks = Arc::new(Looks::new(&kit, None)?);
    let triangles: usize = looks.bodies().iter().map(|body| body.surfaces[0].mesh.triangles.len()).sum();
    println!("looks: {triangles} triangles, {:.0} ms", begin.elapsed().as_secs_f64() * 1e3);
    let mut scene = Scene::default();
    let mut place = |name: &str, x: Option<Pose>| {
        if let (Some(index), Some(x)) = (looks.body(name), x) {
            scene.bodies.push((index, x));
        }
    };
    for beam in &kit.beams {
        let base = Pose::translation(0.0, 0.0, beam.axis_height_on_table());
        place(&beam.name, kit.x_wb_start(beam).or(Some(kit.x_wa() * base)));
    }
    for peg in &kit.pegs {
        place(&peg.name, kit.x_wp_start(peg));
    }
    for holder in &kit.holders {
        place(&holder.name, Some(Pose::from(kit.sheet_to_world(holder.centre))));
    }
    for camera in Camera::ALL {
        let model = CameraModel::nominal(camera, 0.1134);
        let mut renderer = Renderer::new(Arc::clone(&looks), &model);
        let mut sensor = Sensor::new(1, camera.name());
        let down =
            nalgebra::UnitQuaternion::from_axis_angle(&nalgebra::Vector3::x_axis(), std::f64::consts::PI);
        let x_wt = Pose::from_parts(nalgebra::Translation3::new(0.25, 0.25, 0.17), down);
        let mut best = f64::MAX;
        let mut pixels = Vec::new();
        for _ in 0..20 {
            let begin = Instant::now();
            pixels = renderer.render(&scene, &model.x_wc(&x_wt), &mut sensor);
            best = best.min(begin.elapsed().as_secs_f64() * 1e3);
        }
        println!("{}: {best:.1} ms", camera.name());
        let file = std::fs::File::create(Path::new(&folder).join(format!("{}.png", camera.name())))?;
        let mut encoder =
            png::Encoder::new(std::io::BufWriter::new(file), model.width as u32, model.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.write_header()?.write_image_data(&pixels)?;
    }
    Ok(())
}
