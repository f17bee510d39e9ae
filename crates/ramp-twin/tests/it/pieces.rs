//! Shapes that are only there when something near could meet them: what their absence may change, and what it
//! may not.

use nalgebra::{Translation3, Vector3};
use ramp_kit::Pose;
use ramp_kit::joint::{FEMALE_HEIGHT, HOLE_RADIUS, STEM_LENGTH, STEM_RADIUS, STEM_TIP_RADIUS};
use ramp_robot::Track;
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
        let mut seated = Seated::released(world, Vector3::zeros());
        seated.twin.settle(400).unwrap();
        seated
    }

    /// The same with the peg so far from its seat (m), before any period.
    fn released(world: &'static World, off: Vector3<f64>) -> Seated {
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
        *x_wp = Translation3::from(seat + off).into();
        let twin = Twin::with_layout(&setup, layout).unwrap();
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

/// A peg that is dropped beside its hole slides in if its tip meets the hole, and else stays out: by the
/// distance alone, whatever the direction.
#[test]
fn a_hole_is_found_from_the_same_offsets_in_all_directions() {
    let least = HOLE_RADIUS - STEM_TIP_RADIUS;
    for step in 0..8 {
        let angle = f64::from(step) * std::f64::consts::TAU / 8.0 + 0.2;
        let along = Vector3::new(angle.cos(), angle.sin(), 0.0);
        for (share, is_found) in [(0.7, true), (1.3, false)] {
            let off = along * share * least + Vector3::z() * (STEM_LENGTH + 1e-3);
            let mut peg = Seated::released(World::ideal(), off);
            peg.twin.settle(300).unwrap();
            let at = peg.off();
            let is_in = at.z < STEM_LENGTH / 2.0 && at.xy().norm() < HOLE_RADIUS;
            assert_eq!(is_in, is_found, "{step}, {share} of {least} m: at {at:?}");
        }
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
