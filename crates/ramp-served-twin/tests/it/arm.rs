//! Motions, contacts and builds over the wire, beside the same in process.

use std::sync::OnceLock;

use nalgebra::{Translation3, Vector6};
use ramp_franka::TouchSource;
use ramp_robot::{
    Agent, ArmCommand, Command, FingerTouch, GripperCommand, Impedance, Observation, Pose, Robot, RobotError,
    Touch, Track,
};
use ramp_served_twin::{FciVersion, Pace};
use ramp_testing::robot::{Alteration, Altered};
use ramp_twin::World;

use crate::served::{SEED, Served, goal_for, ideal, real, twin};

const GRIPPER: GripperCommand = GripperCommand { width: 0.04, force: 10.0 };

/// A motion, and what is observed at its end.
type Motion = fn(&mut dyn Robot) -> Observation;

/// The share of a way at this share of its time, from rest to rest.
fn course(share: f64) -> f64 {
    let share = share.min(1.0);
    share.powi(3) * (10.0 - 15.0 * share + 6.0 * share * share)
}

/// Joint 2 and 4 move for two seconds and stand for half of one.
fn joint_motion(robot: &mut dyn Robot) -> Observation {
    let start = robot.observe().positions;
    for period in 1..=2500 {
        let course = course(f64::from(period) / 2000.0);
        let mut positions = start;
        positions[1] += 0.3 * course;
        positions[3] += 0.2 * course;
        robot.step(&Command { arm: ArmCommand::JointPositions(positions), gripper: GRIPPER }).unwrap();
    }
    robot.observe()
}

/// The tip goes down under an impedance until it presses on the table, and goes on to press.
fn press(robot: &mut dyn Robot) -> Observation {
    let start = robot.observe();
    for period in 1..=12500 {
        // Slowly: the table is 0.38 m below.
        let depth = 0.43 * course(f64::from(period) / 12000.0);
        let x_wt = Pose::from_parts(
            Translation3::from(start.x_wt.translation.vector - nalgebra::Vector3::new(0.0, 0.0, depth)),
            start.x_wt.rotation,
        );
        let impedance = Impedance {
            x_wt,
            stiffness: Vector6::new(300.0, 300.0, 300.0, 60.0, 60.0, 60.0),
            damping_ratio: 1.0,
            feed_forward: Vector6::zeros(),
            posture: start.positions,
        };
        robot.step(&Command { arm: ArmCommand::CartesianImpedance(impedance), gripper: GRIPPER }).unwrap();
    }
    robot.observe()
}

/// In process and over the wire in lock-step, the same motion ends at the same place, free and in contact.
#[test]
fn lock_step_ends_where_the_twin_in_process_does() {
    let motions: [(&str, Motion); 2] = [("joints", joint_motion), ("press", press)];
    for (name, motion) in motions {
        for (world, version) in
            [(ideal(), FciVersion::V5), (ideal(), FciVersion::V10), (real(), FciVersion::V5)]
        {
            let goal = goal_for(version, "easy-1");
            let inside = motion(&mut twin(&goal, world, Track::State));
            let served = Served::new(version, world, Track::State, Pace::LockStep);
            let over = motion(&mut served.robot(&goal, world, Track::State, Pace::LockStep));
            let off = (over.x_wt.translation.vector - inside.x_wt.translation.vector).norm();
            let force = inside.wrench.fixed_rows::<3>(0).norm();
            println!("{name} in {} by {version:?}: {:.1} nm, {force:.1} N", world.name, off * 1e9);
            assert!(off < 1e-6, "{name} in {} by {version:?}: {off:e} m", world.name);
            assert!(name != "press" || force > 5.0, "{force} N is no contact");
        }
    }
}

/// The unchanged baseline builds a goal over the wire, and twice the same in lock-step.
#[test]
fn the_baseline_builds_over_the_wire() {
    let build = || {
        let version = FciVersion::V10;
        let goal = goal_for(version, "easy-1");
        let served = Served::new(version, real(), Track::State, Pace::LockStep);
        let mut robot = served.robot(&goal, real(), Track::State, Pace::LockStep);
        goal.baseline(Track::State, SEED).run(&mut robot).unwrap();
        let (time, statistics) = (robot.observe().time, robot.statistics());
        drop(robot);
        let verdict = served.end();
        println!("{verdict:?} after {time:.3} s; {statistics:?}");
        assert_eq!(verdict.seated, verdict.pegs);
        (verdict, time)
    };
    assert_eq!(build(), build());
}

/// A driver of sensors that press more with each reading.
struct Presses(f64);

impl TouchSource for Presses {
    fn newest(&mut self) -> Option<Touch> {
        self.0 += 1.0;
        let finger = FingerTouch { force: nalgebra::Vector3::y() * self.0, centre: None };
        Some(Touch { fingers: [finger; 2] })
    }
}

/// A driver of tactile sensors stands beside the arm: every observation has its newest reading.
#[test]
fn an_arm_has_the_tactile_sensors_that_are_given_to_it() {
    let goal = goal_for(FciVersion::V5, "easy-1");
    let served = Served::new(FciVersion::V5, ideal(), Track::State, Pace::LockStep);
    let robot = served.robot(&goal, ideal(), Track::State, Pace::LockStep);
    assert!(robot.observe().touch.is_none());
    let mut robot = robot.with_touch(Box::new(Presses(0.0))).unwrap();
    let pressed = |seen: Observation| seen.touch.unwrap().fingers[0].force.y;
    let first = pressed(robot.observe());
    let arm = ArmCommand::JointPositions(robot.observe().positions);
    let stepped = robot.step(&Command { arm, gripper: GRIPPER }).unwrap();
    assert_eq!((first, pressed(stepped), pressed(robot.observe())), (1.0, 2.0, 2.0));
}

/// Keeps the forces that the fingers feel.
struct Felt(Vec<[f64; 2]>);

impl<R: Robot> Alteration<R> for &mut Felt {
    fn after(&mut self, _: &R, _: &Command, seen: &Observation) -> Result<(), RobotError> {
        self.0.push(seen.touch.unwrap().fingers.map(|finger| finger.force.y.abs()));
        Ok(())
    }
}

/// The cell of a served twin whose fingers have sensors tells what they feel while the baseline builds.
#[test]
fn a_served_twin_tells_what_its_fingers_feel() {
    static WORLD: OnceLock<World> = OnceLock::new();
    let world = WORLD.get_or_init(|| ideal().clone().with("touch.fitted", 1.0).unwrap());
    let goal = goal_for(FciVersion::V5, "easy-1");
    let served = Served::new(FciVersion::V5, world, Track::State, Pace::LockStep);
    let mut robot = served.robot(&goal, world, Track::State, Pace::LockStep);
    let mut felt = Felt(Vec::new());
    goal.baseline(Track::State, SEED).run(&mut Altered { robot: &mut robot, alteration: &mut felt }).unwrap();
    let Felt(told) = felt;
    assert!(told[..1000].iter().flatten().all(|force| *force < 1.0));
    let held = told.iter().filter(|forces| forces.iter().all(|force| *force > 5.0)).count();
    assert!(held > told.len() / 4, "{held} of {}", told.len());
    // A hundred readings a second.
    let changes = told.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert!(changes > told.len() / 40 && changes <= told.len() / 10 + 1, "{changes} of {}", told.len());
}
