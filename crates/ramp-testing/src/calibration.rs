//! Recordings for the calibration of a cell: rendered images with known truth, and poses of the tip.

use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

use nalgebra::{Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::Pose;
use ramp_render::looks::CALIBRATION_SHEET;
use ramp_render::{Looks, Renderer, Scene, Sensor};
use ramp_robot::camera::Mount;
use ramp_robot::random::Stream;
use ramp_robot::{Camera, CameraModel};

use crate::table::{TIP, Table};

/// The calibration sheet on the table, and pictures of it.
pub struct Cell {
    /// The table with all parts at their starts.
    pub table: Table,
    /// The same bodies, and the calibration sheet.
    looks: Arc<Looks>,
    /// Pose of the calibration sheet in the world.
    pub x_wk: Pose,
}

/// A view of the calibration sheet.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Direction from which the camera looks, about the sheet's normal, rad.
    pub azimuth: f64,
    /// Angle between the line of sight and the normal, rad.
    pub tilt: f64,
    /// Turn about the line of sight, rad.
    pub roll: f64,
    /// Distance from the point that is looked at, m.
    pub distance: f64,
    /// That point on the sheet, m.
    pub at: [f64; 2],
}

/// A lens that is not the nominal one, as every real lens.
#[must_use]
pub fn real_lens(camera: Camera) -> CameraModel {
    let mut model = CameraModel::nominal(camera, TIP);
    let [fx, fy] = model.focal;
    model.focal = [fx * 1.012, fy * 1.0105];
    model.centre = [model.centre[0] + 7.3, model.centre[1] - 5.1];
    model.distortion[0] -= 0.012;
    model.distortion[1] += 0.004;
    model.distortion[2] += 2.0e-4;
    model
}

/// The same camera with its mounting off by some millimetres and degrees.
#[must_use]
pub fn off(mut model: CameraModel) -> CameraModel {
    let error = Pose::from_parts(
        Translation3::new(4.0e-3, -6.0e-3, 3.0e-3),
        UnitQuaternion::from_scaled_axis(Vector3::new(0.02, -0.03, 0.025)),
    );
    model.mount = match model.mount {
        Mount::Tip(x) => Mount::Tip(x * error),
        Mount::World(x) => Mount::World(x * error),
    };
    model
}

/// Views from all sides, the same for the same seed.
#[must_use]
pub fn all_around(count: usize, seed: u64, distance: [f64; 2]) -> Vec<View> {
    let mut stream = Stream::new(seed, "views");
    let view = |index: usize| View {
        azimuth: 2.4 * index as f64 + stream.symmetric(0.3),
        tilt: 0.15 + 0.5 * stream.uniform(),
        roll: stream.symmetric(1.2),
        distance: distance[0] + (distance[1] - distance[0]) * stream.uniform(),
        at: [stream.symmetric(0.08), stream.symmetric(0.05)],
    };
    (0..count).map(view).collect()
}

impl Cell {
    /// The sheet lies beside the parts' start sheet.
    #[must_use]
    #[allow(clippy::new_without_default)]
    pub fn new() -> Cell {
        let table = Table::new();
        let looks = (*table.looks).clone().with_calibration_sheet().unwrap();
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.01, -0.02, 0.4));
        let x_wk = Pose::from_parts(Translation3::new(0.45, -0.15, 0.012), turn);
        Cell { table, looks: Arc::new(looks), x_wk }
    }

    /// Pose of the optical frame in the world for a view.
    #[must_use]
    pub fn x_wc(&self, view: &View) -> Pose {
        let [sin, cos] = [view.tilt.sin(), view.tilt.cos()];
        let out = Vector3::new(sin * view.azimuth.cos(), sin * view.azimuth.sin(), cos);
        let forward = -out;
        let right = Vector3::new(-view.azimuth.sin(), view.azimuth.cos(), 0.0);
        let axes = Matrix3::from_columns(&[right, forward.cross(&right), forward]);
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes))
            * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), view.roll);
        let place = Vector3::new(view.at[0], view.at[1], 0.0) + out * view.distance;
        self.x_wk * Pose::from_parts(Translation3::from(place), rotation)
    }

    fn renderer(&self, model: &CameraModel) -> Renderer {
        Renderer::new(Arc::clone(&self.looks), model)
    }

    /// Writes images of the calibration sheet, `00.png` and so on.
    pub fn write_images(&self, model: &CameraModel, views: &[View], folder: &Path) {
        let (mut renderer, mut sensor) = (self.renderer(model), Sensor::new(7, "calibration"));
        let body = self.looks.body(CALIBRATION_SHEET).unwrap();
        let scene = Scene { bodies: vec![(body, self.x_wk)] };
        for (index, view) in views.iter().enumerate() {
            let pixels = renderer.render(&scene, &self.x_wc(view), &mut sensor);
            write_png(&folder.join(format!("{index:02}.png")), [model.width, model.height], &pixels);
        }
    }

    /// Writes `poses.csv` for images of the wrist camera; each pose is off by normally distributed errors of
    /// `sigma` (m and rad).
    pub fn write_poses(&self, model: &CameraModel, views: &[View], sigma: [f64; 2], folder: &Path) {
        let Mount::Tip(x_tc) = model.mount else { panic!("no wrist camera") };
        let mut stream = Stream::new(11, "tips");
        let mut poses = Vec::new();
        for view in views {
            let mut three = |sigma: f64| Vector3::from_fn(|_, _| stream.normal(sigma));
            let error = Pose::from_parts(
                Translation3::from(three(sigma[0])),
                UnitQuaternion::from_scaled_axis(three(sigma[1])),
            );
            poses.push(self.x_wc(view) * x_tc.inverse() * error);
        }
        std::fs::write(folder.join("poses.csv"), poses_csv(&poses)).unwrap();
    }

    /// Writes the image of the overhead camera, with all parts at their starts.
    pub fn write_birds_eye(&self, model: &CameraModel, path: &Path) {
        let mut sensor = Sensor::new(3, "birds-eye");
        let pixels =
            self.renderer(model).render(&self.table.scene(), &model.x_wc(&Pose::identity()), &mut sensor);
        write_png(path, [model.width, model.height], &pixels);
    }
}

/// A table of tip poses for the images `00.png` and so on.
#[must_use]
pub fn poses_csv(poses: &[Pose]) -> String {
    let mut text = String::from("image,x,y,z,qw,qx,qy,qz\n");
    for (index, pose) in poses.iter().enumerate() {
        let (t, q) = (pose.translation.vector, pose.rotation.quaternion());
        let _ = writeln!(text, "{index:02}.png,{},{},{},{},{},{},{}", t.x, t.y, t.z, q.w, q.i, q.j, q.k);
    }
    text
}

/// Writes pixels as a PNG file.
pub fn write_png(path: &Path, [width, height]: [usize; 2], pixels: &[u8]) {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.write_header().unwrap().write_image_data(pixels).unwrap();
    std::fs::write(path, bytes).unwrap();
}
