//! Tactile sensors report what the fingers do to what they hold.

use std::f64::consts::PI;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_robot::{
    ArmCommand, Command, FingerTouch, GRAVITY, GripperCommand, Observation, Pose, Robot, Touch,
};
use ramp_testing::GoalFiles;
use ramp_twin::{Twin, World};

/// Height of the tip over a beam's axis when the ribs are in its slots, m.
const BEAM_HEIGHT: f64 = 17.0e-3;
/// Distance of the fingers when they are open, m.
const OPEN: f64 = 0.04;

/// Moves the tip in a straight line from one pose to another within so many seconds.
fn go(twin: &mut Twin, [from, to]: [Pose; 2], seconds: f64, gripper: GripperCommand) {
    let periods = (seconds * 1e3) as usize;
    for period in 1..=periods {
        let share = period as f64 / periods as f64;
        let smooth = share * share * (3.0 - 2.0 * share);
        let arm = ArmCommand::CartesianPose(from.lerp_slerp(&to, smooth));
        twin.step(&Command { arm, gripper }).unwrap();
    }
    let arm = ArmCommand::CartesianPose(to);
    stay(twin, &Command { arm, gripper }, 300);
}

/// Repeats a command for so many periods.
fn stay(twin: &mut Twin, command: &Command, periods: usize) {
    for _ in 0..periods {
        twin.step(command).unwrap();
    }
}

/// Grips b4 where it lies at the start of easy-1 with so much force (N), and lifts it. Returns the twin, its
/// last command, and the beam's mass, kg.
fn lifted(world: &str, force: f64) -> (Twin, Command, f64) {
    let goal = GoalFiles::new("easy-1");
    let mut twin = goal.twin_in(World::shipped(world).unwrap(), 3);
    let beam = goal.assembly.kit.beam("b4").unwrap();
    let reading = twin.read_parts().unwrap().into_iter().find(|reading| reading.part == "b4").unwrap();
    let [from, to] = beam.links[0].grasp;
    let p = reading.x_wp * Point3::new((from + to) / 2.0, 0.0, 0.0);
    let along = reading.x_wp.rotation * Vector3::x();
    let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), along.y.atan2(along.x))
        * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
    let at = |height| Pose::from_parts(Translation3::new(p.x, p.y, p.z + BEAM_HEIGHT + height), rotation);
    let open = GripperCommand { width: OPEN, force };
    let closed = GripperCommand { width: 0.0, force };
    let home = twin.observe().x_wt;
    go(&mut twin, [home, at(0.1)], 2.0, open);
    go(&mut twin, [at(0.1), at(0.0)], 1.0, open);
    go(&mut twin, [at(0.0), at(0.0)], 1.0, closed);
    go(&mut twin, [at(0.0), at(0.05)], 1.0, closed);
    let last = Command { arm: ArmCommand::CartesianPose(at(0.05)), gripper: closed };
    (twin, last, beam.mass())
}

fn touch(seen: &Observation) -> Touch {
    seen.touch.unwrap()
}

/// Force of both fingers on the part, N, axes of the tip.
fn force(touch: &Touch) -> Vector3<f64> {
    touch.fingers[0].force + touch.fingers[1].force
}

/// Fingers that hold a beam at rest carry its weight, and press as hard as the gripper. Open ones report
/// nothing.
#[test]
fn a_held_beam_weighs_on_the_fingers() {
    let (mut twin, mut last, mass) = lifted("ideal+touch", 15.0);
    let seen = touch(&twin.observe());
    let [first, second] = seen.fingers;
    // The tip's z is downwards.
    assert!((force(&seen).z + mass * GRAVITY).abs() < 0.02 * mass * GRAVITY, "{seen:?}");
    assert!((first.force.y + 15.0).abs() < 0.3 && (second.force.y - 15.0).abs() < 0.3, "{seen:?}");
    for finger in seen.fingers {
        // On the rib, which is 17 mm from the tip and 20 mm wide.
        let [x, z] = finger.centre.unwrap();
        assert!(x.abs() < 0.0101 && (z - 0.017).abs() < 0.003, "{seen:?}");
    }
    last.gripper.width = OPEN;
    stay(&mut twin, &last, 1000);
    let nothing = FingerTouch { force: Vector3::zeros(), centre: None };
    assert_eq!(touch(&twin.observe()).fingers, [nothing; 2]);
}

/// In the world `real` readings come every 10 ms, end at the sensor's range, and have its noise.
#[test]
fn readings_have_the_errors_of_the_world() {
    let (mut twin, last, mass) = lifted("real+touch", 60.0);
    let readings: Vec<Touch> = (0..5000).map(|_| touch(&twin.step(&last).unwrap())).collect();
    let fresh: Vec<Touch> = readings.iter().copied().step_by(10).collect();
    let changes = readings.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert_eq!(changes, readings.len() / 10);
    assert!(fresh.iter().all(|reading| reading.fingers[0].force.y == -20.0));
    let weights: Vec<f64> = fresh.iter().map(|reading| -force(reading).z).collect();
    let mean = weights.iter().sum::<f64>() / weights.len() as f64;
    let spread = weights.iter().map(|it| (it - mean).powi(2)).sum::<f64>() / weights.len() as f64;
    // The noise of two sensors; their drift stays within three of its deviations.
    assert!((spread.sqrt() - 0.141).abs() < 0.02, "{}", spread.sqrt());
    assert!((mean - mass * GRAVITY).abs() < 0.42, "{mean} N of {} N", mass * GRAVITY);
}

/// The sensors change nothing of the physics, and a world without them gives no readings.
#[test]
fn sensors_leave_the_physics_as_they_are() {
    let [(with, ..), (without, ..)] = ["real+touch", "real"].map(|world| lifted(world, 60.0));
    assert_eq!(with.state_hash(), without.state_hash());
    assert!(with.observe().touch.is_some() && without.observe().touch.is_none());
    assert_eq!(Observation { touch: None, ..with.observe() }, without.observe());
}
