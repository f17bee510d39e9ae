//! Calibration files.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_calibration::Calibration;
use ramp_calibration::file::{FrictionEntry, TableEntry};
use ramp_robot::camera::Mount;
use ramp_robot::{Camera, Pose};
use ramp_testing::calibration::real_lens;

fn full() -> Calibration {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.1, 0.7, -0.3));
    let mut calibration = Calibration {
        x_tc: Some(Pose::from_parts(Translation3::new(0.05, 1.0 / 3.0, -0.06), turn)),
        x_wc: Some(Pose::from_parts(Translation3::new(0.6, 0.0, 2.5), turn.inverse())),
        table: Some(TableEntry { normal: [0.6, 0.0, 0.8], height: -0.001 }),
        friction: Some(FrictionEntry {
            arm: "panda".to_string(),
            coulomb: [0.1 + 0.2; 7],
            viscous: [0.21; 7],
            offset: [-1e-3; 7],
        }),
        ..Calibration::default()
    };
    for camera in Camera::ALL {
        calibration.set_lens(camera, &real_lens(camera));
    }
    calibration
}

#[test]
fn a_file_reads_back_to_the_last_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cell.toml");
    assert_eq!(Calibration::read_or_empty(&path).unwrap(), Calibration::default());
    for calibration in [Calibration::default(), full()] {
        std::fs::write(&path, calibration.to_toml()).unwrap();
        assert_eq!(Calibration::read(&path).unwrap(), calibration);
    }
    let camera = full().camera(Camera::Wrist).unwrap();
    assert_eq!(camera.focal, real_lens(Camera::Wrist).focal);
    assert_eq!(camera.mount, Mount::Tip(full().x_tc.unwrap()));
    // A lens alone is no camera.
    let lens = Calibration { x_tc: None, ..full() };
    assert!(lens.camera(Camera::Wrist).is_none() && lens.lens_model(Camera::Wrist).is_some());
}

#[test]
fn a_bad_file_is_refused_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cell.toml");
    let good = full().to_toml();
    let refused = |from: &str, to: &str, words: &str| {
        assert!(good.contains(from), "{from}");
        std::fs::write(&path, good.replacen(from, to, 1)).unwrap();
        let error = Calibration::read(&path).unwrap_err().to_string();
        assert!(error.contains("cell.toml:") && error.contains(words), "{error}");
    };
    refused("format = \"ramp-calibration-1\"", "", "no `format`");
    refused("ramp-calibration-1", "ramp-calibration-9", "ramp-calibration-1");
    refused("[table]", "[tabel]", "`table`");
    refused("[table]", "[table", "valid TOML");
    refused("height = -0.001", "height = \"low\"", "a number from -10 to 10");
    refused("height = -0.001", "height = nan", "a number from -10 to 10");
    refused("normal = [0.6, 0.0, 0.8]", "normal = [0.6, 0.0]", "3 numbers");
    refused("normal = [0.6, 0.0, 0.8]", "normal = [0.6, 0.0, 0.9]", "length 1");
    refused("[lens.wrist]", "[lens.left]", "`left` in lens");
    refused("arm = \"panda\"", "arm = \"no name!\"", "the name of an arm");
    refused("size = [1280, 800]", "size = [0, 800]", "2 numbers from 1 to 8192");
}
