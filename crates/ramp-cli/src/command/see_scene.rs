//! `ramp see --track colour` and `depth`: camera images of a goal without tags, the parts that the baseline
//! finds in them, and their errors. The cameras' places are known, as they are once the clamped beam was
//! seen; their lenses are those that an agent is told.

use std::fmt::Write;
use std::path::Path;

use miette::{IntoDiagnostic, Report};
use nalgebra::{Matrix6, Vector6};
use ramp_kit::{Holder, Kit};
use ramp_robot::arm::ArmModel;
use ramp_robot::{Camera, CameraModel, Image, Pose, Robot};
use ramp_twin::Twin;
use ramp_vision::Lying;
use ramp_vision::untagged::{Believed, Found, Scene, SceneFinder};

use crate::image_file::{write_pixels, write_png};

/// Standard deviations of a part's place at the start `sheet`: shift along each axis, m, and turn, rad.
const SIGMA: [f64; 6] = [1.0e-3, 1.0e-3, 1.5e-3, 0.007, 0.007, 0.017];

/// Writes the images of both cameras, and over them the drawing at the poses that were found. Gives the table
/// of errors.
pub fn write(kit: &Kit, arm: &ArmModel, twin: &mut Twin, folder: &Path) -> Result<String, Report> {
    let mut finder = SceneFinder::new(kit, arm).into_diagnostic()?;
    let (believed, holders) = (believed(kit), holders(kit));
    let width = twin.observe().width;
    let mut text = String::new();
    for camera in Camera::ALL {
        let image = twin.look(camera).into_diagnostic()?;
        let told = CameraModel { mount: twin.true_camera(camera).mount, ..twin.camera(camera) };
        let scene = Scene { parts: &believed, holders: &holders, width };
        let found = finder.find(&image, &told, &scene, &|_| true, 0.0).into_diagnostic()?.found;
        write_png(&folder.join(format!("{}.png", camera.name())), &image, &image.pixels)?;
        if let Some(depth) = &image.depth {
            let bytes: Vec<u8> = depth.iter().flat_map(|depth| depth.to_be_bytes()).collect();
            let path = folder.join(format!("{}-depth.png", camera.name()));
            write_pixels(&path, &image, &bytes, png::ColorType::Grayscale, png::BitDepth::Sixteen)?;
        }
        let mut there = believed.clone();
        there.retain_mut(|part| {
            let seen = found.iter().find(|it| it.part == part.part);
            seen.is_some_and(|seen| {
                part.x_wp = seen.x_wp;
                true
            })
        });
        let drawing = finder
            .drawing(&image, &told, &Scene { parts: &there, holders: &holders, width })
            .into_diagnostic()?;
        write_png(&folder.join(format!("{}-found.png", camera.name())), &image, &over(&image, &drawing))?;
        table(&mut text, camera, twin, &found);
    }
    Ok(text)
}

fn believed(kit: &Kit) -> Vec<Believed> {
    let lying = Lying::at_start(kit);
    let beams = kit.beams.iter().map(|beam| (&beam.name, kit.x_wb_start(beam)));
    let pegs = kit.pegs.iter().map(|peg| (&peg.name, kit.x_wp_start(peg)));
    let part = |(name, x): (&String, Option<Pose>)| {
        Some(Believed {
            part: name.clone(),
            x_wp: x?,
            covariance: Matrix6::from_diagonal(&Vector6::from(SIGMA).map(|sigma| sigma * sigma)),
            lying: lying.iter().find(|it| it.part == *name).cloned(),
            held: false,
        })
    };
    beams.chain(pegs).filter_map(part).collect()
}

fn holders(kit: &Kit) -> Vec<(String, Pose)> {
    let place = |holder: &Holder| {
        let at = kit.sheet_to_world(holder.centre);
        (holder.name.clone(), Pose::translation(at.x, at.y, 0.0))
    };
    kit.holders.iter().map(place).collect()
}

/// The drawing over the image, half and half, where it shows something.
fn over(image: &Image, drawing: &[Option<[u8; 3]>]) -> Vec<u8> {
    let pixels = image.pixels.as_chunks::<3>().0.iter().zip(drawing);
    let mixed = pixels.flat_map(|(seen, drawn)| match drawn {
        // Green, so that it is told from the image.
        Some([_, light, _]) => [seen[0] / 2, seen[1] / 2 + 64 + light / 4, seen[2] / 2],
        None => *seen,
    });
    mixed.collect()
}

fn table(text: &mut String, camera: Camera, twin: &Twin, found: &[Found]) {
    let truth = twin.truth();
    let places: Vec<(&str, Pose)> = twin.part_names().zip(truth.x_wp).collect();
    let _ = writeln!(text, "{}: {} parts", camera.name(), found.len());
    let _ = writeln!(text, "part  steps  share  pixels      x mm    y mm    z mm   turn °");
    for part in found {
        let Some((_, x_wp)) = places.iter().find(|(name, _)| *name == part.part) else { continue };
        let off = (part.x_wp.translation.vector - x_wp.translation.vector) * 1e3;
        let turn = part.x_wp.rotation.angle_to(&x_wp.rotation).to_degrees();
        let _ = writeln!(
            text,
            "{:<5} {:>5}  {:>5.2} {:>7.2}   {:>7.2} {:>7.2} {:>7.2} {:>8.2}",
            part.part, part.agreeing, part.share, part.pixels, off.x, off.y, off.z, turn
        );
    }
    text.push('\n');
}
