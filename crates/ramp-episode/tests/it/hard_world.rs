//! The world `hard`: an arm that is millimetres off in height, and as compliant as it is rough.

use ramp_robot::{Cause, EventKind, Fault, Track};
use ramp_testing::GoalFiles;
use ramp_twin::World;

/// The fingers close beside the slots of b5, with their ribs on its sides. They come down on it from above
/// once, and hold it: no grasp is tried in vain.
#[test]
fn fingers_beside_the_slots_find_them_on_a_compliant_arm() {
    let result = GoalFiles::new("easy-1").run_in(World::shipped("hard").unwrap(), Track::State, 90);
    let is_b5 = |part: &Option<String>| part.as_deref() == Some("b5");
    let beside = |kind: &EventKind| matches!(kind, EventKind::Diagnosis { cause: Cause::GripWeak, part, .. } if is_b5(part));
    let in_vain =
        |kind: &EventKind| matches!(kind, EventKind::Fault(Fault::NotHeld { part }) if part == "b5");
    let count =
        |is: &dyn Fn(&EventKind) -> bool| result.events.iter().filter(|event| is(&event.kind)).count();
    assert_eq!((count(&beside), count(&in_vain)), (1, 0));
    assert_eq!(result.counted(), 3);
}
