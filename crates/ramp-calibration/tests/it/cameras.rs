//! Cameras, on rendered images with known truth.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_calibration::records::{images_of, read_poses};
use ramp_calibration::{CalibrationError, birds_eye, hand_eye, lens};
use ramp_kit::Pose;
use ramp_robot::camera::{ImageWidth, Mount};
use ramp_robot::{Camera, CameraModel};
use ramp_testing::calibration::{Cell, View, all_around, off, poses_csv, real_lens, write_png};
use tempfile::TempDir;

static CELL: LazyLock<Cell> = LazyLock::new(Cell::new);

/// Distances of the cameras from the sheet, m.
const NEAR: [f64; 2] = [0.16, 0.3];
const FAR: [f64; 2] = [0.35, 0.8];

/// Largest distance between the places at which two lenses show a direction, pixels.
fn apart(a: &CameraModel, b: &CameraModel) -> f64 {
    let mut most: f64 = 0.0;
    for index in 0..81 {
        let share = |at: usize| at as f64 / 8.0;
        let pixel = [share(index % 9) * a.width as f64, share(index / 9) * a.height as f64];
        let [x, y] = a.direction(pixel);
        let [u, v] = b.project(&Point3::new(x, y, 1.0)).unwrap();
        most = most.max((u - pixel[0]).hypot(v - pixel[1]));
    }
    most
}

/// Difference between two poses, mm and degrees.
fn between(a: &Pose, b: &Pose) -> [f64; 2] {
    let left = a.inverse() * b;
    [left.translation.vector.norm() * 1e3, left.rotation.angle().to_degrees()]
}

fn mount(model: &CameraModel) -> Pose {
    let (Mount::Tip(x) | Mount::World(x)) = model.mount;
    x
}

/// A camera of half the size, for pictures that are made quickly.
fn small() -> CameraModel {
    real_lens(Camera::Wrist).with_width(ImageWidth::new(640).unwrap())
}

/// Images of the sheet in a new folder.
fn folder_of(model: &CameraModel, views: &[View]) -> TempDir {
    let folder = TempDir::new().unwrap();
    CELL.write_images(model, views, folder.path());
    folder
}

fn lens_from(folder: &Path) -> Result<lens::Lens, CalibrationError> {
    lens::calibrate(&images_of(folder)?)
}

#[test]
fn measured_lenses_are_found() {
    for (camera, distance) in [(Camera::Wrist, NEAR), (Camera::BirdsEye, FAR)] {
        let truth = real_lens(camera);
        let folder = folder_of(&truth, &all_around(8, 1, distance));
        let found = lens_from(folder.path()).unwrap();
        assert!(found.verdict().is_good(), "{:?}", found.verdict());
        // The nominal lens, where the search does not begin, is 12 pixels off and more.
        let error = apart(&truth, &found.model);
        assert!(error < 0.4, "{camera:?}: {error:.3} pixels");
        // The standard error is neither boastful nor useless.
        assert!(error < 5.0 * found.place && found.place < 0.5, "{error:.3}, {:.3}", found.place);
        let focal = found.model.focal[0] - truth.focal[0];
        assert!(focal.abs() < 5e-4 * truth.focal[0], "{focal:.3} pixels");
        eprintln!(
            "| lens of the camera `{}` | 8 images | {:.3} pixels | {error:.2} pixels | {:.2} pixels |",
            camera.name(),
            found.residual,
            found.place
        );
    }
}

#[test]
fn measured_wrist_camera_is_found_in_the_hand() {
    let truth = off(real_lens(Camera::Wrist));
    let views = all_around(10, 2, NEAR);
    let folder = folder_of(&truth, &views);
    for (sigma, most) in [([0.0; 2], [0.02, 0.003]), ([0.2e-3; 2], [0.35, 0.04])] {
        CELL.write_poses(&truth, &views, sigma, folder.path());
        let found = hand_eye::calibrate(&truth, &read_poses(folder.path()).unwrap()).unwrap();
        assert!(found.verdict().is_good(), "{:?}", found.verdict());
        let [place, angle] = between(&mount(&truth), &found.x_tc);
        let [place_error, angle_error] = [found.errors[0] * 1e3, found.errors[1].to_degrees()];
        eprintln!(
            "| hand-eye, tip off by σ {} mm and {} mrad an axis | 10 images | {:.3} pixels | {place:.3} mm, {angle:.3}° | {place_error:.3} mm, {angle_error:.3}° |",
            sigma[0] * 1e3,
            sigma[1] * 1e3,
            found.residual,
        );
        assert!(place < most[0] && angle < most[1], "{place:.4} mm, {angle:.4}°");
        assert!(place < 5e3 * found.errors[0].max(2e-6), "{place:.4} mm, {:?}", found.errors);
    }
    // Poses of other images.
    let text = std::fs::read_to_string(folder.path().join("poses.csv")).unwrap();
    let swapped = text.replace("02.png", "x.png").replace("05.png", "02.png").replace("x.png", "05.png");
    std::fs::write(folder.path().join("poses.csv"), swapped).unwrap();
    match hand_eye::calibrate(&truth, &read_poses(folder.path()).unwrap()) {
        Ok(found) => assert!(!found.verdict().is_good(), "{:?}", found.verdict()),
        Err(error) => assert!(matches!(error, CalibrationError::Degenerate { .. }), "{error}"),
    }
}

#[test]
fn measured_overhead_camera_is_found() {
    let truth = off(real_lens(Camera::BirdsEye));
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("table.png");
    CELL.write_birds_eye(&truth, &path);
    let kit = &CELL.table.kit;
    let found = birds_eye::calibrate(&truth, kit, &[path]).unwrap();
    assert!(found.verdict().is_good() && found.tags.len() >= 3, "{found:?}");
    let [place, angle] = between(&mount(&truth), &found.x_wc);
    assert!(place < 8.0 && angle < 0.2, "{place:.2} mm, {angle:.3}°");
    // The pixel of a point of the sheet, projected back onto the table.
    let [x, y] = birds_eye::sheet_corners(kit)[0];
    let p = Point3::new(x, y, 0.0);
    let shift = found.x_wc.inverse() * p - mount(&truth).inverse() * p;
    let shift = shift.xy().norm();
    assert!(shift < 5.0 * found.place && shift < 1.8e-3, "{:.3} mm of {:.3}", shift * 1e3, found.place * 1e3);
    eprintln!(
        "| overhead camera | 1 image | {:.3} pixels | {place:.2} mm, {angle:.3}°; {:.2} mm on the sheet | {:.2} mm on the sheet |",
        found.residual,
        shift * 1e3,
        found.place * 1e3
    );
}

#[test]
fn too_few_images_are_refused() {
    let folder = folder_of(&small(), &all_around(5, 1, NEAR));
    let error = lens_from(folder.path()).unwrap_err();
    assert!(matches!(error, CalibrationError::TooFew { found: 5, least: 6, .. }), "{error}");
    let empty = TempDir::new().unwrap();
    let error = lens_from(empty.path()).unwrap_err();
    assert!(matches!(error, CalibrationError::TooFew { found: 0, .. }), "{error}");
}

#[test]
fn images_from_one_direction_are_refused() {
    // The sheet moves along, but does not tilt; a turn about the line of sight would tilt it another way.
    let from = |tilt: f64| {
        let views: Vec<View> = all_around(7, 1, NEAR)
            .into_iter()
            .map(|view| View { azimuth: 0.4, tilt, roll: 0.2, ..view })
            .collect();
        lens_from(folder_of(&small(), &views).path()).unwrap_err()
    };
    for error in [from(0.0), from(0.5)] {
        assert!(error.to_string().contains("from one direction"), "{error}");
    }
}

#[test]
fn turns_about_one_axis_are_refused() {
    let model = small();
    // The camera looks straight down, and turns about its line of sight only.
    let views: Vec<View> =
        all_around(6, 1, NEAR).into_iter().map(|view| View { azimuth: 0.0, tilt: 0.0, ..view }).collect();
    let folder = folder_of(&model, &views);
    CELL.write_poses(&model, &views, [0.0; 2], folder.path());
    let error = hand_eye::calibrate(&model, &read_poses(folder.path()).unwrap()).unwrap_err();
    assert!(error.to_string().contains("about one axis only"), "{error}");
}

#[test]
fn files_that_are_no_images_are_refused() {
    let folder = folder_of(&small(), &all_around(1, 1, NEAR));
    let refused = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let error = lens_from(folder.path()).unwrap_err().to_string();
        std::fs::remove_file(&path).unwrap();
        assert!(error.contains(name), "{error}");
        error
    };
    let whole = std::fs::read(folder.path().join("00.png")).unwrap();
    assert!(refused("cut.png", &whole[..whole.len() / 2]).contains("cannot be read as PNG"));
    assert!(refused("text.png", b"no image").contains("cannot be read as PNG"));
    // A header of very many pixels is refused before they are read.
    let mut huge = whole.clone();
    huge[16..20].copy_from_slice(&0x7fff_ffff_u32.to_be_bytes());
    refused("huge.png", &huge);
    let mut large = Vec::new();
    let mut encoder = png::Encoder::new(&mut large, 4000, 3001);
    encoder.set_color(png::ColorType::Grayscale);
    let pixels = vec![0; 4000 * 3001];
    encoder.write_header().unwrap().write_image_data(&pixels).unwrap();
    assert!(refused("large.png", &large).contains("at most 12 millions"));
    let other = folder.path().join("other.png");
    write_png(&other, [16, 16], &[128; 16 * 16 * 3]);
    let error = lens_from(folder.path()).unwrap_err().to_string();
    assert!(error.contains("other.png") && error.contains("16 × 16"), "{error}");
    write_png(&other, [640, 400], &[0; 640 * 400 * 3]);
    let error = lens_from(folder.path()).unwrap_err().to_string();
    assert!(error.contains("other.png") && error.contains("black"), "{error}");
}

#[test]
fn an_overhead_image_without_tags_is_refused() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("grey.png");
    let model = real_lens(Camera::BirdsEye);
    write_png(&path, [model.width, model.height], &vec![90; model.width * model.height * 3]);
    let kit = &CELL.table.kit;
    let error = birds_eye::calibrate(&model, kit, std::slice::from_ref(&path)).unwrap_err();
    assert!(matches!(error, CalibrationError::TooFew { found: 0, least: 2, .. }), "{error}");
    let error = birds_eye::calibrate(&small(), kit, &[path]).unwrap_err().to_string();
    assert!(error.contains("the lens was calibrated with 640 × 400"), "{error}");
}

#[test]
fn bad_tables_of_poses_are_refused() {
    let folder = TempDir::new().unwrap();
    let refused = |text: &str, words: [&str; 2]| {
        std::fs::write(folder.path().join("poses.csv"), text).unwrap();
        let error = read_poses(folder.path()).unwrap_err().to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    };
    let head = "image,x,y,z,qw,qx,qy,qz\n";
    refused("", [":1:", "empty"]);
    refused("a,b\n", [":1:", "image,x,y,z,qw,qx,qy,qz"]);
    refused(&format!("{head}00.png,0,0,0,1,0,0\n"), [":2:", "7 cells"]);
    refused(&format!("{head}00.png,0,0,nan,1,0,0,0\n"), [":2:", "`nan`"]);
    refused(&format!("{head}00.png,0,0,1e9,1,0,0,0\n"), [":2:", "from -10 to 10"]);
    refused(&format!("{head}00.png,0,0,0,1,0.5,0,0\n"), [":2:", "unit quaternion"]);
    refused(&format!("{head}../00.png,0,0,0,1,0,0,0\n"), [":2:", "same folder"]);
    refused(&format!("{head}# told\n0.png,0,0,0,1,0,0,0\n0.png,0,0,0,1,0,0,0\n"), [":4:", "each image once"]);
    let x = Pose::from_parts(
        Translation3::new(0.1, -0.2, 0.3),
        UnitQuaternion::from_scaled_axis(Vector3::new(0.3, 0.2, -0.1)),
    );
    std::fs::write(folder.path().join("poses.csv"), poses_csv(&[x])).unwrap();
    let read: Vec<(PathBuf, Pose)> = read_poses(folder.path()).unwrap();
    let [place, angle] = between(&x, &read[0].1);
    assert!(read[0].0 == folder.path().join("00.png") && place < 1e-9 && angle < 1e-6);
}
