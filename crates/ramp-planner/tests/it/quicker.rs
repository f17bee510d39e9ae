//! Pegs and fastenings are swapped to reduce the travel cost, and the rules accept the result.

use crate::common::{domains, goal, replay};
use ramp_planner::{CoarseAction, CoarseStep, Item, Place, State, Target, plan, quicker};

/// The connections in the order in which they are pinned, each with its peg.
fn fastened(steps: &[CoarseStep]) -> Vec<(String, String)> {
    let pairs = steps.iter().filter_map(|step| match &step.coarse {
        CoarseAction::Fasten { connection, peg } => Some((connection.clone(), peg.clone())),
        _ => None,
    });
    pairs.collect()
}

/// An expensive peg is left in its holder, and each hole gets the cheapest peg.
#[test]
fn ways_that_cost_less_are_taken() {
    let (goal, state) = (goal("medium-3"), State::default());
    let usual = plan(&goal, &state, domains()).unwrap();
    let dear = |place: &Place| matches!(place, Place::Input(Item::Peg(peg)) if peg == "p1");
    let mut cost = |from: &Place, to: &Place| u64::from(dear(from) || dear(to)) + 1;
    let (found, saved) = quicker(&goal, &state, domains(), &usual, &mut cost).unwrap();
    // To the peg and away from it.
    assert_eq!(saved, 2);
    assert_eq!(found.steps.len(), usual.steps.len());
    assert!(fastened(&usual.steps).iter().any(|(_, peg)| peg == "p1"));
    assert!(fastened(&found.steps).iter().all(|(_, peg)| peg != "p1"));
    assert_eq!(replay(&goal, &state, &found.steps), Ok(()));

    // Each peg of the kit is best for another hole than in the usual plan.
    let order: Vec<String> = fastened(&usual.steps).into_iter().map(|(connection, _)| connection).collect();
    let rank = |place: &Place| match place {
        Place::Target(Target::Connection(name)) => order.iter().position(|other| other == name),
        _ => None,
    };
    let mut cost = |from: &Place, to: &Place| match (from, to) {
        (Place::Input(Item::Peg(peg)), hole) => {
            let number: usize = peg.trim_start_matches('p').parse().unwrap();
            rank(hole).map_or(0, |rank| (rank + number) as u64 % 7)
        }
        _ => 0,
    };
    let (found, saved) = quicker(&goal, &state, domains(), &usual, &mut cost).unwrap();
    assert!(saved > 0);
    assert_eq!(replay(&goal, &state, &found.steps), Ok(()));
    let mut pegs: Vec<String> = fastened(&found.steps).into_iter().map(|(_, peg)| peg).collect();
    pegs.sort();
    pegs.dedup();
    assert_eq!(pegs.len(), order.len(), "a peg is used twice");
}

/// A peg that is lost, or already in use, is not a candidate.
#[test]
fn pegs_that_are_gone_are_not_taken() {
    let (goal, state) = (goal("easy-1"), State { lost_pegs: vec!["p9".to_string()], ..State::default() });
    let usual = plan(&goal, &state, domains()).unwrap();
    // The lost one would be the cheapest by far.
    let cheap = |place: &Place| matches!(place, Place::Input(Item::Peg(peg)) if peg == "p9");
    let mut cost = |from: &Place, to: &Place| 10 - 9 * u64::from(cheap(from) || cheap(to));
    let (found, saved) = quicker(&goal, &state, domains(), &usual, &mut cost).unwrap();
    assert_eq!((found.steps, saved), (usual.steps, 0));
}
