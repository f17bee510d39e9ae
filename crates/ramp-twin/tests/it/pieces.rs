//! Shapes that are only there when something near could meet them: what their absence may change, and what it
//! may not.

use nalgebra::Vector3;
use ramp_kit::Pose;
use ramp_kit::joint::{FEMALE_HEIGHT, HOLE_RADIUS, STEM_RADIUS};
use ramp_robot::{ArmCommand, Command, GripperCommand, Impedance, Robot, Track};
use ramp_testing::GoalFiles;
use ramp_twin::{Layout, Setup, Twin, World};

/// A peg that is seated in the first connection of easy-1, and where it is in its place.
struct Seated {
    twin: Twin,
    seat: Vector3<f64>,
    peg: usize,
}

impl Seated {
    fn new(world: &'static World) -> Seated {
        let goal = GoalFiles::new("easy-1");
        let setup = Setup { world, ..goal.setup(Track::State, 1) };
        let assembly = &goal.assembly;
        let mut layout = Layout::new(assembly, setup.start, setup.seed);
        let connection = &assembly.connections[0];
        for joint in [connection.female, connection.male] {
            let placed = &assembly.beams[joint.beam];
            let (_, x_wb) = layout.beams.iter_mut().find(|(name, _)| *name == placed.beam.name).unwrap();
            *x_wb = assembly.kit.x_wa() * placed.x_ab;
        }
        let hole = assembly.kit.x_wa() * assembly.p_a_hole(connection.female);
        let seat = Vector3::new(hole.x, hole.y, hole.z + FEMALE_HEIGHT / 2.0);
        let (_, x_wp) = layout.pegs.iter_mut().find(|(name, _)| name == "p1").unwrap();
        *x_wp = Pose::translation(seat.x, seat.y, seat.z);
        let mut twin = Twin::with_layout(&setup, layout).unwrap();
        twin.settle(400).unwrap();
        let peg = twin.part_names().position(|name| name == "p1").unwrap();
        Seated { twin, seat, peg }
    }

    /// How far the peg is from its seat, m.
    fn off(&self) -> Vector3<f64> {
        self.twin.truth().x_wp[self.peg].translation.vector - self.seat
    }

    fn knock(&mut self, velocity: Vector3<f64>) {
        self.twin.knock("p1", &velocity, &Vector3::zeros());
    }
}

/// A seated peg that is knocked aside moves by its play, in every direction: at least that of the round hole,
/// and on the diagonals at most that of the square one.
#[test]
fn a_seated_peg_has_its_play_in_all_directions() {
    let play = HOLE_RADIUS - STEM_RADIUS;
    for step in 0..16 {
        let mut seated = Seated::new(World::ideal());
        let angle = f64::from(step) * std::f64::consts::TAU / 16.0;
        let along = Vector3::new(angle.cos(), angle.sin(), 0.0);
        // Against friction: it slides by more than its play.
        seated.knock(along * 0.08);
        let mut farthest: f64 = 0.0;
        for _ in 0..40 {
            seated.twin.settle(2).unwrap();
            farthest = farthest.max(seated.off().dot(&along));
        }
        let square = play * 2.0_f64.sqrt();
        assert!(farthest > 0.6 * play && farthest < square + 0.15e-3, "{step}: {farthest} m, play {play} m");
    }
}

/// A peg that leaves its seat gets its round hole back without a kick to the side.
#[test]
fn a_peg_that_is_pulled_out_is_not_kicked() {
    for step in 0..8 {
        let mut seated = Seated::new(World::ideal());
        let angle = f64::from(step) * std::f64::consts::TAU / 8.0;
        // On a diagonal the stem is in a corner of the square hole when it starts.
        seated.knock(Vector3::new(0.1 * angle.cos(), 0.1 * angle.sin(), 0.0));
        seated.twin.settle(20).unwrap();
        seated.knock(Vector3::new(0.02 * angle.cos(), 0.02 * angle.sin(), 0.3));
        let (mut before, mut highest, mut fastest) = (seated.off(), 0.0_f64, 0.0_f64);
        for _ in 0..60 {
            seated.twin.settle(1).unwrap();
            let now = seated.off();
            fastest = fastest.max((now - before).xy().norm() / 1e-3);
            highest = highest.max(now.z);
            before = now;
        }
        assert!(highest > 2e-3, "{step}: it did not leave its seat: {highest} m");
        assert!(fastest < 0.15, "{step}: it was kicked to the side with {fastest} m/s");
    }
}

/// A thrown peg tumbles as a rigid body does, whatever pieces it is made of: free of forces but its weight,
/// its energy of rotation stays.
#[test]
fn a_thrown_peg_tumbles_as_one_body() {
    let goal = GoalFiles::new("easy-1");
    let setup = goal.setup(Track::State, 1);
    let mut layout = Layout::new(&goal.assembly, setup.start, setup.seed);
    let (_, x_wp) = layout.pegs.iter_mut().find(|(name, _)| name == "p1").unwrap();
    *x_wp = Pose::translation(0.5, -0.2, 1.0);
    let mut twin = Twin::with_layout(&setup, layout).unwrap();
    twin.knock("p1", &Vector3::new(0.0, 0.0, 1.0), &Vector3::new(9.0, 2.0, 5.0));
    let peg = twin.part_names().position(|name| name == "p1").unwrap();
    let pose = |twin: &Twin| twin.truth().x_wp[peg];
    let mut speeds = Vec::new();
    twin.settle(2).unwrap();
    let mut before = pose(&twin);
    for _ in 0..400 {
        twin.settle(1).unwrap();
        let now = pose(&twin);
        speeds.push(before.rotation.angle_to(&now.rotation) / 1e-3);
        before = now;
    }
    let first = (before.translation.z - 1.0 - 0.4 + 9.81 / 2.0 * 0.16).abs();
    assert!(first < 0.03, "it does not fall freely: {first} m");
    let [least, most] = [f64::min, f64::max].map(|of| speeds.iter().copied().fold(speeds[0], of));
    // A long body's axis nods: its speed of rotation varies between the limits that its inertia sets.
    assert!(most < 1.2 * speeds[0] && least > 0.8 * speeds[0], "{least} to {most} rad/s");
}

/// The clamp gives by the world's number under a force, slowly comes back, and does not ring.
#[test]
fn the_clamp_gives_as_much_as_the_world_says() {
    let goal = GoalFiles::new("easy-1");
    let world = World::shipped("real").unwrap();
    let setup = Setup { world, ..goal.setup(Track::State, 1) };
    let give = world.draw(setup.seed).table.clamp_give;
    let mut twin = Twin::new(&setup).unwrap();
    let base = twin.part_names().position(|name| name == "b7").unwrap();
    let place = twin.truth().x_wp[base].translation.vector;
    let (hand, posture) = (twin.observe().x_wt, twin.observe().positions);
    let link = place + twin.truth().x_wp[base].rotation * Vector3::x() * 0.35;
    // Down onto the beam with the closed hand.
    let steps = 6000;
    let mut pressed = Vec::new();
    for period in 0..steps {
        let share = (f64::from(period) / 3000.0).min(1.0);
        let mut x_wt = hand;
        let target = Vector3::new(link.x, link.y, 0.01);
        x_wt.translation.vector = hand.translation.vector.lerp(&target, share);
        let impedance = Impedance {
            x_wt,
            stiffness: nalgebra::Vector6::new(800.0, 800.0, 800.0, 40.0, 40.0, 40.0),
            damping_ratio: 1.0,
            feed_forward: nalgebra::Vector6::zeros(),
            posture,
        };
        let arm = ArmCommand::CartesianImpedance(impedance);
        let seen = twin.step(&Command { arm, gripper: GripperCommand { width: 0.0, force: 20.0 } }).unwrap();
        if period >= steps - 500 {
            pressed.push((-seen.wrench[2], place.z - twin.truth().x_wp[base].translation.z));
        }
    }
    let count = pressed.len() as f64;
    let (force, off) = pressed.iter().fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
    let (force, off) = (force / count, off / count);
    assert!(force > 5.0, "the hand does not press: {force} N");
    // The estimate of the force is a few newtons off.
    assert!((off / give - force).abs() < 6.0, "{off} m under {force} N, at {give} m/N");
    let [least, most] = [f64::min, f64::max].map(|of| pressed.iter().map(|it| it.1).fold(off, of));
    assert!(most - least < 0.2 * off, "it rings between {least} and {most} m");
}
