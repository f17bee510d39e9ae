//! Each effect of a world on its own, in the twin, against its formula: the world is `ideal` but for the
//! numbers that a test names.

use mujoco_rs::prelude::*;
use mujoco_rs::wrappers::mj_model::MjtObjBase;
use nalgebra::{DMatrix, DVector, Vector3, Vector6};
use ramp_robot::{ArmCommand, Command, DOF, GripperCommand, Impedance, Observation, Robot, RobotError};
use ramp_testing::{GoalFiles, robot};
use ramp_twin::Twin;

/// Stiffness with which the inner loop holds joint 1, N·m/rad (reference/worlds.md).
const STIFFNESS: f64 = 4000.0;
const GRIPPER: GripperCommand = GripperCommand { width: 0.04, force: 10.0 };

/// A twin in `ideal` with these numbers changed.
fn twin(changed: &[(&str, f64)]) -> Twin {
    let world = changed.iter().fold(ramp_twin::World::ideal().clone(), |world, (quantity, value)| {
        world.with(quantity, *value).unwrap()
    });
    GoalFiles::new("easy-1").twin_in(&world, 1)
}

/// Joint 1 turns by `angle` rad at 0.1 rad/s with gentle ends, and is held there for a second. Returns what
/// is seen then.
fn turn(twin: &mut Twin, angle: f64) -> Observation {
    let start = twin.observe().positions;
    let steps = (angle.abs() / 0.1 * 1e3).ceil() as u32 + 300;
    for step in 1..=steps + 1000 {
        let share = (f64::from(step) / f64::from(steps)).min(1.0);
        let mut positions = start;
        positions[0] += angle * share.powi(3) * (10.0 - 15.0 * share + 6.0 * share * share);
        twin.step(&Command { arm: ArmCommand::JointPositions(positions), gripper: GRIPPER }).unwrap();
    }
    twin.observe()
}

/// An arm that moves towards its goal stops short of it by friction over stiffness, and the more of the
/// friction its inner loop compensates, the less.
#[test]
fn a_joint_stops_short_by_friction_over_stiffness() {
    let short = |friction: f64, compensation: f64| {
        let mut twin = twin(&[
            ("friction.coulomb", friction),
            ("controller.compensation", compensation),
            ("sensing.torque_sensors", 1.0),
        ]);
        let start = twin.observe().positions[0];
        start + 0.05 - turn(&mut twin, 0.05).positions[0]
    };
    assert!(short(0.0, 0.0).abs() < 1e-6);
    for friction in [0.3, 1.1] {
        let expected = friction / STIFFNESS;
        let found = short(friction, 0.0);
        assert!((found / expected - 1.0).abs() < 0.1, "{found:e} and {expected:e}");
        let found = short(friction, 1.0);
        assert!(found.abs() < 0.1 * expected, "{found:e} of {expected:e} with compensation");
    }
}

/// A torque that grows moves a joint when it is above the friction at rest, and not before.
#[test]
fn a_joint_breaks_away_at_its_friction_at_rest() {
    let mut twin = twin(&[("friction.coulomb", 1.0), ("friction.breakaway", 0.5), ("friction.viscous", 0.0)]);
    let start = twin.observe().positions[0];
    let mut torque = 0.0;
    // Bristles give 0.3 mrad, and some times that where they are about to slip.
    while (twin.observe().positions[0] - start).abs() < 1e-3 {
        torque += 1e-3;
        assert!(torque < 3.0, "it does not move");
        let mut torques = [0.0; DOF];
        torques[0] = torque;
        twin.step(&Command { arm: ArmCommand::JointTorques(torques), gripper: GRIPPER }).unwrap();
    }
    assert!((1.45..1.6).contains(&torque), "{torque} N·m");
}

/// A command comes after the delay of the line, to the millisecond.
#[test]
fn a_command_comes_after_the_delay() {
    let began = |delay: f64| {
        let mut twin = twin(&[("line.delay", delay)]);
        let mut torques = [0.0; DOF];
        torques[0] = 5.0;
        let command = Command { arm: ArmCommand::JointTorques(torques), gripper: GRIPPER };
        (1..100).find(|_| twin.step(&command).unwrap().velocities[0].abs() > 1e-4).unwrap()
    };
    assert_eq!([0.0, 3.0, 17.0].map(|delay| began(delay) - began(0.0)), [0, 3, 17]);
}

/// Twenty lost commands in a row stop the arm; it stands for the time of its recovery, and continues the
/// motion that is commanded.
#[test]
fn lost_commands_stop_the_arm_for_its_recovery() {
    let mut twin = twin(&[("line.lost", 0.002), ("line.lost_row", 30.0), ("line.recovery", 2.0)]);
    let start = twin.observe();
    let command = Command { arm: ArmCommand::JointPositions(start.positions), gripper: GRIPPER };
    let mut stops = 0;
    let mut before = start.time;
    for _ in 0..2000 {
        let seen = twin.step(&command).unwrap();
        // A period, or a period and the time of a recovery: nothing between.
        let took = seen.time - before;
        let stopped = took > 0.5;
        let expected = if stopped { 2.001 } else { 0.001 };
        assert!((took - expected).abs() < 1e-9, "{took} s");
        stops += u32::from(stopped);
        before = seen.time;
    }
    assert!((1..8).contains(&stops), "{stops} stops");
    let moved = twin.observe().positions[0] - start.positions[0];
    assert!(moved.abs() < 1e-3, "{moved} rad");
}

/// Moves the tip by `height` m along the vertical at 0.1 m/s, with the elbow where it is.
fn press(twin: &mut Twin, height: f64) -> Result<(), RobotError> {
    let posture = twin.observe().positions;
    robot::press(twin, height, posture)
}

/// An arm that presses on the table until it stops by reflex stands for the time of its recovery, tells so,
/// and moves again from there. In a world without that time the stop is final.
#[test]
fn a_reflex_stops_the_arm_for_its_recovery_or_for_good() {
    let deep = |recovery: f64| {
        let mut twin = twin(&[("controller.reflex_force", 40.0), ("controller.recovery", recovery)]);
        let down = twin.observe().x_wt.translation.z + 0.1;
        let stopped = press(&mut twin, -down);
        (twin, stopped)
    };
    let (mut twin, stopped) = deep(2.0);
    let Err(error @ RobotError::Recovered { .. }) = stopped else { panic!("{stopped:?}") };
    assert!(!error.is_final() && error.to_string().starts_with("reflex: the external force"), "{error}");
    let [stop] = twin.stops() else { panic!("{:?}", twin.stops()) };
    assert!((stop.after - 2.0).abs() < 1e-9 && (twin.time() - stop.time - stop.after).abs() < 1e-9);
    // It holds itself, and does not press on: the command before is gone.
    let standing = twin.observe();
    assert!(standing.velocities.iter().all(|it| it.abs() < 1e-3), "{:?}", standing.velocities);
    assert!(standing.wrench.fixed_rows::<3>(0).norm() < 40.0, "{}", standing.wrench);
    assert!(twin.largest_force() >= 39.0);
    press(&mut twin, 0.05).unwrap();
    assert!(twin.observe().x_wt.translation.z > standing.x_wt.translation.z + 0.04);
    assert_eq!(twin.stops().len(), 1);

    let (mut twin, stopped) = deep(0.0);
    assert!(matches!(&stopped, Err(error @ RobotError::Reflex { .. }) if error.is_final()), "{stopped:?}");
    assert_eq!((press(&mut twin, 0.05), twin.stops().len()), (stopped, 0));
}

/// Fingers begin to move after the gripper's dead time, and their width is reported as often as the world
/// says.
#[test]
fn fingers_move_after_the_dead_time() {
    let mut twin = twin(&[("gripper.dead_time", 0.6), ("gripper.told_every", 0.001)]);
    let start = twin.observe();
    let open = Command {
        arm: ArmCommand::JointPositions(start.positions),
        gripper: GripperCommand { width: 0.07, force: 20.0 },
    };
    let began = loop {
        let seen = twin.step(&open).unwrap();
        assert!(seen.gripper_busy && seen.time < 1.0);
        if seen.width > start.width + 1e-4 {
            break seen.time - start.time;
        }
    };
    // The fingers take some milliseconds to the first tenth of a millimetre.
    assert!((0.6..0.62).contains(&began), "{began} s");
}

/// Errors of the torque sensors appear in the estimated wrench, as the wrench at the wrist that explains them
/// best, by MuJoCo's own Jacobian. Their error at the start is removed as their zero; its change in another
/// pose is not.
#[test]
fn errors_of_the_torque_sensors_are_in_the_estimated_wrench() {
    const WAVE: f64 = 0.4;
    let mut twin =
        twin(&[("sensing.wrist_sensor", 0.0), ("sensing.torque_bias", 1.0), ("sensing.torque_wave", WAVE)]);
    let start = twin.observe().positions;
    let seen = turn(&mut twin, 0.0);
    assert!(seen.wrench.fixed_rows::<3>(0).norm() < 0.05, "{}", seen.wrench);
    let seen = turn(&mut twin, 0.8);
    let off = DVector::from_fn(DOF, |joint, _| WAVE * (seen.positions[joint].sin() - start[joint].sin()));
    let mut data = MjData::new(twin.model());
    data.qpos_mut().copy_from_slice(twin.qpos());
    data.forward();
    let site = twin.model().name_to_id(MjtObjBase::mjOBJ_SITE, "wrist").unwrap();
    let (linear, angular) = data.jac_site(true, true, site);
    let columns = twin.model().nv() as usize;
    let jacobian = DMatrix::from_fn(6, DOF, |row, joint| {
        let from = if row < 3 { &linear } else { &angular };
        from[(row % 3) * columns + joint]
    });
    let expected = jacobian.transpose().svd(true, true).solve(&off, 1e-9).unwrap();
    assert!(expected.rows(0, 3).norm() > 0.2, "{expected}");
    for axis in 0..6 {
        assert!((seen.wrench[axis] - expected[axis]).abs() < 0.03, "{} and {expected}", seen.wrench);
    }
}

/// The bias of a wrist sensor appears in its reading, in the axes of the wrist.
#[test]
fn a_wrist_sensor_is_off_by_its_bias() {
    let mut ideal = twin(&[]);
    let mut off = twin(&[("sensing.force_bias", 2.0)]);
    let mean = |twin: &mut Twin| {
        let command = Command { arm: ArmCommand::JointPositions(twin.observe().positions), gripper: GRIPPER };
        (0..400).map(|_| twin.step(&command).unwrap().wrench).sum::<Vector6<f64>>() / 400.0
    };
    let found = mean(&mut off) - mean(&mut ideal);
    let force = Vector3::new(found[0], found[1], found[2]);
    // Along each of three axes; the filter takes a tenth of the time to come there.
    assert!((force.norm() / (2.0 * 3.0_f64.sqrt()) - 0.95).abs() < 0.05, "{force}");
}

/// Friction past the torque sensors leaks into the estimated wrench; friction before them does not.
#[test]
fn friction_past_the_sensors_leaks_into_the_wrench() {
    let felt = |past: f64| {
        let mut twin =
            twin(&[("sensing.wrist_sensor", 0.0), ("friction.coulomb", 1.0), ("friction.past_sensor", past)]);
        let moment_about_joint_1 = |seen: &Observation| {
            let p = seen.x_wt.translation.vector;
            // The wrist is above the tip.
            p.x * seen.wrench[1] - p.y * seen.wrench[0] + seen.wrench[5]
        };
        moment_about_joint_1(&turn(&mut twin, 0.2))
    };
    assert!(felt(0.0).abs() < 0.05, "{}", felt(0.0));
    // The rest of the joints stand, so about all of it is seen in the moment about the first.
    let leaked = felt(0.5);
    assert!((0.3..0.6).contains(&leaked.abs()), "{leaked}");
}

/// Weight that the compensation of gravity does not know pulls a soft hand down by weight over stiffness.
#[test]
fn unknown_weight_pulls_the_hand_down_by_weight_over_stiffness() {
    const MASS: f64 = 0.3;
    let mut twin = twin(&[("arm.unknown_mass", MASS), ("arm.unknown_centre", 0.0)]);
    let start = twin.observe();
    let impedance = Impedance {
        x_wt: start.x_wt,
        stiffness: Vector6::new(800.0, 800.0, 800.0, 60.0, 60.0, 60.0),
        damping_ratio: 1.0,
        feed_forward: Vector6::zeros(),
        posture: start.positions,
    };
    let command = Command { arm: ArmCommand::CartesianImpedance(impedance), gripper: GRIPPER };
    for _ in 0..2000 {
        twin.step(&command).unwrap();
    }
    let found = start.x_wt.translation.z - twin.observe().x_wt.translation.z;
    let expected = MASS * 9.81 / 800.0;
    assert!((found / expected - 1.0).abs() < 0.1, "{found} and {expected}");
}

/// Reported joint positions have the offsets as errors, and the arm computes its tip from them.
#[test]
fn told_positions_are_off() {
    let twin = twin(&[("arm.offset", 2e-3)]);
    let seen = twin.observe();
    for joint in 0..DOF {
        assert!((seen.positions[joint] - twin.qpos()[joint] - 2e-3).abs() < 1e-12);
    }
    let really = GoalFiles::new("easy-1").twin_in(ramp_twin::World::ideal(), 1).observe();
    assert!((seen.x_wt.translation.vector - really.x_wt.translation.vector).norm() > 0.5e-3);
}

/// The tip that the arm reports is where its joints have it, also while it moves.
#[test]
fn the_tip_belongs_to_the_joint_positions_of_the_same_period() {
    let world = GoalFiles::new("easy-1");
    let kinematics = ramp_motion::Kinematics::new(&world.arm);
    let mut twin = twin(&[("arm.offset", 2e-3)]);
    for period in 0..400 {
        let speed = 0.5 * (f64::from(period) / 200.0).min(1.0);
        let command = Command { arm: ArmCommand::JointVelocities([speed; DOF]), gripper: GRIPPER };
        let seen = twin.step(&command).unwrap();
        let tip = kinematics.tip(&seen.positions.into());
        let off = (tip.translation.vector - seen.x_wt.translation.vector).norm();
        assert!(off < 1e-9, "{off:e} m after {period} periods");
    }
}
