//! `ramp calibrate`, as a person calls it.

use std::path::Path;
use std::process::Output;

use ramp_robot::Camera;
use ramp_robot::camera::ImageWidth;
use ramp_testing::calibration::{Cell, View, all_around, real_lens};
use ramp_testing::program::{run, text, words};

fn ramp(folder: &Path, arguments: &[&str]) -> Output {
    run(env!("CARGO_BIN_EXE_ramp"), folder, &[&["calibrate"], arguments].concat())
}

/// The command prints its verdict and has this exit status.
#[track_caller]
fn ends(output: &Output, status: i32, expected: &str) {
    let all = words(&output.stdout) + &words(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{all}");
    assert!(all.contains(expected), "{all}");
}

#[test]
fn a_cell_is_calibrated_into_one_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let cell = Cell::new();
    let wrist = real_lens(Camera::Wrist).with_width(ImageWidth::new(640).unwrap());
    let views = all_around(7, 1, [0.16, 0.3]);
    std::fs::create_dir(at.join("wrist")).unwrap();
    cell.write_images(&wrist, &views, &at.join("wrist"));
    cell.write_poses(&wrist, &views, [0.0; 2], &at.join("wrist"));

    // The lens comes first.
    ends(&ramp(at, &["hand-eye", "wrist", "-o", "cell.toml"]), 2, "holds no lens of the camera `wrist`");
    let output = ramp(at, &["lens", "wrist", "-o", "cell.toml"]);
    ends(&output, 0, "verdict: good enough; written to cell.toml");
    assert!(text(&output.stdout).contains("from 7 images of 640 × 400 pixels"), "{}", text(&output.stdout));
    ends(&ramp(at, &["hand-eye", "wrist", "-o", "cell.toml"]), 0, "verdict: good enough");
    std::fs::write(at.join("touches.csv"), "x,y,z\n0.1,0.2,0\n0.6,0.2,0\n0.6,0.6,0\n").unwrap();
    ends(&ramp(at, &["table", "touches.csv", "-o", "cell.toml"]), 0, "three points leave no residual");

    let overhead = real_lens(Camera::BirdsEye);
    cell.write_birds_eye(&overhead, &at.join("table.png"));
    let before = std::fs::read_to_string(at.join("cell.toml")).unwrap();
    let lens = format!(
        "{before}\n[lens.birds-eye]\nsize = [{}, {}]\nfocal = {:?}\ncentre = {:?}\ndistortion = {:?}\n",
        overhead.width, overhead.height, overhead.focal, overhead.centre, overhead.distortion
    );
    std::fs::write(at.join("cell.toml"), lens).unwrap();
    ends(&ramp(at, &["birds-eye", "table.png", "-o", "cell.toml"]), 0, "with the tags [0, 13, 14]");
    let file = std::fs::read_to_string(at.join("cell.toml")).unwrap();
    for section in ["[lens.wrist]", "[lens.birds-eye]", "[hand-eye]", "[birds-eye]", "[table]"] {
        assert!(file.contains(section), "{file}");
    }

    // Poor data, and files that are no recording, leave the file as it was.
    let unchanged = || assert_eq!(std::fs::read_to_string(at.join("cell.toml")).unwrap(), file);
    std::fs::write(at.join("touches.csv"), "x,y,z\n0.1,0.2,0\n0.6,0.2,0\n0.6,0.6,0\n0.1,0.6,0.004\n")
        .unwrap();
    let output = ramp(at, &["table", "touches.csv", "-o", "cell.toml"]);
    ends(&output, 1, "verdict: not good enough; nothing was written");
    unchanged();
    std::fs::write(at.join("touches.csv"), "x,y,z\n0.1,0.1,0\n0.2,0.2,0\n0.3,0.3,0\n").unwrap();
    ends(&ramp(at, &["table", "touches.csv", "-o", "cell.toml"]), 2, "the touched points lie on a line");
    std::fs::write(at.join("touches.csv"), "x,y,z\n0.1,0.1,zero\n").unwrap();
    ends(&ramp(at, &["table", "touches.csv", "-o", "cell.toml"]), 2, "touches.csv:2: found `zero`");
    let flat: Vec<View> = views.iter().map(|view| View { tilt: 0.0, azimuth: 0.0, ..*view }).collect();
    cell.write_images(&wrist, &flat, &at.join("wrist"));
    cell.write_poses(&wrist, &flat, [0.0; 2], &at.join("wrist"));
    ends(&ramp(at, &["lens", "wrist", "-o", "cell.toml"]), 2, "from one direction");
    ends(&ramp(at, &["hand-eye", "wrist", "-o", "cell.toml"]), 2, "about one axis only");
    std::fs::write(at.join("wrist/03.png"), "no image").unwrap();
    ends(&ramp(at, &["lens", "wrist", "-o", "cell.toml"]), 2, "03.png: cannot be read as PNG");
    std::fs::write(at.join("joints.csv"), "time,q1\n").unwrap();
    ends(&ramp(at, &["friction", "joints.csv", "-o", "cell.toml"]), 2, "joints.csv:1: found `time,q1`");
    ends(&ramp(at, &["lens", "no-folder", "-o", "cell.toml"]), 2, "no-folder cannot be read");
    unchanged();
    assert!(!at.join("new.toml").exists());
    std::fs::write(at.join("broken.toml"), "format = 1\n").unwrap();
    ends(&ramp(at, &["table", "touches.csv", "-o", "broken.toml"]), 2, "broken.toml:1:");
}
