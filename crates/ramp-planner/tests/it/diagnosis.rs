//! Diagnoses from actions and observations, and plans that continue from them.

use crate::common::{domains, goal, replay};
use ramp_planner::{Area, CoarseAction, Diagnosis, History, PlanError, Record, State, diagnose, plan};

/// The plan for a goal up to and with its `count`-th action of a kind, then the observations. The
/// position of the hand and whether it closed on something are observed all along.
fn history(name: &str, wanted: impl Fn(&CoarseAction) -> bool, count: usize, seen: &[&str]) -> History {
    let steps = plan(&goal(name), &State::default(), domains()).unwrap().steps;
    let actions: Vec<CoarseAction> = steps.into_iter().map(|step| step.coarse).collect();
    let last = actions.iter().enumerate().filter(|(_, action)| wanted(action)).nth(count - 1).unwrap().0;
    let mut records = Vec::new();
    for action in &actions[..=last] {
        records.push(Record::Did(action.clone()));
        let felt = match action {
            CoarseAction::Move { to: Area::Input } => "at(input)",
            CoarseAction::Move { to: Area::Intermediate } => "at(intermediate)",
            CoarseAction::Move { to: Area::Assembly } => "at(assembly)",
            CoarseAction::PickUp { .. } => "full",
            _ => continue,
        };
        records.push(Record::Saw(felt.to_string()));
    }
    records.extend(seen.iter().map(|text| Record::Saw(text.to_string())));
    History { start: State::default(), records, planned: actions[last + 1..].to_vec() }
}

fn explain(name: &str, history: &History) -> Vec<Diagnosis> {
    diagnose(&goal(name), domains(), history).unwrap()
}

fn events(found: &[Diagnosis]) -> Vec<Vec<&str>> {
    found.iter().map(|d| d.events.iter().map(|event| event.event.as_str()).collect()).collect()
}

/// From the belief there is a legal plan.
fn goes_on(name: &str, found: &[Diagnosis]) {
    let assembly = goal(name);
    for diagnosis in found {
        let rest = plan(&assembly, &diagnosis.state, domains()).unwrap();
        assert_eq!(replay(&assembly, &diagnosis.state, &rest.steps), Ok(()), "{diagnosis:?}");
    }
}

fn assembles(action: &CoarseAction) -> bool {
    matches!(action, CoarseAction::Assemble { .. })
}

fn fastens(action: &CoarseAction) -> bool {
    matches!(action, CoarseAction::Fasten { .. })
}

#[test]
fn where_all_went_well_nothing_is_to_be_explained() {
    let history = history("easy-3", fastens, 2, &["pinned(C2)", "in_assembly(b5)", "-in_hand(beam(b8))"]);
    let found = explain("easy-3", &history);
    assert_eq!(events(&found), [Vec::<&str>::new()]);
    assert_eq!(found[0].state.fastened.len(), 2);
    goes_on("easy-3", &found);
}

#[test]
fn a_peg_that_is_gone_was_dropped() {
    let move_on = |action: &CoarseAction| matches!(action, CoarseAction::Move { .. });
    // After the peg was picked up, over the assembly.
    let history = history("easy-1", move_on, 6, &["-in_hand(peg(C1))", "-pinned(C1)"]);
    let found = explain("easy-1", &history);
    assert!(events(&found).contains(&vec!["drop_peg(\"C1\")"]), "{found:?}");
    let dropped = found.iter().find(|d| d.events[0].event.starts_with("drop_peg")).unwrap();
    assert_eq!(dropped.state.lost_pegs, ["p1"]);
    goes_on("easy-1", std::slice::from_ref(dropped));
}

#[test]
fn a_beam_that_did_not_go_in_slipped_or_jammed_or_nothing_happened() {
    let history = history("easy-3", assembles, 2, &["-in_assembly(b5)", "in_hand(beam(b5))", "pinned(C1)"]);
    let found = explain("easy-3", &history);
    let all = events(&found);
    for event in ["slip(\"b5\")", "jam(\"b5\")", "no_effect(assemble(\"b5\"))"] {
        assert!(all.contains(&vec![event]), "{event} is not in {all:?}");
    }
    assert_eq!(all.len(), 3, "{all:?}");
    // A slipped beam is put down and grasped anew.
    let slipped = found.iter().find(|d| d.events[0].event.starts_with("slip")).unwrap();
    assert!(slipped.state.slipped);
    goes_on("easy-3", &found);
}

#[test]
fn a_beam_that_moved_was_bumped() {
    let history = history("easy-3", assembles, 2, &["-aligned(b5)", "in_assembly(b5)"]);
    let found = explain("easy-3", &history);
    assert!(events(&found).contains(&vec!["bump(\"b5\")"]), "{found:?}");
    goes_on("easy-3", &found);
}

#[test]
fn two_things_can_go_wrong() {
    let move_on = |action: &CoarseAction| matches!(action, CoarseAction::Move { .. });
    // The hand is over the assembly with the first peg.
    let history = history("easy-3", move_on, 6, &["-full", "-aligned(b4)"]);
    let found = explain("easy-3", &history);
    assert_eq!(events(&found), [["drop_peg(\"C1\")", "bump(\"b4\")"]], "{found:?}");
    goes_on("easy-3", &found);
}

#[test]
fn what_cannot_be_has_no_explanation() {
    let history = history("easy-3", assembles, 1, &["in_assembly(b8)"]);
    assert!(explain("easy-3", &history).is_empty());
}

#[test]
fn an_observation_that_means_nothing_is_refused() {
    for text in ["in_assembly(b77)", "likes(b4)", "in_assembly(", ""] {
        let records = vec![Record::Saw(text.to_string())];
        let outcome = diagnose(&goal("easy-1"), domains(), &History { records, ..History::default() });
        assert!(matches!(outcome, Err(PlanError::ImpossibleState { .. })), "{text}: {outcome:?}");
    }
}
