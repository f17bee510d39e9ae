//! Taking a built frame apart: task, referee, result, log and replay.

use ramp_assembly::Task;
use ramp_episode::replay;
use ramp_log::Log;
use ramp_result::episode::TAKE_APART;
use ramp_robot::Track;
use ramp_testing::episode::Swing;
use ramp_testing::{GoalFiles, data};
use ramp_twin::{GivenState, Setup, Start, World};

#[test]
fn a_built_frame_that_nobody_touches_is_not_apart() {
    let folder = tempfile::TempDir::new().unwrap();
    let goal = GoalFiles::new("easy-1");
    let state = GivenState::built(&goal.assembly).unwrap();
    let setup = Setup { state: Some(&state), task: Task::TakeApart, ..goal.setup(Track::State, 1) };
    let result = goal.record(&setup, &mut Swing(100), &folder.path().join("a.mcap"));
    assert_eq!((result.counted(), result.wanted(), result.completion), (0, 6, 0.0), "{:?}", result.parts);
    assert!(result.pegs.is_empty() && result.task.as_deref() == Some(TAKE_APART));
}

/// The arm draws beams out, slides one back and pulls pegs; a log of it replays to the bit.
#[test]
fn a_frame_is_taken_apart() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("a.mcap");
    let goal = GoalFiles::new("medium-2");
    let state = GivenState::built(&goal.assembly).unwrap();
    let (world, start) = (World::shipped("real").unwrap(), Start::moved());
    let setup =
        Setup { state: Some(&state), task: Task::TakeApart, world, start, ..goal.setup(Track::State, 1) };
    let mut agent = goal.baseline(setup.track, setup.seed).from_start(start).with_task(setup.task);
    let result = goal.record(&setup, &mut agent, &path);
    assert_eq!((result.counted(), result.completion), (10, 1.0), "{:?}", result.events);
    assert!(result.parts.iter().all(|part| part.t_robot < Some(result.time.robot)));
    for action in ["slide b6 back", "draw b8 out", "out of C3", "put down"] {
        let done = |text: String| text.contains(action);
        assert!(result.events.iter().any(|event| done(event.kind.to_string())), "{action}");
    }
    let schema = std::fs::read_to_string(data().join("schema/episode.schema.json")).unwrap();
    let schema = jsonschema::validator_for(&serde_json::from_str(&schema).unwrap()).unwrap();
    schema.validate(&serde_json::from_str(&result.to_json()).unwrap()).unwrap();

    let log = Log::read(&path).unwrap();
    assert_eq!(log.header.task.as_deref(), Some(TAKE_APART));
    let replayed = replay(&log).unwrap();
    assert!(replayed.is_equal(), "{:?}", replayed.differences);
    assert_eq!(replayed.result.parts, log.result.parts);
    let mut unbuilt = log.clone();
    unbuilt.header.state = None;
    unbuilt.result.state = None;
    assert!(replay(&unbuilt).unwrap_err().to_string().contains("not that of the built frame"));
    let mut other = log;
    other.header.task = None;
    assert!(replay(&other).unwrap_err().to_string().contains("its task is build"));
}
