//! A joint type and a beam that only a kit file knows, in the twin.

use std::path::Path;

use ramp_assembly::Task;
use ramp_robot::arm::ArmModel;
use ramp_robot::{ArmCommand, Command, GripperCommand, Robot, Track};
use ramp_twin::{Setup, Start, Twin};

#[test]
fn a_beam_of_the_kit_s_own_lies_still_on_the_sheet() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let kit = ramp_kit::read_kit(&data.join("examples/kit-45.xml")).unwrap();
    let assembly = ramp_assembly::read_goal(&data.join("examples/corner-45.xml"), &kit).unwrap();
    let arm = ArmModel::read(&data.join("arms/panda.json")).unwrap();
    let setup = Setup {
        assembly: &assembly,
        arm: &arm,
        track: Track::State,
        seed: 1,
        start: Start::sheet(),
        world: ramp_twin::World::ideal(),
        state: None,
        task: Task::Build,
        fault: None,
    };
    let mut twin = Twin::new(&setup).unwrap();
    let pose = |twin: &Twin| {
        let index = twin.part_names().position(|name| name == "b10").unwrap();
        twin.truth().x_wp[index]
    };
    let before = pose(&twin);
    let seen = twin.observe();
    let stay = Command {
        arm: ArmCommand::JointPositions(seen.positions),
        gripper: GripperCommand { width: seen.width, force: 20.0 },
    };
    for _ in 0..500 {
        twin.step(&stay).unwrap();
    }
    let after = pose(&twin);
    assert!((after.translation.vector - before.translation.vector).norm() < 0.5e-3, "{before} {after}");
    assert!(after.rotation.angle_to(&before.rotation) < 5e-3, "{before} {after}");
}
