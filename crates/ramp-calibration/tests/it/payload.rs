//! The payload, from torques of the twin at rest with known truth.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use ramp_calibration::payload::{self, Payload};
use ramp_calibration::records::{RestSample, read_rests};
use ramp_robot::random::Stream;
use ramp_robot::{ArmCommand, Command, DOF, GripperCommand, Robot};
use ramp_testing::GoalFiles;
use ramp_world::World;

/// The arm at rest in poses around home, reached by slow motions, in this world.
fn record(world: &World, poses: usize) -> Vec<RestSample> {
    /// Time of a motion and of the rest after it, ms, and the part of the rest that is recorded.
    const MOTION: u32 = 1500;
    const REST: u32 = 600;
    const RECORDED: u32 = 200;
    let files = GoalFiles::new("easy-1");
    let mut twin = files.twin_in(world, 5);
    let mut stream = Stream::new(5, "payload-poses");
    let mut from = twin.observe().positions;
    let home = from;
    let mut samples = Vec::new();
    for _ in 0..poses {
        // Tilts of the hand and turns of the arm, well above the table.
        let range = [0.6, 0.2, 0.4, 0.2, 0.6, 0.5, 1.0];
        let to: [f64; DOF] =
            std::array::from_fn(|joint| home[joint] + range[joint] * (2.0 * stream.uniform() - 1.0));
        let mut sum = RestSample { positions: [0.0; DOF], torques: [0.0; DOF] };
        for step in 0..MOTION + REST {
            let share = (f64::from(step + 1) / f64::from(MOTION)).min(1.0);
            let smooth = share * share * share * (10.0 - share * (15.0 - 6.0 * share));
            let positions = std::array::from_fn(|joint| from[joint] + smooth * (to[joint] - from[joint]));
            let gripper = GripperCommand { width: 0.0, force: 10.0 };
            let seen = twin.step(&Command { arm: ArmCommand::JointPositions(positions), gripper }).unwrap();
            if step >= MOTION + REST - RECORDED {
                let weight = twin.joint_report().weight;
                for joint in 0..DOF {
                    sum.positions[joint] += seen.positions[joint] / f64::from(RECORDED);
                    sum.torques[joint] += (seen.torques[joint] + weight[joint]) / f64::from(RECORDED);
                }
            }
        }
        samples.push(sum);
        from = to;
    }
    samples
}

/// The hand of the arm file, with what the world's arm carries unknown to its controller.
fn truth(world: &World) -> (f64, Vector3<f64>) {
    let arm = GoalFiles::new("easy-1").arm;
    let (mass, centre) = payload::of_arm_file(&arm);
    let unknown = world.draw(5).arm;
    // The world tells its centre in the hand's frame, which has the flange's origin.
    let [w, x, y, z] = arm.hand.quat_wxyz;
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
    let other = turn * Vector3::from(unknown.unknown_centre);
    let all = mass + unknown.unknown_mass;
    (all, (mass * centre + unknown.unknown_mass * other) / all)
}

#[test]
fn measured_payload_of_the_twin_is_found() {
    let arm = GoalFiles::new("easy-1").arm;
    let world = World::shipped("real").unwrap().with("arm.unknown_mass", 0.2).unwrap();
    let samples = record(&world, 12);
    let found: Payload = payload::calibrate(&arm, &samples).unwrap();
    let (mass, centre) = truth(&world);
    let off = [(found.mass - mass).abs(), (found.centre - centre).norm()];
    eprintln!(
        "| payload in world `real`, 0.2 kg more than the hand | {} poses | {:.3} N·m | {:.3} kg, {:.1} mm | {:.3} kg, {:.1} mm |",
        found.poses,
        found.residual,
        off[0],
        off[1] * 1e3,
        found.errors[0],
        found.errors[1] * 1e3
    );
    assert!(found.verdict().is_good(), "{:?}", found.verdict());
    assert!(off[0] < 0.05 && off[1] < 0.008, "{off:?}");

    let error = payload::calibrate(&arm, &samples[..7]).unwrap_err().to_string();
    assert!(error.contains("found 7 poses at rest"), "{error}");
    let error = payload::calibrate(&arm, &[samples[0]; 12]).unwrap_err().to_string();
    assert!(error.contains("do not tell the payload"), "{error}");
    // Torques of other poses.
    let mut mixed = samples.clone();
    for (index, sample) in mixed.iter_mut().enumerate() {
        sample.torques = samples[(index + 1) % samples.len()].torques;
    }
    assert!(!payload::calibrate(&arm, &mixed).unwrap().verdict().is_good());
}

#[test]
fn bad_tables_of_rests_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rests.csv");
    let columns = ["q", "tau"].iter().flat_map(|name| (1..=7).map(move |joint| format!("{name}{joint}")));
    let head = columns.collect::<Vec<_>>().join(",");
    std::fs::write(&path, format!("{head}\n0{}\n", ",0.1".repeat(13))).unwrap();
    assert_eq!(read_rests(&path).unwrap().len(), 1);
    std::fs::write(&path, format!("{head}\n0{},nan\n", ",0.1".repeat(12))).unwrap();
    let error = read_rests(&path).unwrap_err().to_string();
    assert!(error.contains(":2: found `nan`"), "{error}");
}
