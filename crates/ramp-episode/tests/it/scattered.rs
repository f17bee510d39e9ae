//! Episodes from starts in which parts lie anywhere on the table.

use ramp_result::EpisodeResult;
use ramp_robot::{EventKind, Track};
use ramp_testing::GoalFiles;
use ramp_twin::{Setup, Start};

fn notes(result: &EpisodeResult) -> Vec<String> {
    let note = |kind: &EventKind| if let EventKind::Note { text } = kind { Some(text.clone()) } else { None };
    result.events.iter().filter_map(|event| note(&event.kind)).collect()
}

/// Beams lie where the frame is to stand: the baseline takes them away, says so, and builds.
#[test]
fn a_scattered_goal_is_built_after_its_place_is_cleared() {
    let files = GoalFiles::new("easy-1");
    let setup = Setup { start: Start::scattered(), ..files.setup(Track::State, 1) };
    let result = files.run_setup(&setup);
    let notes = notes(&result);
    assert!((result.completion - 1.0).abs() < 1e-12, "{:?}", result.events);
    assert!(
        notes.iter().any(|it| it.contains(" lies where the frame is to stand: laid down at x ")),
        "{notes:?}"
    );
}

/// Without tags the beams are found from above, told apart from near, and named by their places: the right
/// ones are built in.
#[test]
fn a_scattered_goal_is_built_without_tags() {
    let files = GoalFiles::new("easy-1");
    let setup = Setup { start: Start::scattered(), ..files.setup(Track::Colour, 1) };
    let result = files.run_setup(&setup);
    assert!((result.completion - 1.0).abs() < 1e-12, "{:?}", result.events);
    assert!(notes(&result).iter().all(|note| !note.starts_with("not found")), "{:?}", notes(&result));
}

/// From a jumble the baseline does not build: it says why, and does not begin.
#[test]
fn a_jumble_ends_with_its_reason() {
    let files = GoalFiles::new("easy-1");
    for track in [Track::State, Track::Tags, Track::Colour] {
        let setup = Setup { start: Start::jumbled(), ..files.setup(track, 1) };
        let result = files.run_setup(&setup);
        assert_eq!(result.completion, 0.0);
        let why: Vec<String> = result
            .events
            .iter()
            .filter_map(|event| match &event.kind {
                EventKind::Fault(fault) => Some(fault.to_string()),
                _ => None,
            })
            .collect();
        let true_reason = ["face down", "does not lie flat", "was not found", "pegs stand in holders"];
        assert!(
            why.last().is_some_and(|why| true_reason.iter().any(|reason| why.contains(reason))),
            "{track:?}: {why:?}"
        );
    }
}
