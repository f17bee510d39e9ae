//! Images over the wire, beside those in process.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;

use ramp_robot::{
    ArmCommand, Camera, Command, GripperCommand, Image, ImageWidth, Observation, Robot, RobotError, Track,
};
use ramp_served_twin::{FciVersion, Pace};

use crate::served::{Served, goal_for, real, twin};

/// The widths of images: a camera's own, and a small one.
fn widths() -> [Option<ImageWidth>; 2] {
    [None, ImageWidth::new(224)]
}

/// Moves two joints for 0.3 s, and takes images of both cameras at the end: the shutters open and the image
/// comes while the arm stands.
fn move_and_look(robot: &mut dyn Robot) -> (Observation, Vec<Image>) {
    let start = robot.observe().positions;
    let gripper = GripperCommand { width: 0.04, force: 10.0 };
    let mut command = Command { arm: ArmCommand::JointPositions(start), gripper };
    for period in 1..=300 {
        let share = f64::from(period) / 300.0;
        let mut positions = start;
        positions[0] += 0.05 * share * share * (3.0 - 2.0 * share);
        positions[3] -= 0.05 * share * share * (3.0 - 2.0 * share);
        command.arm = ArmCommand::JointPositions(positions);
        robot.step(&command).unwrap();
    }
    let seen = robot.observe();
    let mut images = Vec::new();
    for camera in Camera::ALL {
        for width in widths() {
            images.push(robot.look_sized(camera, width).unwrap());
        }
    }
    (seen, images)
}

/// In lock-step, an image over the wire has exactly the pixels, the time and the pose of the one in process.
#[test]
fn images_over_the_wire_are_those_in_process() {
    let version = FciVersion::V5;
    let goal = goal_for(version, "easy-1");
    let (inside, images) = move_and_look(&mut twin(&goal, real(), Track::Tags));
    let served = Served::new(version, real(), Track::Tags, Pace::LockStep);
    let (over, wired) = move_and_look(&mut served.robot(&goal, real(), Track::Tags, Pace::LockStep));
    assert_eq!(over.positions, inside.positions);
    for (image, over) in images.iter().zip(&wired) {
        let name = format!("{} of {} pixels", image.camera.name(), image.width);
        assert_eq!((over.camera, over.width, over.height), (image.camera, image.width, image.height));
        assert!((over.time - image.time).abs() < 1e-9, "{name}: {} s, {} s", over.time, image.time);
        assert!((over.x_wt.translation.vector - image.x_wt.translation.vector).norm() < 1e-9, "{name}");
        let others = image.pixels.iter().zip(&over.pixels).filter(|(one, other)| one != other).count();
        assert_eq!(others, 0, "{name}: bytes that differ");
    }
    assert_eq!(wired[1].width, 224);
}

/// On `tags` poses of parts are refused, as in process.
#[test]
fn poses_of_parts_are_refused_on_tags() {
    let version = FciVersion::V5;
    let served = Served::new(version, real(), Track::Tags, Pace::LockStep);
    let goal = goal_for(version, "easy-1");
    let mut robot = served.robot(&goal, real(), Track::State, Pace::LockStep);
    let Err(RobotError::Arm { what }) = robot.read_parts() else { panic!() };
    assert!(what.contains("tags"), "{what}");
}

/// Questions that cannot be are refused by name, and the connection goes on.
#[test]
fn bad_questions_are_refused() {
    let served = Served::new(FciVersion::V5, real(), Track::Tags, Pace::RealTime);
    let cell = served.connection(Pace::RealTime).cell.unwrap();
    let mut stream = BufReader::new(TcpStream::connect(cell).unwrap());
    for (question, word) in [
        (r#"{"ask": "image", "camera": "wrist", "width": 8}"#, "expected 16 to"),
        (r#"{"ask": "image", "camera": "wrist", "width": -1}"#, "-1"),
        (r#"{"ask": "image", "camera": "nose"}"#, "nose"),
        (r#"{"ask": "truth"}"#, "truth"),
        ("{", "EOF"),
        (r#"{"ask": "parts"}"#, "tags"),
    ] {
        stream.get_mut().write_all(format!("{question}\n").as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_line(&mut answer).unwrap();
        assert!(answer.contains("refused") && answer.contains(word), "{question}: {answer}");
    }
}
