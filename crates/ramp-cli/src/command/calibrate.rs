//! `ramp calibrate`: a real cell's cameras, table and friction from recordings.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use miette::{Report, miette};
use ramp_calibration::file::{FrictionEntry, TableEntry};
use ramp_calibration::records::{images_of, read_joints, read_points, read_poses};
use ramp_calibration::{Calibration, CalibrationError, Verdict, birds_eye, friction, hand_eye, lens, table};
use ramp_data::Data;
use ramp_kit::source::plain;
use ramp_robot::{Camera, CameraModel, Pose};

use crate::output::{check_place, print, write_file};
use crate::status::{DONE, INCOMPLETE};

#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

/// The calibration file.
#[derive(clap::Args)]
struct Output {
    /// Calibration file that the result is added to if it is good enough; made if it is not there
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Lens of a camera, from images of the calibration sheet
    Lens {
        /// Folder with PNG images
        #[arg(value_name = "DIR")]
        images: PathBuf,
        /// The camera
        #[arg(long, value_name = "CAMERA", default_value = "wrist", value_parser = camera)]
        camera: Camera,
        #[command(flatten)]
        output: Output,
    },
    /// Pose of the wrist camera in the tip frame, from images of the calibration sheet with poses of the tip
    HandEye {
        /// Folder with PNG images and poses.csv
        #[arg(value_name = "DIR")]
        images: PathBuf,
        #[command(flatten)]
        output: Output,
    },
    /// Pose of the overhead camera in the robot's base frame, from the start sheet and the clamped beam
    BirdsEye {
        /// PNG image, or folder with such images
        #[arg(value_name = "FILE|DIR")]
        images: PathBuf,
        #[command(flatten)]
        output: Output,
    },
    /// Plane of the table, from points that the tip touched
    Table {
        /// Points in the robot's base frame (CSV)
        #[arg(value_name = "FILE")]
        points: PathBuf,
        #[command(flatten)]
        output: Output,
    },
    /// Friction of the joints, from recorded velocities and torques
    Friction {
        /// Recording of the joints (CSV)
        #[arg(value_name = "FILE")]
        recording: PathBuf,
        #[command(flatten)]
        output: Output,
    },
}

fn camera(name: &str) -> Result<Camera, String> {
    Camera::ALL
        .into_iter()
        .find(|camera| camera.name() == name)
        .ok_or_else(|| format!("expected {}", Camera::ALL.map(Camera::name).join(", ")))
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    match &arguments.command {
        Command::Lens { images, camera, output } => calibrate_lens(images, *camera, &output.output),
        Command::HandEye { images, output } => calibrate_hand_eye(images, &output.output),
        Command::BirdsEye { images, output } => calibrate_birds_eye(data, images, &output.output),
        Command::Table { points, output } => calibrate_table(data, points, &output.output),
        Command::Friction { recording, output } => calibrate_friction(data, recording, &output.output),
    }
}

/// The calibration file so far.
fn open(path: &Path) -> Result<Calibration, Report> {
    check_place(path)?;
    Ok(Calibration::read_or_empty(path)?)
}

/// The lens of a camera that the calibration file holds.
fn lens_of(calibration: &Calibration, camera: Camera, path: &Path) -> Result<CameraModel, Report> {
    calibration.lens_model(camera).ok_or_else(|| {
        let file = plain(&path.display().to_string(), usize::MAX);
        CalibrationError::NoLens { file, camera: camera.name() }.into()
    })
}

/// Prints an estimate with its verdict, and writes the file if the estimate is good enough.
fn conclude(
    mut text: String,
    verdict: &Verdict,
    calibration: &Calibration,
    path: &Path,
) -> Result<u8, Report> {
    for measure in &verdict.measures {
        let _ = writeln!(text, "{measure}");
    }
    if !verdict.is_good() {
        text.push_str("verdict: not good enough; nothing was written\n");
        print(&text)?;
        return Ok(INCOMPLETE);
    }
    write_file(path, calibration.to_toml())?;
    let _ = writeln!(text, "verdict: good enough; written to {}", path.display());
    print(&text)?;
    Ok(DONE)
}

fn left_out(text: &mut String, paths: &[PathBuf]) {
    if !paths.is_empty() {
        let names = paths.iter().map(|path| path.file_name().unwrap_or_default().to_string_lossy());
        let names = names.map(|name| plain(&name, usize::MAX)).collect::<Vec<_>>().join(", ");
        let _ = writeln!(text, "left out, because they show less than {} tags: {names}", lens::LEAST_TAGS);
    }
}

/// A pose as two lines: position in mm, and quaternion.
fn pose(text: &mut String, x: &Pose) {
    let (t, q) = (x.translation.vector * 1e3, x.rotation.quaternion());
    let _ = writeln!(text, "position: {:.2}, {:.2}, {:.2} mm", t.x, t.y, t.z);
    let _ = writeln!(text, "quaternion w, x, y, z: {:.5}, {:.5}, {:.5}, {:.5}", q.w, q.i, q.j, q.k);
}

fn calibrate_lens(images: &Path, camera: Camera, path: &Path) -> Result<u8, Report> {
    let mut calibration = open(path)?;
    let found = lens::calibrate(&images_of(images)?)?;
    let mut text = format!(
        "lens of the camera `{}`, from {} images of {} × {} pixels\n",
        camera.name(),
        found.images,
        found.model.width,
        found.model.height
    );
    left_out(&mut text, &found.left_out);
    let ([fx, fy], [cx, cy]) = (found.model.focal, found.model.centre);
    let [sfx, sfy, scx, scy] = found.errors;
    let _ = writeln!(text, "focal lengths: {fx:.2} ± {sfx:.2}, {fy:.2} ± {sfy:.2} pixels");
    let _ = writeln!(text, "principal point: {cx:.2} ± {scx:.2}, {cy:.2} ± {scy:.2} pixels");
    let [k1, k2, p1, p2, k3] = found.model.distortion;
    let _ = writeln!(text, "distortion k1, k2, p1, p2, k3: {k1:.5}, {k2:.5}, {p1:.6}, {p2:.6}, {k3:.5}");
    calibration.set_lens(camera, &found.model);
    conclude(text, &found.verdict(), &calibration, path)
}

fn calibrate_hand_eye(images: &Path, path: &Path) -> Result<u8, Report> {
    let mut calibration = open(path)?;
    let lens = lens_of(&calibration, Camera::Wrist, path)?;
    let found = hand_eye::calibrate(&lens, &read_poses(images)?)?;
    let mut text = format!("wrist camera in the tip frame, from {} images\n", found.images);
    left_out(&mut text, &found.left_out);
    pose(&mut text, &found.x_tc);
    calibration.x_tc = Some(found.x_tc);
    conclude(text, &found.verdict(), &calibration, path)
}

fn calibrate_birds_eye(data: &Data, images: &Path, path: &Path) -> Result<u8, Report> {
    let mut calibration = open(path)?;
    let lens = lens_of(&calibration, Camera::BirdsEye, path)?;
    let paths = if images.is_dir() { images_of(images)? } else { vec![images.to_path_buf()] };
    let found = birds_eye::calibrate(&lens, data.kit()?, &paths)?;
    let mut text = format!(
        "overhead camera in the robot's base frame, from {} image(s) with the tags {:?}\n",
        found.images, found.tags
    );
    pose(&mut text, &found.x_wc);
    calibration.x_wc = Some(found.x_wc);
    conclude(text, &found.verdict(), &calibration, path)
}

fn calibrate_table(data: &Data, points: &Path, path: &Path) -> Result<u8, Report> {
    let mut calibration = open(path)?;
    let corners = birds_eye::sheet_corners(data.kit()?);
    let found = table::calibrate(&read_points(points)?, &corners)?;
    let mut text = format!("table in the robot's base frame, from {} points\n", found.points);
    let [x, y, z]: [f64; 3] = found.normal.into();
    let _ = writeln!(text, "normal: {x:.5}, {y:.5}, {z:.5}");
    let heights = corners.map(|[x, y]| format!("{:.2}", found.height_at(x, y) * 1e3));
    let _ = writeln!(
        text,
        "height: {:.2} mm at the origin, {} mm at the corners of the sheet",
        found.height * 1e3,
        heights.join(", ")
    );
    if found.points == table::LEAST_POINTS {
        text.push_str("three points leave no residual: a fourth would show a mistake\n");
    }
    calibration.table = Some(TableEntry { normal: [x, y, z], height: found.height });
    conclude(text, &found.verdict(), &calibration, path)
}

fn calibrate_friction(data: &Data, recording: &Path, path: &Path) -> Result<u8, Report> {
    let mut calibration = open(path)?;
    let arm = data.arm()?;
    let samples = read_joints(recording)?;
    if samples.is_empty() {
        return Err(miette!("{} holds no samples", recording.display()));
    }
    let found = friction::calibrate(&arm, &samples)?;
    let mut text =
        format!("friction of the joints of the arm `{}`, from {} samples\n", arm.name, samples.len());
    text.push_str("joint  samples  coulomb N·m      viscous N·m·s/rad  offset N·m  residual N·m\n");
    for (index, joint) in found.joints.iter().enumerate() {
        let _ = writeln!(
            text,
            "{:>5}  {:>7}  {:>6.3} ± {:.3}   {:>6.3} ± {:.3}     {:>6.3}      {:.3}",
            index + 1,
            joint.samples,
            joint.coulomb,
            joint.errors[0],
            joint.viscous,
            joint.errors[1],
            joint.offset,
            joint.residual
        );
    }
    let of = |value: fn(&friction::JointFriction) -> f64| found.joints.each_ref().map(value);
    calibration.friction = Some(FrictionEntry {
        arm: arm.name.clone(),
        coulomb: of(|it| it.coulomb),
        viscous: of(|it| it.viscous),
        offset: of(|it| it.offset),
    });
    conclude(text, &found.verdict(), &calibration, path)
}
