//! A thousand generated goals: the replayer accepts every plan, and none with an action removed,
//! swapped or with another argument.

use crate::common::{domains, kit, replay};
use ramp_assembly::{Assembly, Generated, Request, generate_many};
use ramp_planner::{CoarseAction, CoarseStep, Options, PlanError, State, plan, plan_with};
use std::collections::BTreeSet;

/// Another beam than this one.
fn another(assembly: &Assembly, beam: &str) -> String {
    let names = assembly.beams.iter().map(|placed| placed.beam.name.clone());
    names.into_iter().find(|name| name != beam).unwrap()
}

/// The same plan with another argument in its `index`-th insertion or fastening.
fn with_another_argument(assembly: &Assembly, steps: &[CoarseStep], index: usize) -> Vec<CoarseStep> {
    let mut steps = steps.to_vec();
    let mut places: Vec<usize> = (0..steps.len()).collect();
    places.retain(|&place| {
        matches!(steps[place].coarse, CoarseAction::Assemble { .. } | CoarseAction::Fasten { .. })
    });
    let step = &mut steps[places[index % places.len()]];
    match &mut step.coarse {
        CoarseAction::Assemble { beam } => *beam = another(assembly, beam),
        CoarseAction::Fasten { peg, .. } => *peg = "p99".to_string(),
        _ => {}
    }
    steps
}

#[test]
fn plans_of_a_thousand_goals_are_accepted_and_wrong_ones_refused() {
    let goals: Vec<Generated> = (3..=7)
        .flat_map(|beams| generate_many(kit(), Request { beams, seed: 1, class: None }, 210).unwrap())
        .collect();
    // Four of sixteen for each, so that all threads get small and large ones.
    let planned: usize = std::thread::scope(|scope| {
        let goals = &goals;
        let checks: Vec<_> = (0..4)
            .map(|own| {
                let own = goals.iter().enumerate().filter(move |(number, _)| number / 4 % 4 == own);
                scope.spawn(move || own.filter(|(number, made)| check(*number, made)).count())
            })
            .collect();
        checks.into_iter().map(|check| check.join().unwrap()).sum()
    });
    assert!(planned >= 1000, "only {planned} goals have a plan");
}

/// Plans the goal with this number, and judges its plan and wrong variants. Returns whether there
/// is a plan.
fn check(number: usize, made: &Generated) -> bool {
    let assembly = &made.assembly;
    let steps = match plan(assembly, &State::default(), domains()) {
        Ok(found) => found.steps,
        // A male end that droops cannot be capped, and not every one can be pushed back.
        Err(PlanError::Illegal { why, .. }) if why.contains("droops") => return false,
        Err(error) => panic!("{}: {error}", made.name),
    };
    let outcome = |steps: &[CoarseStep]| replay(assembly, &State::default(), steps);
    assert_eq!(outcome(&steps), Ok(()), "{}", made.name);
    // One in four is enough for the wrong variants, each of which takes as long as the right one.
    if !number.is_multiple_of(4) {
        return true;
    }
    let index = number % (steps.len() - 1);
    let mut fewer = steps.clone();
    let left_out = fewer.remove(index).coarse;
    assert!(outcome(&fewer).is_err(), "{} without {left_out}", made.name);

    let is_push = |step: &CoarseStep| matches!(step.coarse, CoarseAction::Push { .. });
    if !(is_push(&steps[index]) && is_push(&steps[index + 1])) {
        let mut swapped = steps.clone();
        swapped.swap(index, index + 1);
        assert!(outcome(&swapped).is_err(), "{} with {left_out} one step later", made.name);
    }
    let other = with_another_argument(assembly, &steps, number);
    assert!(outcome(&other).is_err(), "{} with another argument", made.name);
    true
}

/// A large frame has a proven order, and so it has a plan.
#[test]
fn large_frames_that_can_be_built_are_planned() {
    for (beams, seed) in [(88, 1), (100, 1), (200, 1)] {
        let made = generate_many(kit(), Request { beams, seed, class: None }, 1).unwrap().remove(0);
        let options = Options { fine: false, ..Options::default() };
        let found = plan_with(&made.assembly, &State::default(), domains(), options).unwrap();
        let placed = found.entries.iter().map(|entry| &entry.beam).collect::<BTreeSet<_>>();
        assert_eq!(placed.len(), beams - 1, "{beams} beams");
        // Three to five actions in a hundred are beyond the bound.
        let bound = found.statistics.lower_bound;
        assert!(found.steps.len() * 20 <= bound * 21, "{} actions, bound {bound}", found.steps.len());
    }
}
