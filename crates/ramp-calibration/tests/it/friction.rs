//! Friction, from recordings of the twin's joints with known truth.

use ramp_calibration::friction;
use ramp_calibration::records::{JointSample, read_joints};
use ramp_robot::{ArmCommand, Command, GripperCommand, Robot};
use ramp_testing::GoalFiles;
use ramp_world::World;

/// Periods between two samples.
const EVERY: u64 = 10;

/// A recording of all joints that move together to and fro at these speeds (rad/s), each twice, in a world.
fn record(world: &World, speeds: &[f64]) -> Vec<JointSample> {
    /// Extent of the motion, rad, and time of speeding up, s.
    const EXTENT: f64 = 0.24;
    const RAMP: f64 = 0.3;
    let files = GoalFiles::new("easy-1");
    let mut twin = files.twin_in(world, 5);
    let mut samples = Vec::new();
    let mut periods = 0;
    for speed in speeds.iter().flat_map(|speed| [*speed, -speed, *speed, -speed]) {
        let duration = EXTENT / speed.abs() + RAMP;
        for step in 0..(duration * 1e3) as u64 {
            let time = step as f64 * 1e-3;
            let share = (time / RAMP).min((duration - time) / RAMP).clamp(0.0, 1.0);
            let command = Command {
                arm: ArmCommand::JointVelocities([speed * share; 7]),
                gripper: GripperCommand { width: 0.04, force: 10.0 },
            };
            let observed = twin.step(&command).unwrap();
            periods += 1;
            if periods % EVERY == 0 {
                samples.push(JointSample {
                    time: observed.time,
                    positions: observed.positions,
                    velocities: observed.velocities,
                    torques: twin.joint_report().received,
                });
            }
        }
    }
    samples
}

#[test]
fn measured_friction_of_the_twin_is_found() {
    let arm = GoalFiles::new("easy-1").arm;
    let world = World::shipped("real").unwrap();
    let truth = world.draw(5).friction;
    let samples = record(world, &[0.15, 0.4]);
    let found = friction::calibrate(&arm, &samples).unwrap();
    assert!(found.verdict().is_good(), "{:?}", found.verdict());
    let mut worst = [0.0_f64; 2];
    for (joint, it) in found.joints.iter().enumerate() {
        worst[0] = worst[0].max((it.coulomb - truth.coulomb[joint]).abs());
        worst[1] = worst[1].max((it.viscous - truth.viscous[joint]).abs());
    }
    let [residual, error] = [0, 1].map(|index| found.verdict().measures[index].value);
    eprintln!(
        "| friction, worst joint | {} samples, 100 a second | {residual:.3} N·m | {:.3} N·m, {:.3} N·m·s/rad | {error:.3} N·m |",
        samples.len(),
        worst[0],
        worst[1]
    );
    assert!(worst[0] < 0.01 && worst[1] < 0.03, "{worst:?}");

    let refused = |samples: &[JointSample], words: &str| {
        let error = friction::calibrate(&arm, samples).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    };
    refused(&samples[..40], "joint 1 moves evenly forwards in");
    let forwards: Vec<JointSample> = samples.iter().filter(|it| it.velocities[0] > 0.0).copied().collect();
    refused(&forwards, "joint 1 moves evenly backwards in 0 samples");
    let slow: Vec<JointSample> = samples.iter().filter(|it| it.velocities[0].abs() < 0.2).copied().collect();
    refused(&slow, "expected a fast motion");
    // Torques that have nothing to do with the motion.
    let mut noisy = samples;
    for (index, sample) in noisy.iter_mut().enumerate() {
        sample.torques[3] += if index % 2 == 0 { 1.0 } else { -1.0 };
    }
    assert!(!friction::calibrate(&arm, &noisy).unwrap().verdict().is_good());
}

#[test]
fn bad_recordings_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("joints.csv");
    let head: Vec<String> = std::iter::once("time".to_string())
        .chain(["q", "dq", "tau"].iter().flat_map(|name| (1..=7).map(move |joint| format!("{name}{joint}"))))
        .collect();
    let head = head.join(",");
    let row = |time: &str| format!("{time}{}", ",0.1".repeat(21));
    let read = |rows: &[String]| {
        std::fs::write(&path, format!("{head}\n{}\n", rows.join("\n"))).unwrap();
        read_joints(&path)
    };
    assert_eq!(read(&[row("0"), row("0.01")]).unwrap().len(), 2);
    for (rows, words) in [
        (vec![row("0"), row("0")], ":3: found the time 0 s after 0 s"),
        (vec![row("0"), row("inf")], ":3: found `inf`"),
        (vec![row("0") + ",1"], ":2: found 23 cells"),
    ] {
        let error = read(&rows).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}
