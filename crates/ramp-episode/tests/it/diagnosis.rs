//! The baseline diagnoses faults in the physics from its own sensors.

use ramp_result::EpisodeResult;
use ramp_robot::{EventKind, Track};
use ramp_testing::GoalFiles;

/// The goal is built from a seed despite `fault`, and the first diagnosis after its trigger names `cause`.
fn told(goal: &str, seed: u64, fault: &str, cause: &str) -> EpisodeResult {
    let world = GoalFiles::new(goal);
    let mut setup = world.setup(Track::Tags, seed);
    setup.fault = Some(fault.parse().unwrap());
    let result = world.run_setup(&setup);
    let at = result.fault.as_ref().unwrap().at.unwrap();
    let mut after = result.events.iter().filter(|event| event.time >= at).map(|event| &event.kind);
    let told = after.find(|event| matches!(event, EventKind::Diagnosis { .. }));
    let told = told.map_or("nothing".to_string(), ToString::to_string);
    assert!(told.starts_with(cause), "{fault}: {told}");
    assert_eq!(result.counted(), result.pegs.len(), "{fault}: {:?}", result.events);
    result
}

/// No camera sees how a peg stands in the hand; the contact of its tip with the plate beside the hole shows
/// it.
#[test]
fn a_peg_that_stands_aslant_is_set_upright() {
    told("easy-1", 1, "peg-tilted@3", "grip-moved: p3 is tilted ");
}

/// A peg whose tip caught the rim of its hole cannot be pressed in: its contact point shows that it is
/// tilted.
#[test]
fn a_peg_that_is_pressed_aslant_is_no_jam() {
    let result = told("easy-1", 36, "peg-tilted@1", "grip-moved: p1 ");
    let told = result.events.iter().map(|event| event.kind.to_string());
    let presses = told.filter(|text| text.starts_with("grip-moved: p1 presses ")).count();
    assert!(presses > 0, "{:?}", result.events);
}

/// The pixels that a frozen camera repeats would put parts where they were seen from another place of the
/// hand.
#[test]
fn a_camera_that_repeats_its_image_is_waited_for() {
    told("easy-1", 3, "camera-frozen@2", "sight: ");
}

#[test]
fn a_part_that_fingers_do_not_reach_is_gripped_again() {
    told("easy-1", 3, "gripper-weak@2", "grip-weak: ");
}
