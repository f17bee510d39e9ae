//! The limits of the arm's acceleration hold whatever is commanded after what: no kind of command, no look
//! and no first target is a way around them.

use std::f64::consts::PI;

use nalgebra::Translation3;
use ramp_motion::{Checker, Kinematics};
use ramp_robot::random::Stream;
use ramp_robot::{ArmCommand, Camera, Command, DOF, GripperCommand, PERIOD, Pose, Robot};
use ramp_testing::GoalFiles;
use ramp_twin::{Twin, World};

/// A robot whose joints' accelerations are measured.
struct Measured {
    twin: Twin,
    /// The largest accelerations of the joints over five periods, as shares of their limits.
    largest: [f64; DOF],
    before: Vec<[f64; DOF]>,
}

impl Measured {
    fn new(goal: &GoalFiles, world: &'static World) -> Measured {
        Measured { twin: goal.twin_in(world, 1), largest: [0.0; DOF], before: Vec::new() }
    }

    fn step(&mut self, goal: &GoalFiles, arm: ArmCommand) {
        let gripper = GripperCommand { width: 0.04, force: 20.0 };
        let seen = self.twin.step(&Command { arm, gripper }).unwrap();
        self.note(goal, seen.velocities);
    }

    /// Five periods: in one, the friction of a joint that turns back shakes it.
    fn note(&mut self, goal: &GoalFiles, velocities: [f64; DOF]) {
        self.before.push(velocities);
        let Some(first) = self.before.len().checked_sub(6) else { return };
        for (joint, velocity) in velocities.iter().enumerate() {
            let change = velocity - self.before[first][joint];
            let share = (change / (5.0 * PERIOD)).abs() / goal.arm.joints[joint].acceleration;
            self.largest[joint] = self.largest[joint].max(share);
        }
    }

    /// An image in the middle of a motion: the mean acceleration in it.
    fn look(&mut self, goal: &GoalFiles) {
        let before = self.twin.observe();
        self.twin.look(Camera::Wrist).unwrap();
        let after = self.twin.observe();
        for joint in 0..DOF {
            let change = (after.velocities[joint] - before.velocities[joint]).abs();
            let share = change / (after.time - before.time) / goal.arm.joints[joint].acceleration;
            self.largest[joint] = self.largest[joint].max(share);
        }
    }
}

/// An attack, period by period.
type Attack = fn(&GoalFiles, &mut Measured);

/// Joint velocities that jump.
fn velocities(goal: &GoalFiles, robot: &mut Measured) {
    for period in 0..600 {
        let speed = if period / 100 % 2 == 0 { 0.6 } else { -0.6 };
        robot.step(goal, ArmCommand::JointVelocities([speed; DOF]));
    }
}

/// Positions that begin as far from the arm as is accepted, and velocities, in turn.
fn in_turn(goal: &GoalFiles, robot: &mut Measured) {
    for period in 0..200 {
        let mut positions = robot.twin.observe().positions;
        let side = if period / 20 % 2 == 0 { 1.0 } else { -1.0 };
        positions.iter_mut().for_each(|position| *position += 0.0099 * side);
        robot.step(goal, ArmCommand::JointPositions(positions));
        robot.step(goal, ArmCommand::JointVelocities([0.1 * side; DOF]));
    }
}

/// A fast motion of positions that stops at once for velocities of zero.
fn stop_by_velocities(goal: &GoalFiles, robot: &mut Measured) {
    run_up(goal, robot);
    for _ in 0..300 {
        robot.step(goal, ArmCommand::JointVelocities([0.0; DOF]));
    }
}

/// One that stops at once for positions where the arm is.
fn stop_by_positions(goal: &GoalFiles, robot: &mut Measured) {
    for _ in 0..300 {
        robot.step(goal, ArmCommand::JointVelocities([0.5; DOF]));
    }
    let here = robot.twin.observe().positions;
    for _ in 0..300 {
        robot.step(goal, ArmCommand::JointPositions(here));
    }
}

/// Poses that begin as far from the tip as is accepted, and velocities, in turn.
fn poses_in_turn(goal: &GoalFiles, robot: &mut Measured) {
    for period in 0..600 {
        let x_wt = robot.twin.observe().x_wt;
        let side = if period / 20 % 2 == 0 { 1.0 } else { -1.0 };
        let p = Translation3::from(x_wt.translation.vector + nalgebra::Vector3::new(0.0, 4.9e-3 * side, 0.0));
        robot.step(goal, ArmCommand::CartesianPose(Pose::from_parts(p, x_wt.rotation)));
        robot.step(goal, ArmCommand::JointVelocities([0.0; DOF]));
    }
}

/// A fast motion of joint 1 and joint 4 within the limits.
fn run_up(goal: &GoalFiles, robot: &mut Measured) {
    let home = robot.twin.observe().positions;
    for period in 1..=400 {
        let time = f64::from(period) * PERIOD;
        let mut positions = home;
        // From rest to 1 rad/s within 0.3 s, with the jerk of a cosine.
        let ramp = |t: f64| if t < 0.3 { (t - 0.3 / PI * (t / 0.3 * PI).sin()) / 2.0 } else { t - 0.15 };
        positions[0] += ramp(time);
        positions[3] -= 0.5 * ramp(time);
        robot.step(goal, ArmCommand::JointPositions(positions));
    }
}

/// An image in the middle of a fast motion, which then goes on.
fn look(goal: &GoalFiles, robot: &mut Measured) {
    run_up(goal, robot);
    robot.look(goal);
}

#[test]
fn no_change_of_command_exceeds_the_limits_of_acceleration() {
    let goal = GoalFiles::new("easy-1");
    let attacks: [(&str, Attack); 6] = [
        ("velocities that jump", velocities),
        ("positions and velocities in turn", in_turn),
        ("positions, then no velocity", stop_by_velocities),
        ("velocities, then a position", stop_by_positions),
        ("poses and velocities in turn", poses_in_turn),
        ("an image in a motion", look),
    ];
    let mut failed = Vec::new();
    for world in ["ideal", "real"] {
        for (name, attack) in attacks {
            let mut robot = Measured::new(&goal, World::shipped(world).unwrap());
            attack(&goal, &mut robot);
            let largest = robot.largest.iter().fold(0.0, |most: f64, share| most.max(*share));
            if largest > 1.0 {
                failed.push(format!("{world}, {name}: {largest:.2}"));
            }
        }
    }
    assert!(failed.is_empty(), "accelerations as shares of the limits: {failed:#?}");
}

/// The arm cannot pass through itself: where a motion would end with the hand in a link, it is stopped
/// before.
#[test]
fn links_that_are_not_neighbours_collide() {
    let goal = GoalFiles::new("easy-1");
    let (kinematics, checker) =
        (Kinematics::new(&goal.arm), Checker::new(&goal.arm, 0.04, Vec::new(), &[], 0.0));
    let mut stream = Stream::new(1, "postures");
    let mut tried = 0;
    while tried < 3 {
        let mut aim = goal.arm.home;
        for (joint, position) in aim.iter_mut().enumerate() {
            let [low, high] = goal.arm.joints[joint].range;
            *position = low + 0.05 + stream.uniform() * (high - low - 0.1);
        }
        if checker.touched(&kinematics.frames(&aim.into())) != Some("itself") {
            continue;
        }
        let mut twin = goal.twin_in(World::ideal(), 1);
        let mut last = None;
        for period in 1..=6000 {
            let s = f64::from(period.min(5000)) / 5000.0;
            let share = s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
            let positions = std::array::from_fn(|joint| {
                goal.arm.home[joint] + share * (aim[joint] - goal.arm.home[joint])
            });
            let gripper = GripperCommand { width: 0.04, force: 20.0 };
            let Ok(seen) = twin.step(&Command { arm: ArmCommand::JointPositions(positions), gripper }) else {
                break;
            };
            let off = (0..DOF).map(|joint| (seen.positions[joint] - positions[joint]).abs());
            last = Some(off.fold(0.0, f64::max));
        }
        let Some(off) = last else { continue };
        assert!(off > 0.005, "the arm reaches a posture in which it is in itself");
        tried += 1;
    }
}

/// An arm at rest: in `real` and `hard` it reports multiples of the steps of its sensors, with noise of the
/// encoders; `ideal` has neither.
#[test]
fn encoders_and_width_have_steps() {
    let goal = GoalFiles::new("easy-1");
    for world in ["ideal", "real", "hard"] {
        let world = World::shipped(world).unwrap();
        let physics = world.draw(1);
        let [step, width_step] = [physics.sensing.encoder_step, physics.gripper.width_step];
        if world.name == "ideal" {
            assert_eq!([step, width_step, physics.sensing.encoder_noise], [0.0; 3]);
            continue;
        }
        let mut robot = Measured::new(&goal, world);
        let mut seen = Vec::new();
        for _ in 0..200 {
            robot.step(&goal, ArmCommand::JointPositions(goal.arm.home));
            seen.push(robot.twin.observe());
        }
        let is_multiple = |value: f64, step: f64| (value / step - (value / step).round()).abs() < 1e-6;
        let first: Vec<f64> = seen.iter().map(|it| it.positions[0]).collect();
        let differ = first.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!(first.iter().all(|position| is_multiple(*position, step)), "{}", world.name);
        assert!(seen.iter().all(|it| is_multiple(it.width, width_step)), "{}", world.name);
        // Half a step of noise: about every third reading is another one.
        assert!(differ > 20, "{}: {differ} changes of a joint at rest", world.name);
    }
}
