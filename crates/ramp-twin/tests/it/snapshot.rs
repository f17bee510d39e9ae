//! A snapshot that is taken up again is followed by the same bits, and so is a duplicate.

use nalgebra::Vector6;
use ramp_assembly::Task;
use ramp_robot::arm::DOF;
use ramp_robot::{ArmCommand, Camera, Command, GripperCommand, Impedance, Observation, Pose, Robot, Track};
use ramp_testing::GoalFiles;
use ramp_twin::{Fault, FaultKind, Layout, RestoreError, SceneOptions, Setup, Start, Twin};

fn setup<'a>(cell: &'a GoalFiles, world: &'a ramp_twin::World, track: Track) -> Setup<'a> {
    Setup {
        assembly: &cell.assembly,
        arm: &cell.arm,
        track,
        seed: 7,
        start: Start::sheet(),
        world,
        state: None,
        task: Task::Build,
        fault: Some(Fault { kind: FaultKind::ForceDrift, occasion: None }),
    }
}

/// Swings down onto what stands on the table and up again, with the fingers at work: `period` after the
/// start.
fn command(home: &Pose, posture: [f64; DOF], period: u32) -> Command {
    let phase = f64::from(period) * 0.7e-3;
    let mut x_wt = *home;
    x_wt.translation.x += 0.05 * (1.3 * phase).sin();
    x_wt.translation.y += 0.1 * (0.9 * phase).sin();
    x_wt.translation.z -= 0.25 * (1.0 - phase.cos());
    let impedance = Impedance {
        x_wt,
        stiffness: Vector6::new(300.0, 300.0, 300.0, 20.0, 20.0, 20.0),
        damping_ratio: 1.0,
        feed_forward: Vector6::zeros(),
        posture,
    };
    let gripper = GripperCommand { width: 0.04 + 0.03 * (2.0 * phase).sin(), force: 20.0 };
    Command { arm: ArmCommand::CartesianImpedance(impedance), gripper }
}

/// All outputs of a twin over a number of periods, with readings and images.
fn go_on(twin: &mut Twin, home: &Pose, from: u32, periods: u32) -> (Vec<Result<Observation, String>>, u64) {
    let posture = twin.observe().positions;
    let mut seen = Vec::new();
    for period in from..from + periods {
        let step = twin.step(&command(home, posture, period));
        seen.push(step.map_err(|error| error.to_string()));
        if period.is_multiple_of(700) {
            let seen_by_camera = match twin.look(Camera::Wrist) {
                Ok(image) => {
                    format!("{} {:?}", image.time, image.pixels.iter().map(|it| u64::from(*it)).sum::<u64>())
                }
                Err(error) => error.to_string(),
            };
            let parts = twin.read_parts().map(|parts| format!("{parts:?}"));
            seen.push(Err(format!("{seen_by_camera} {parts:?}")));
        }
    }
    seen.push(Err(format!("{} {} {:?}", twin.deepest_penetration(), twin.largest_force(), twin.fault())));
    (seen, twin.state_hash())
}

#[test]
fn what_follows_a_snapshot_is_the_same_to_the_last_bit() {
    let cell = GoalFiles::new("easy-1");
    for name in ["ideal", "real"] {
        let world = ramp_twin::World::shipped(name).unwrap();
        for track in [Track::State, Track::Noisy, Track::Tags] {
            let mut twin = Twin::new(&setup(&cell, world, track)).unwrap();
            let home = twin.observe().x_wt;
            let start = twin.snapshot();
            let first = go_on(&mut twin, &home, 0, 1500);
            let later = twin.snapshot();
            assert!(later.time() > start.time());
            let second = go_on(&mut twin, &home, 1500, 1500);
            let steps = second.0.iter().filter(|it| it.is_ok()).count();
            assert_eq!(steps, 1500, "{name} {track:?}: the arm went on to the end");
            // Back to the middle and to the start, in the twin itself and in another.
            let mut other = twin.duplicate();
            other.restore(&later).unwrap();
            assert!(go_on(&mut other, &home, 1500, 1500) == second, "{name} {track:?}: duplicate");
            twin.restore(&later).unwrap();
            assert!(go_on(&mut twin, &home, 1500, 1500) == second, "{name} {track:?}: middle");
            twin.restore(&start).unwrap();
            assert!(go_on(&mut twin, &home, 0, 1500) == first, "{name} {track:?}: start");
            assert_eq!(twin.snapshot().time(), later.time());
        }
    }
}

#[test]
fn a_snapshot_of_another_twin_is_refused() {
    let cell = GoalFiles::new("easy-1");
    let world = ramp_twin::World::ideal();
    let one = cell.twin(Track::State, 7);
    let mut other = Twin::new(&setup(&cell, world, Track::State)).unwrap();
    let before = other.state_hash();
    assert!(matches!(other.restore(&one.snapshot()), Err(RestoreError::OtherTwin)));
    assert_eq!(other.state_hash(), before);
}

#[test]
fn a_scene_without_meshes_and_with_little_memory_has_the_same_physics() {
    let cell = GoalFiles::new("easy-1");
    let world = ramp_twin::World::ideal();
    let setup = setup(&cell, world, Track::State);
    let layout = Layout::new(setup.assembly, setup.start, setup.seed);
    let mut whole = Twin::with_layout(&setup, layout.clone()).unwrap();
    let mut lean = Twin::with_options(&setup, layout, &SceneOptions { looks: false, memory: 64 }).unwrap();
    assert!(lean.scene().len() < whole.scene().len() / 2);
    let home = whole.observe().x_wt;
    assert!(go_on(&mut whole, &home, 0, 3000) == go_on(&mut lean, &home, 0, 3000));
}
