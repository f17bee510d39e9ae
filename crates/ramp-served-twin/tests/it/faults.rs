//! What goes wrong on the wire, and what a client is told.

use std::time::{Duration, Instant};

use franka::{RealtimeConfig, Robot as Client, RobotState, Torques};
use nalgebra::Vector6;
use ramp_franka::{Connection, FrankaRobot};
use ramp_robot::{ArmCommand, Command, GripperCommand, Impedance, PERIOD, Robot, RobotError, Track};
use ramp_served_twin::{FciVersion, Pace};

use crate::served::{Served, goal_for, ideal, settings};

fn served(version: FciVersion, pace: Pace) -> Served {
    Served::new(version, ideal(), Track::State, pace)
}

fn client(served: &Served) -> Client {
    Client::new(&served.address.to_string(), RealtimeConfig::Ignore).unwrap()
}

/// A torque that jumps stops the arm with the controller's own name for it. After a recovery the next motion
/// runs.
#[test]
fn an_error_has_its_name_and_the_next_motion_runs_after_recovery() {
    for version in [FciVersion::V10, FciVersion::V5] {
        let served = served(version, Pace::LockStep);
        let robot = client(&served);
        let mut control = robot.start_torque_control().unwrap();
        control.read_once().unwrap();
        control.write_once(&Torques::new([0.0; 7])).unwrap();
        control.read_once().unwrap();
        control.write_once(&Torques::new([5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])).unwrap();
        let error = (0..10).find_map(|_| control.read_once().err()).unwrap().to_string();
        assert!(error.contains("controller_torque_discontinuity"), "{error}");
        drop(control);
        robot.automatic_error_recovery().unwrap();
        let mut control = robot.start_torque_control().unwrap();
        for _ in 0..50 {
            control.read_once().unwrap();
            control.write_once(&Torques::new([0.0; 7])).unwrap();
        }
        control.read_once().unwrap();
        control.write_once(&franka::motion_finished(Torques::new([0.0; 7]))).unwrap();
    }
}

/// A motion in which a row of commands is lost: the error that ends it, if one does.
fn losing(served: &Served, count: usize) -> Option<String> {
    let robot = client(served);
    let mut control = robot.start_torque_control().unwrap();
    // From here on the server does a cycle when it is told to.
    let next = served.gate.close() + 1;
    served.gate.step();
    let number = |state: &RobotState| (state.time.as_secs_f64() / PERIOD).round() as u64;
    while number(&control.read_once().unwrap().0) < next {}
    let mut cycle = |command: bool| {
        if command && let Err(error) = control.write_once(&Torques::new([0.0; 7])) {
            return Some(error.to_string());
        }
        served.gate.step();
        control.read_once().err().map(|error| error.to_string())
    };
    let commands = [(5, true), (count, false), (5, true)];
    let mut cycles = commands.into_iter().flat_map(|(count, command)| std::iter::repeat_n(command, count));
    let error = cycles.find_map(&mut cycle);
    served.gate.open();
    error
}

/// An arm bears nineteen lost commands in a row, and stops at the twentieth.
#[test]
fn the_twentieth_lost_command_stops_the_arm() {
    for version in [FciVersion::V10, FciVersion::V5] {
        for count in [1, 15, 19] {
            let error = losing(&served(version, Pace::RealTime), count);
            assert_eq!(error, None, "{count} lost by {version:?}");
        }
        for count in [20, 40] {
            let error = losing(&served(version, Pace::RealTime), count).unwrap();
            assert!(error.contains("communication_constraints_violation"), "{count} lost: {error}");
        }
    }
}

/// Moves the tip down or up for so many periods, until an error.
fn lift(robot: &mut FrankaRobot, speed: f64, periods: u32) -> Result<(), RobotError> {
    let start = robot.observe();
    for period in 1..=periods {
        let mut x_wt = start.x_wt;
        x_wt.translation.vector.z += speed * f64::from(period) * PERIOD;
        let impedance = Impedance {
            x_wt,
            stiffness: Vector6::new(600.0, 600.0, 600.0, 60.0, 60.0, 60.0),
            damping_ratio: 1.0,
            feed_forward: Vector6::zeros(),
            posture: start.positions,
        };
        let gripper = GripperCommand { width: 0.04, force: 10.0 };
        robot.step(&Command { arm: ArmCommand::CartesianImpedance(impedance), gripper })?;
    }
    Ok(())
}

/// An arm that presses on the table stops by reflex, with the name of the threshold that was passed. After a
/// recovery it moves again.
#[test]
fn a_reflex_has_its_name_and_the_next_motion_runs_after_recovery() {
    let version = FciVersion::V5;
    let goal = goal_for(version, "easy-1");
    let served = served(version, Pace::LockStep);
    let robot = |[reflex_force, reflex_torque]: [f64; 2]| {
        let connection = Connection { reflex_force, reflex_torque, ..served.connection(Pace::LockStep) };
        FrankaRobot::connect(&connection, &goal.arm, &settings(ideal()), Track::State).unwrap()
    };
    // The second motion begins while the hand still presses.
    for (thresholds, name) in [([20.0, 87.0], "cartesian_reflex"), ([100.0, 4.0], "joint_reflex")] {
        let error = lift(&mut robot(thresholds), -0.1, 6000).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
        client(&served).automatic_error_recovery().unwrap();
    }
    let mut robot = robot([100.0, 87.0]);
    let low = robot.observe().x_wt.translation.vector.z;
    lift(&mut robot, 0.1, 500).unwrap();
    let high = robot.observe().x_wt.translation.vector.z;
    assert!(high > low + 0.03, "from {low} to {high} m");
}

/// Motion generators of the arm's own controller are refused, with their name.
#[test]
fn motion_generators_are_refused_with_their_name() {
    let served = served(FciVersion::V10, Pace::LockStep);
    let robot = client(&served);
    let refused = robot.start_joint_position_control(franka::MoveControllerMode::JointImpedance);
    assert!(refused.is_err());
    let said = served.said.recv_timeout(Duration::from_secs(5)).unwrap();
    assert!(said.contains("joint positions") && said.contains("only torques"), "{said}");
}

/// A robot in real time that has held still for 200 periods; `None` if the machine was so busy that the arm
/// stopped.
fn holding(served: &Served) -> Option<(FrankaRobot, Command)> {
    let goal = goal_for(FciVersion::V10, "easy-1");
    let mut robot = served.robot(&goal, ideal(), Track::State, Pace::RealTime);
    let hold = Command {
        arm: ArmCommand::JointPositions(robot.observe().positions),
        gripper: GripperCommand { width: 0.04, force: 10.0 },
    };
    for _ in 0..200 {
        match robot.step(&hold) {
            Ok(_) => {}
            Err(error) if error.to_string().contains("communication_constraints_violation") => return None,
            Err(error) => panic!("{error}"),
        }
    }
    Some((robot, hold))
}

/// An arm that is suddenly gone in a motion is noticed, and the error stays.
#[test]
fn a_dead_arm_is_noticed() {
    let held = (0..10).find_map(|_| {
        let served = served(FciVersion::V10, Pace::RealTime);
        holding(&served).map(|held| (served, held))
    });
    let (served, (mut robot, hold)) = held.unwrap();
    served.end();
    let begin = Instant::now();
    let error = (0..1000).find_map(|_| robot.step(&hold).err()).unwrap();
    println!("told after {:?}: {error}", begin.elapsed());
    assert!(matches!(&error, RobotError::Arm { .. }), "{error}");
    assert_eq!(robot.step(&hold), Err(error), "the error stays");
}
