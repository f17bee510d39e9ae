//! The clamp of the base beam under a force.

use nalgebra::{Translation3, Vector3, Vector6};
use ramp_kit::joint::FEMALE_HEIGHT;
use ramp_kit::source::SourceFile;
use ramp_robot::{ArmCommand, Command, GripperCommand, Impedance, Robot, Track};
use ramp_testing::GoalFiles;
use ramp_twin::{Layout, SceneOptions, Setup, Twin, World};

/// Mean force on a beam that the closed hand presses down on, N, and how far below its place each of
/// `watched` is on average, least and most over the last half second, m. `along` is a place on the beam, m.
fn press(twin: &mut Twin, beam: &str, along: f64, watched: &str) -> (f64, [f64; 3]) {
    let index = |twin: &Twin, name: &str| twin.part_names().position(|part| part == name).unwrap();
    let (beam, watched) = (index(twin, beam), index(twin, watched));
    let places = twin.truth().x_wp;
    let (hand, posture) = (twin.observe().x_wt, twin.observe().positions);
    let link = places[beam] * nalgebra::Point3::new(along, 0.0, 0.0);
    let steps = 6000;
    let (mut forces, mut offs) = (Vec::new(), Vec::new());
    for period in 0..steps {
        let share = (f64::from(period) / 3000.0).min(1.0);
        let mut x_wt = hand;
        let target = Vector3::new(link.x, link.y, link.z - 0.03);
        x_wt.translation.vector = hand.translation.vector.lerp(&target, share);
        let impedance = Impedance {
            x_wt,
            stiffness: Vector6::new(800.0, 800.0, 800.0, 40.0, 40.0, 40.0),
            damping_ratio: 1.0,
            feed_forward: Vector6::zeros(),
            posture,
        };
        let arm = ArmCommand::CartesianImpedance(impedance);
        let seen = twin.step(&Command { arm, gripper: GripperCommand { width: 0.0, force: 20.0 } }).unwrap();
        if period >= steps - 500 {
            forces.push(-seen.wrench[2]);
            offs.push(places[watched].translation.z - twin.truth().x_wp[watched].translation.z);
        }
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let [least, most] = [f64::min, f64::max].map(|of| offs.iter().copied().fold(offs[0], of));
    (mean(&forces), [mean(&offs), least, most])
}

/// It gives by the world's number, and does not ring.
#[test]
fn the_clamp_gives_as_much_as_the_world_says() {
    let goal = GoalFiles::new("easy-1");
    let world = World::shipped("real").unwrap();
    let setup = Setup { world, ..goal.setup(Track::State, 1) };
    let give = world.draw(setup.seed).table.clamp_give;
    let mut twin = Twin::new(&setup).unwrap();
    let (force, [off, least, most]) = press(&mut twin, "b7", 0.35, "b7");
    assert!(force > 5.0, "the hand does not press: {force} N");
    // The estimate of the force is a few newtons off.
    assert!((off / give - force).abs() < 6.0, "{off} m under {force} N, at {give} m/N");
    assert!(most - least < 0.2 * off, "it rings between {least} and {most} m");
}

/// A frame that is rigid with the base beam gives as one, by a force on any of its parts. The world is
/// `ideal` with a clamp, so the sensor tells the force.
#[test]
fn a_rigid_frame_gives_as_one() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/worlds/ideal.toml"));
    let text = text.unwrap().replace("clamp_give = { value = 0.0", "clamp_give = { value = 1.0e-5");
    let world = World::from_source(&SourceFile::new("stiff.toml", &text)).unwrap();
    let goal = GoalFiles::new("easy-1");
    let setup = Setup { world: &world, ..goal.setup(Track::State, 1) };
    let twin = Twin::new(&setup).unwrap();
    let rigid = twin.with_rigid(&setup, ["b5".to_string()].into(), &SceneOptions::default()).unwrap();
    for watched in ["b5", "b7"] {
        let (force, [off, ..]) = press(&mut rigid.duplicate(), "b5", 0.1, watched);
        assert!(force > 5.0, "the hand does not press: {force} N");
        assert!((off / 1e-5 / force - 1.0).abs() < 0.1, "{watched}: {off} m under {force} N");
    }
}

/// A blow on the frame, as a hand that runs into it gives, does not shake it to pieces: the clamp that gives
/// most gives in and comes back.
#[test]
fn a_blow_on_the_frame_dies_down() {
    let goal = GoalFiles::new("hard-1");
    let assembly = &goal.assembly;
    let setup = Setup { world: World::shipped("hard").unwrap(), ..goal.setup(Track::State, 1) };
    let mut layout = Layout::new(assembly, setup.start, setup.seed);
    for (name, x_wb) in &mut layout.beams {
        let placed = assembly.beams.iter().find(|placed| placed.beam.name == *name);
        *x_wb = placed.map_or(*x_wb, |placed| assembly.kit.x_wa() * placed.x_ab);
    }
    for (connection, (_, x_wp)) in assembly.connections.iter().zip(&mut layout.pegs) {
        let hole = assembly.kit.x_wa() * assembly.p_a_hole(connection.female);
        *x_wp = Translation3::new(hole.x, hole.y, hole.z + FEMALE_HEIGHT / 2.0).into();
    }
    let mut twin = Twin::with_layout(&setup, layout).unwrap();
    twin.settle(400).unwrap();
    let clamped = twin.part_names().position(|part| part == "b7").unwrap();
    let place = twin.truth().x_wp[clamped].translation.vector;
    for beam in ["b1", "b4", "b5", "b9"] {
        twin.knock(beam, &Vector3::new(0.0, 0.0, 2.0), &Vector3::zeros());
    }
    let off = |twin: &Twin| (twin.truth().x_wp[clamped].translation.vector - place).norm();
    let mut most = 0.0f64;
    for _ in 0..100 {
        twin.settle(1).unwrap();
        most = most.max(off(&twin));
    }
    twin.settle(400).unwrap();
    let rest = off(&twin);
    assert!(most > 0.02e-3, "the blow does not reach the clamp: {most} m");
    assert!(most < 1e-3 && rest < 0.02e-3, "it moved by up to {most} m, and is {rest} m off");
}
