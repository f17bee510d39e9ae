//! What goes wrong on the wire, and what a client is told.

use std::time::{Duration, Instant};

use franka::{RealtimeConfig, Robot as Client, Torques};
use ramp_franka::FrankaRobot;
use ramp_robot::{ArmCommand, Command, GripperCommand, Robot, RobotError, Track};
use ramp_served_twin::{FciVersion, Pace};

use crate::served::{Served, goal_for, ideal};

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
