//! Depth as the sensor of the track `depth` measures it.

use std::path::Path;
use std::sync::Arc;

use ramp_kit::{Pose, read_kit};
use ramp_render::{Looks, Renderer, Scene, Sensor, StereoErrors, StereoSensor};
use ramp_robot::{Camera, CameraModel, DEPTH_UNIT, ImageWidth};

const TIP: f64 = 0.1134;
const EXACT: StereoErrors = StereoErrors { noise: 0.0, bias: 0.0, spread: 0.0, holes: 0.0 };

/// A beam on the table and a peg above it, from the height of a look.
fn drawn(width: Option<ImageWidth>) -> Renderer {
    let kit = read_kit(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/kit.xml")).unwrap();
    let looks = Arc::new(Looks::new(&kit, None).unwrap());
    let mut model = CameraModel::nominal(Camera::Wrist, TIP);
    if let Some(width) = width {
        model = model.with_width(width);
    }
    let down = nalgebra::UnitQuaternion::from_axis_angle(&nalgebra::Vector3::x_axis(), std::f64::consts::PI);
    let x_wc = Pose::from_parts(nalgebra::Translation3::new(0.6, 0.0, 0.35), down);
    let (beam, peg) = (looks.body("b1").unwrap(), looks.body("p1").unwrap());
    let bodies =
        vec![(beam, Pose::translation(0.45, 0.05, 0.015)), (peg, Pose::translation(0.65, 0.0, 0.08))];
    let mut renderer = Renderer::new(looks, &model);
    renderer.render(&Scene { bodies }, &x_wc, &mut Sensor::ideal());
    renderer
}

fn measured(renderer: &Renderer, errors: StereoErrors) -> Vec<f64> {
    let depth = StereoSensor::new(1, Camera::Wrist, errors).measure(renderer);
    depth.into_iter().map(|units| f64::from(units) * DEPTH_UNIT).collect()
}

/// Focal length times baseline, pixels · m.
fn factor() -> f64 {
    CameraModel::nominal(Camera::Wrist, TIP).focal[0] * Camera::Wrist.baseline()
}

/// Without errors only the steps of the disparity are left, what the second lens does not see has no depth,
/// and smaller images show the same distances.
#[test]
fn depth_without_errors_is_as_good_as_its_steps() {
    for width in [None, ImageWidth::new(320)] {
        let renderer = drawn(width);
        let truth = renderer.depth();
        let depth = measured(&renderer, EXACT);
        let columns = width.map_or(1280, ImageWidth::pixels);
        let scale = 1280.0 / columns as f64;
        let mut hidden = 0;
        for (index, (depth, truth)) in depth.iter().zip(&truth).enumerate() {
            let disparity = factor() / f64::from(*truth);
            let beyond = ((index % columns) as f64) * scale < disparity;
            assert!(!(beyond && *depth > 0.0), "pixel {index} is outside of the second image");
            if *depth == 0.0 {
                hidden += usize::from(!beyond);
                continue;
            }
            let error = factor() / depth - disparity;
            // Half a step, and half a unit of the depth.
            assert!(error.abs() < 0.5 / 32.0 + 0.01, "pixel {index}: {error} pixels");
        }
        // To the left of the peg, as wide as its disparity is larger than the table's.
        let share = hidden as f64 / depth.len() as f64;
        assert!((1.0e-4..0.02).contains(&share), "{share}");
    }
}

/// Noise and bias are as large as they are said to be, and metal has holes.
#[test]
fn errors_are_as_large_as_the_world_says() {
    let renderer = drawn(None);
    let truth = renderer.depth();
    let errors = |depth: &[f64]| -> Vec<f64> {
        let pairs = depth.iter().zip(&truth).filter(|(depth, truth)| **depth > 0.0 && **truth > 0.34);
        pairs.map(|(depth, truth)| factor() / depth - factor() / f64::from(*truth)).collect()
    };
    let root_mean =
        |errors: &[f64]| (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
    let noisy = errors(&measured(&renderer, StereoErrors { noise: 0.08, ..EXACT }));
    assert!((root_mean(&noisy) - 0.08).abs() < 0.01, "{}", root_mean(&noisy));
    let biased = errors(&measured(&renderer, StereoErrors { bias: 0.1, ..EXACT }));
    // Less than at its nodes, since it is interpolated between them.
    assert!((0.03..0.12).contains(&root_mean(&biased)), "{}", root_mean(&biased));
    let count = |depth: Vec<f64>| depth.iter().filter(|depth| **depth > 0.0).count();
    let lost =
        count(measured(&renderer, EXACT)) - count(measured(&renderer, StereoErrors { holes: 1.0, ..EXACT }));
    assert!(lost > 1000, "{lost}");
    // Nearer surfaces grow by two pixels on each side.
    let near = |depth: Vec<f64>| depth.iter().filter(|depth| (0.01..0.26).contains(*depth)).count();
    let (sharp, wide) =
        (near(measured(&renderer, EXACT)), near(measured(&renderer, StereoErrors { spread: 1.0, ..EXACT })));
    assert!(wide > sharp + sharp / 20, "{sharp} {wide}");
}

#[test]
fn a_seed_gives_the_same_depth() {
    let renderer = drawn(None);
    let errors = StereoErrors { noise: 0.08, bias: 0.1, spread: 0.7, holes: 0.25 };
    let first = StereoSensor::new(1, Camera::Wrist, errors).measure(&renderer);
    assert!(first == StereoSensor::new(1, Camera::Wrist, errors).measure(&renderer));
    assert!(first != StereoSensor::new(2, Camera::Wrist, errors).measure(&renderer));
}
