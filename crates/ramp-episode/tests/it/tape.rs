//! The blind tape: the commands of a log without sight.

use ramp_episode::{Tape, run_episode};
use ramp_log::Log;
use ramp_robot::Track;
use ramp_testing::GoalFiles;
use ramp_testing::episode::label;
use ramp_twin::{Setup, Start, World};

/// From the places in its log a tape builds; from the places of other seeds of `moved` next to nothing. The
/// world is that of the boards.
#[test]
fn a_tape_builds_where_it_was_recorded_and_not_from_moved() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("it.mcap");
    let files = GoalFiles::new("easy-1");
    let world = World::shipped("real").unwrap();
    let setup = Setup { world, ..files.setup(Track::State, 1) };
    files.record(&setup, &mut files.baseline(Track::State, 1), &path);
    let mut tape = Tape::of(&Log::read(&path).unwrap()).unwrap();
    let mut counted = |setup: &Setup| {
        let result = run_episode(setup, &mut tape, &label(), &mut |_, _| {}).unwrap();
        assert_eq!(result.agent.name, "blind-tape");
        result.counted()
    };
    assert_eq!(counted(&setup), 3);
    let moved =
        [11, 12, 13, 14, 15, 16].map(|seed| counted(&Setup { start: Start::moved(), seed, ..setup.clone() }));
    assert!(moved.iter().sum::<usize>() <= 3, "{moved:?} pegs of 3 each without sight");
}
