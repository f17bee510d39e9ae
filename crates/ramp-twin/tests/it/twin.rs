//! The twin as a robot: limits, refused commands, and that only contact moves a part.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use mujoco_rs::prelude::*;
use nalgebra::Vector6;
use ramp_robot::{ArmCommand, Command, GripperCommand, Impedance, Pose, Robot, RobotError, Track};
use ramp_testing::GoalFiles;
use ramp_twin::Twin;

fn stay(twin: &Twin) -> Command {
    let seen = twin.observe();
    Command {
        arm: ArmCommand::JointPositions(seen.positions),
        gripper: GripperCommand { width: seen.width, force: 20.0 },
    }
}

/// No weld, no equality, no mocap, no tendon: nothing in the model could hold parts together but contact, and
/// no actuator acts on a part.
#[test]
fn the_model_has_nothing_that_could_hold_parts_together() {
    let world = GoalFiles::new("easy-3");
    let twin = world.twin(Track::State, 1);
    let model = twin.model().ffi();
    assert_eq!(model.neq, 0, "equality constraints");
    assert_eq!(model.nmocap, 0, "mocap bodies");
    assert_eq!(model.ntendon, 0, "tendons");
    assert_eq!(model.nflex, 0, "flexes");
    // Seven joints and two fingers, and a free joint for each of eight beams and fifteen pegs.
    assert_eq!(model.nu, 9);
    assert_eq!(model.njnt, 9 + 8 + 15);
    for actuator in 0..9 {
        let joint = twin.model().actuator_trnid()[actuator][0];
        assert!((0..9).contains(&joint), "actuator {actuator} acts on joint {joint}");
    }
}

/// The only writes to MuJoCo's state outside the constructor are the actuators' commands, and the torques
/// that brake or load the arm's own joints: `twin.rs` writes in the constructor alone, `period.rs` only
/// these.
#[test]
fn the_code_writes_only_commands_after_the_start() {
    let twin = include_str!("../../src/twin.rs");
    let constructor = twin.find("pub fn new(").unwrap()..twin.find("/// The scene as MJCF,").unwrap();
    for (at, _) in twin.match_indices("_mut()") {
        let call = twin[..at].rsplit('.').next().unwrap();
        assert!(constructor.contains(&at), "writes to {call} after the start");
    }
    let period = include_str!("../../src/period.rs");
    for (at, _) in period.match_indices("_mut()") {
        let call = period[..at].rsplit('.').next().unwrap();
        let joints_only = call == "qfrc_applied" && period[at..].starts_with("_mut()[..DOF]");
        assert!(call == "ctrl" || joints_only, "writes to {call} after the start");
    }
    for (name, source) in [("twin.rs", twin), ("period.rs", period)] {
        for word in ["xfrc_applied", "mocap", "set_state", "reset", "ffi_mut", "unsafe"] {
            assert!(!source.contains(word), "{word} in {name}");
        }
    }
}

/// The sources below a folder of `src`, with their paths.
fn sources(folder: &str) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let text = std::fs::read_to_string(&path).unwrap();
                found.push((path, text));
            }
        }
    }
    found
}

/// A fault acts by forces alone, whichever of its files the code is in.
#[test]
fn the_code_of_faults_writes_only_forces() {
    let files = sources("fault");
    assert!(files.iter().any(|(_, source)| source.contains("xfrc_applied_mut()[")));
    for (path, source) in files {
        for (at, _) in source.match_indices("_mut()[") {
            let call = source[..at].rsplit('.').next().unwrap();
            assert_eq!(call, "xfrc_applied", "{} writes to {call}", path.display());
        }
        for word in ["qpos_mut", "qvel_mut", "mocap", "set_state", "reset", "ffi_mut", "unsafe"] {
            assert!(!source.contains(word), "{word} in {}", path.display());
        }
        // A snapshot alone may take the place of the whole state.
        assert!(!source.contains("copy_to") || path.ends_with("twin/snapshot.rs"), "{}", path.display());
    }
}

/// No other file of the twin writes to the physics at all. The live window has a copy of the state to show.
#[test]
fn nothing_else_writes_to_the_physics() {
    for (path, source) in sources("") {
        let fault = path.components().any(|part| part.as_os_str() == "fault");
        // The referee's look without the arm changes a copy.
        if path.ends_with("src/rest.rs") {
            let written = source.matches("_mut()").count() - source.matches("moments.last_mut()").count();
            assert_eq!(written, source.matches("    copy.").count(), "writes to more than the copy");
            assert!(source.contains("let mut copy = data.clone();") && !source.contains("ffi_mut"));
            continue;
        }
        // A twin with a rigid frame is a new one, and no episode makes it.
        if path.ends_with("src/twin/rigid.rs") {
            assert!(source.contains("let mut data = MjData::new") && !source.contains("ffi_mut"));
            assert!(!source.contains("self.data.qpos_mut") && !source.contains("self.data.qvel_mut"));
            for judged in ["ramp-episode", "ramp-abilities", "ramp-cli", "ramp-external-agent"] {
                let uses = |(_, text): &(PathBuf, String)| text.contains("with_rigid");
                assert!(!sources(&format!("../../{judged}/src")).iter().any(uses), "{judged}");
            }
            continue;
        }
        // The clamp moves the beam that it holds, and nothing else.
        if path.ends_with("src/clamp.rs") {
            let places = ["data.xpos_mut()[*body]", "data.xipos_mut()[*body]", "data.geom_xpos_mut()[*geom]"];
            let moved = places.iter().map(|place| source.matches(place).count()).sum::<usize>();
            assert_eq!((moved, source.matches("_mut()").count()), (3, 3));
            continue;
        }
        if fault || ["src/twin.rs", "src/period.rs", "src/view.rs"].iter().any(|file| path.ends_with(file)) {
            continue;
        }
        for word in ["qpos_mut", "qvel_mut", "ctrl_mut", "_applied", "mocap", "set_state", "ffi_mut"] {
            // The step itself, and what would wake a part: read alone.
            let step = path.ends_with("src/broad_phase.rs")
                && match word {
                    "ffi_mut" => source.matches(word).count() == 1,
                    "_applied" => !source.contains("_applied_mut"),
                    _ => false,
                };
            assert!(step || !source.contains(word), "{word} in {}", path.display());
        }
    }
}

/// Everything that happens follows from the start and the actuators' commands: MuJoCo alone, given the same
/// commands, ends in the same state to the last bit.
#[test]
fn commands_alone_move_the_world() {
    let world = GoalFiles::new("easy-3");
    let mut twin = world.twin(Track::State, 3);
    let model = MjModel::from_xml_string(twin.scene()).unwrap();
    let mut data = MjData::new(&model);
    data.qpos_mut().copy_from_slice(twin.qpos());
    data.forward();
    let start = twin.observe();
    for tick in 0..1500 {
        let mut positions = start.positions;
        positions[1] += 0.1 * (1.0 - (f64::from(tick) * 0.002).cos());
        let command = Command {
            arm: ArmCommand::JointPositions(positions),
            gripper: GripperCommand { width: 0.06, force: 20.0 },
        };
        twin.step(&command).unwrap();
        data.ctrl_mut().copy_from_slice(twin.ctrl());
        data.step();
    }
    let same = twin.qpos().iter().zip(data.qpos()).all(|(a, b)| a.to_bits() == b.to_bits());
    assert!(same, "the twin did something that its commands do not explain");
}

/// Bodies that the twin leaves out of the search for contacts touch nothing: MuJoCo alone, which considers
/// all bodies, ends in the same state to the last bit, also if the hand sweeps through sleeping parts.
#[test]
fn parts_that_are_swept_away_move_as_in_mujoco_alone() {
    let world = GoalFiles::new("easy-3");
    let mut twin = world.twin(Track::State, 3);
    let model = MjModel::from_xml_string(twin.scene()).unwrap();
    let mut data = MjData::new(&model);
    data.qpos_mut().copy_from_slice(twin.qpos());
    data.forward();
    let (seen, before) = (twin.observe(), twin.truth());
    for tick in 0..3500 {
        let time = f64::from(tick) * 1e-3;
        let mut x_wt = seen.x_wt;
        x_wt.translation.x += 0.15 * time.min(1.0);
        x_wt.translation.z += (0.03 - x_wt.translation.z) * time.min(1.0);
        x_wt.translation.y += 0.25 * (2.0 * (time - 1.0).max(0.0)).sin();
        let impedance = Impedance {
            x_wt,
            stiffness: Vector6::new(500.0, 500.0, 500.0, 30.0, 30.0, 30.0),
            damping_ratio: 1.0,
            feed_forward: Vector6::zeros(),
            posture: seen.positions,
        };
        let arm = ArmCommand::CartesianImpedance(impedance);
        twin.step(&Command { arm, gripper: GripperCommand { width: 0.06, force: 20.0 } }).unwrap();
        data.ctrl_mut().copy_from_slice(twin.ctrl());
        data.step();
    }
    let moved = |(a, b): (&Pose, &Pose)| (a.translation.vector - b.translation.vector).norm() > 0.01;
    let swept = twin.truth().x_wp.iter().zip(&before.x_wp).filter(|it| moved(*it)).count();
    assert!(swept >= 1, "the hand met {swept} parts");
    let same = twin.qpos().iter().zip(data.qpos()).all(|(a, b)| a.to_bits() == b.to_bits());
    assert!(same, "a contact was left out");
}

/// A target that jumps would throw the arm: a real controller refuses it, and says which joint it was.
#[test]
fn targets_that_no_motion_could_follow_are_refused() {
    let world = GoalFiles::new("easy-3");
    let gripper = GripperCommand { width: 0.06, force: 20.0 };
    let after = |command: ArmCommand| {
        let mut twin = world.twin(Track::State, 1);
        twin.step(&stay(&twin)).unwrap();
        twin.step(&Command { arm: command, gripper }).unwrap_err().to_string()
    };
    let start = world.twin(Track::State, 1).observe();
    let mut positions = start.positions;
    positions[2] += 1e-4;
    let message = after(ArmCommand::JointPositions(positions));
    assert!(message.starts_with("the commanded acceleration of joint 3 is 100.000 rad/s²"), "{message}");
    let mut x_wt = start.x_wt;
    x_wt.translation.z += 0.02;
    let message = after(ArmCommand::CartesianPose(x_wt));
    assert!(message.starts_with("the commanded first step of the tip is 0.020 m"), "{message}");
}

/// A target that gains speed takes the tip along on its line: the arm's mass, which is not the same in all
/// directions, does not push it aside.
#[test]
fn a_target_that_gains_speed_does_not_pull_the_tip_aside() {
    let world = GoalFiles::new("easy-3");
    let mut twin = world.twin(Track::State, 1);
    let start = twin.observe();
    let (mut way, mut aside) = (0.0, 0.0_f64);
    for period in 0..600 {
        // 3 m/s² up to 0.05 m/s, as an insertion begins.
        way += (3.0 * f64::from(period) * 1e-3).min(0.05) * 1e-3;
        let mut x_wt = start.x_wt;
        x_wt.translation.y += way;
        let impedance = Impedance {
            x_wt,
            stiffness: nalgebra::Vector6::new(1500.0, 1500.0, 1500.0, 60.0, 60.0, 60.0),
            damping_ratio: 1.0,
            feed_forward: nalgebra::Vector6::zeros(),
            posture: start.positions,
        };
        let arm = ArmCommand::CartesianImpedance(impedance);
        let seen = twin.step(&Command { arm, gripper: GripperCommand { width: 0.06, force: 20.0 } }).unwrap();
        let off = seen.x_wt.translation.vector - x_wt.translation.vector;
        aside = aside.max(off.norm());
    }
    assert!(aside < 0.5e-3, "{:.2} mm", aside * 1e3);
}

#[test]
fn parts_rest_where_they_start() {
    let world = GoalFiles::new("easy-3");
    let mut twin = world.twin(Track::State, 2);
    let before = twin.truth();
    let command = stay(&twin);
    for _ in 0..1000 {
        twin.step(&command).unwrap();
    }
    let after = twin.truth();
    for (index, name) in twin.part_names().enumerate() {
        let moved = (after.x_wp[index].translation.vector - before.x_wp[index].translation.vector).norm();
        assert!(moved < 0.1e-3, "{name} moved by {:.3} mm", moved * 1e3);
    }
    assert!(twin.deepest_penetration() < 0.1e-3);
}

/// Pressed on the table the wrench points down; in free air it is zero but for noise.
#[test]
fn the_wrist_feels_what_the_hand_does_to_the_world() {
    let world = GoalFiles::new("easy-3");
    let mut twin = world.twin(Track::State, 1);
    let start = twin.observe();
    let mut x_wt = start.x_wt;
    let mut press = |twin: &mut Twin, z: f64, ticks: usize| {
        for _ in 0..ticks {
            let step = (z - x_wt.translation.z).clamp(-1e-4, 1e-4);
            x_wt.translation.z += step;
            let impedance = Impedance {
                x_wt,
                stiffness: nalgebra::Vector6::new(1500.0, 1500.0, 1500.0, 60.0, 60.0, 60.0),
                damping_ratio: 1.0,
                feed_forward: nalgebra::Vector6::zeros(),
                posture: start.positions,
            };
            twin.step(&Command {
                arm: ArmCommand::CartesianImpedance(impedance),
                gripper: GripperCommand { width: 0.0, force: 20.0 },
            })
            .unwrap();
        }
        twin.observe()
    };
    let free = press(&mut twin, start.x_wt.translation.z, 800);
    assert!(free.wrench.fixed_rows::<3>(0).norm() < 1.0, "{}", free.wrench);
    // Straight down from where the arm starts there is only the table.
    let down = press(&mut twin, -0.01, 8000);
    assert!(down.wrench[2] < -5.0, "{}", down.wrench);
    assert!(down.x_wt.translation.z > -0.001 - 0.001);
}

#[test]
fn commands_that_are_not_numbers_are_refused_and_nothing_moves() {
    let world = GoalFiles::new("easy-3");
    let gripper = GripperCommand { width: 0.04, force: 20.0 };
    let bad = [
        Command { arm: ArmCommand::JointPositions([f64::NAN; 7]), gripper },
        Command { arm: ArmCommand::JointTorques([f64::INFINITY; 7]), gripper },
        Command {
            arm: ArmCommand::JointVelocities([0.0; 7]),
            gripper: GripperCommand { width: -1.0, force: 20.0 },
        },
        Command {
            arm: ArmCommand::JointVelocities([0.0; 7]),
            gripper: GripperCommand { width: 0.04, force: f64::NAN },
        },
    ];
    for command in bad {
        let mut twin = world.twin(Track::State, 1);
        let before = twin.state_hash();
        let error = twin.step(&command).unwrap_err();
        assert!(matches!(error, RobotError::BadCommand { .. }), "{error}");
        assert_eq!(before, twin.state_hash());
        // The robot has stopped for good.
        let good = stay(&twin);
        assert_eq!(twin.step(&good).unwrap_err(), error);
    }
}

#[test]
fn torques_stay_within_the_arms_and_a_broken_limit_stops_it() {
    let world = GoalFiles::new("easy-3");
    let mut twin = world.twin(Track::State, 1);
    let mut stopped = None;
    for _ in 0..3000 {
        let command = Command {
            arm: ArmCommand::JointTorques([1e12; 7]),
            gripper: GripperCommand { width: 0.04, force: 20.0 },
        };
        match twin.step(&command) {
            Ok(seen) => {
                for (torque, joint) in seen.torques.iter().zip(&world.arm.joints) {
                    assert!(torque.abs() <= joint.torque);
                }
            }
            Err(error) => {
                stopped = Some(error);
                break;
            }
        }
    }
    assert!(
        matches!(stopped, Some(RobotError::JointVelocity { .. } | RobotError::JointPosition { .. })),
        "{stopped:?}"
    );
}

/// A part in the hand falls when the arm is gone, and all others stay; the twin itself does not change.
#[test]
fn the_world_without_the_arm_is_a_copy() {
    let world = GoalFiles::new("easy-3");
    let setup = world.setup(Track::State, 1);
    let mut layout = ramp_twin::Layout::new(setup.assembly, setup.start, setup.seed);
    // The ribs of the fingertips are in the slots of its head from the start.
    let upright = nalgebra::UnitQuaternion::from_axis_angle(&nalgebra::Vector3::x_axis(), PI);
    let middle = Pose::translation(0.0, 0.0, -ramp_kit::joint::HEAD_HEIGHT / 2.0);
    let (_, x_wp) = layout.pegs.iter_mut().find(|(name, _)| name == "p1").unwrap();
    *x_wp = world.twin(Track::State, 1).observe().x_wt * upright * middle;
    let mut twin = Twin::with_layout(&setup, layout).unwrap();
    twin.settle(600).unwrap();
    let before = (twin.state_hash(), twin.truth());
    let peg = twin.part_names().position(|name| name == "p1").unwrap();
    assert!(before.1.x_wp[peg].translation.z > 0.3, "the hand does not hold the peg");
    let after = twin.without_arm(1.0, 100);
    assert_eq!(after.len(), 10);
    let after = &after[9].truth;
    assert!(after.x_wp[peg].translation.z < 0.1, "{}", after.x_wp[peg].translation.z);
    for (part, (before, after)) in before.1.x_wp.iter().zip(&after.x_wp).enumerate() {
        let moved = (before.translation.vector - after.translation.vector).norm();
        assert!(part == peg || moved < 1e-4, "part {part} moves by {moved}");
    }
    assert_eq!((twin.state_hash(), twin.truth()), before);
}

/// While an image or the reading of a noisy track takes its time, moments go on every 10 ms.
#[test]
fn moments_are_recorded_within_calls() {
    let world = GoalFiles::new("easy-1");
    let mut twin = world.twin(Track::Noisy, 1);
    twin.record_moments(10);
    for _ in 0..4 {
        twin.read_parts().unwrap();
    }
    let times: Vec<f64> = twin.moments().iter().map(|it| (it.truth.time * 1e3).round()).collect();
    let expected: Vec<f64> = (1..=13).map(|index| f64::from(index) * 10.0).collect();
    assert_eq!(times, expected);
    assert!(twin.moments().is_empty());
}
