//! Plans of the shipped goals: golden, legal, necessary, repeatable, and from any partial assembly.

use crate::common::{EASY, HARDER, domains, goal, replay};
use ramp_assembly::Assembly;
use ramp_planner::{CoarseAction, CoarseStep, Item, Plan, PlanError, Replayer, State, plan};
use std::path::Path;

fn fresh(assembly: &Assembly) -> Plan {
    plan(assembly, &State::default(), domains()).unwrap()
}

fn pushes(steps: &[CoarseStep]) -> usize {
    steps.iter().filter(|step| matches!(step.coarse, CoarseAction::Push { .. })).count()
}

/// `RAMP_UPDATE_GOLDEN=1 cargo test` writes the files anew; read the difference before you commit it.
#[test]
fn plans_are_as_written_down() {
    for name in EASY.into_iter().chain(HARDER) {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{name}.txt"));
        let text = fresh(&goal(name)).to_string();
        if std::env::var_os("RAMP_UPDATE_GOLDEN").is_some() {
            std::fs::write(&file, &text).unwrap();
        }
        let golden = std::fs::read_to_string(&file).unwrap();
        assert!(text == golden, "{name} has another plan than {}:\n{text}", file.display());
    }
}

#[test]
fn plans_are_legal_and_reach_the_goal() {
    for name in EASY.into_iter().chain(HARDER) {
        let assembly = goal(name);
        let plan = fresh(&assembly);
        assert_eq!(replay(&assembly, &State::default(), &plan.steps), Ok(()), "{name}\n{plan}");
        assert!(plan.statistics.lower_bound <= plan.steps.len(), "{name}");
        assert!(plan.statistics.solves > 0);
    }
}

/// The actions of a plan without moving and picking up, in words.
fn work(plan: &Plan) -> Vec<String> {
    let moves =
        |step: &&CoarseStep| matches!(step.coarse, CoarseAction::Move { .. } | CoarseAction::PickUp { .. });
    plan.steps.iter().filter(|step| !moves(step)).map(|step| step.coarse.to_string()).collect()
}

/// A beam that no peg holds is pushed away by the beam that goes into it. Pushed back, it would drag that
/// one out of the clamped beam, unless a peg holds it there.
#[test]
fn a_peg_comes_before_a_push_that_would_drag_its_beam_along() {
    for (name, peg, push) in
        [("small-04", "fasten C1 with p1", "push b9"), ("small-06", "fasten C4 with p1", "push b8")]
    {
        let work = work(&fresh(&goal(&format!("open-2026/open-2026-{name}"))));
        let position = |action: &str| work.iter().position(|other| other == action);
        assert!(position(peg).is_some() && position(peg) < position(push), "{name}: {work:?}");
    }
}

#[test]
fn the_rectangle_is_aligned_just_before_it_is_capped() {
    let work = work(&fresh(&goal("easy-3")));
    let expected = [
        "assemble b4",
        "fasten C1 with p1",
        "assemble b5",
        "fasten C2 with p2",
        "push b4",
        "push b5",
        "assemble b8",
        "fasten C3 with p3",
        "fasten C4 with p4",
    ];
    assert_eq!(work, expected);
}

#[test]
fn no_action_can_be_left_out() {
    for name in EASY {
        let assembly = goal(name);
        let steps = fresh(&assembly).steps;
        for index in 0..steps.len() {
            let mut fewer = steps.clone();
            let left_out = fewer.remove(index);
            let outcome = replay(&assembly, &State::default(), &fewer);
            assert!(outcome.is_err(), "{name} works without step {}, {}", index + 1, left_out.coarse);
            for fine in 0..steps[index].fine.len() {
                let mut fewer = steps.clone();
                let left_out = fewer[index].fine.remove(fine);
                let outcome = replay(&assembly, &State::default(), &fewer);
                assert!(outcome.is_err(), "{name} works without {left_out} in step {}", index + 1);
            }
        }
    }
}

#[test]
fn no_two_actions_can_be_swapped() {
    for name in EASY {
        let assembly = goal(name);
        let steps = fresh(&assembly).steps;
        for first in 0..steps.len() {
            for second in first + 1..steps.len() {
                let both = [&steps[first].coarse, &steps[second].coarse];
                // Consecutive pushes may change places.
                let pushes = both.iter().all(|action| matches!(action, CoarseAction::Push { .. }));
                if steps[first] == steps[second] || (pushes && second == first + 1) {
                    continue;
                }
                let mut swapped = steps.clone();
                swapped.swap(first, second);
                let outcome = replay(&assembly, &State::default(), &swapped);
                assert!(outcome.is_err(), "{name} works with {} and {} swapped", both[0], both[1]);
            }
            for fine in 1..steps[first].fine.len() {
                let mut swapped = steps.clone();
                swapped[first].fine.swap(fine - 1, fine);
                let outcome = replay(&assembly, &State::default(), &swapped);
                assert!(outcome.is_err(), "{name} works with fine actions of step {} swapped", first + 1);
            }
        }
    }
}

#[test]
fn every_half_built_state_has_a_plan() {
    for name in EASY.into_iter().chain(["medium-2", "hard-3"]) {
        let assembly = goal(name);
        let whole = fresh(&assembly).steps;
        for done in 1..=whole.len() {
            let mut table = Replayer::new(&assembly, domains(), &State::default()).unwrap();
            // What is left undone is refused, but only at the end.
            assert_eq!(table.run(&whole[..done]).is_ok(), done == whole.len());
            let state = table.state();
            let rest = plan(&assembly, &state, domains()).unwrap();
            assert_eq!(replay(&assembly, &state, &rest.steps), Ok(()), "{name} after step {done}\n{rest}");
            // Nothing is done twice.
            assert!(rest.steps.len() <= whole.len() - done, "{name} after step {done}\n{rest}");
            assert!(pushes(&rest.steps) <= pushes(&whole[done..]), "{name} after step {done}\n{rest}");
        }
    }
}

#[test]
fn any_beams_that_stand_have_a_plan_or_a_reason_against_it() {
    let mut outcomes = [0, 0];
    for name in EASY {
        let assembly = goal(name);
        let beams: Vec<&str> = assembly.beams.iter().map(|placed| placed.beam.name.as_str()).collect();
        // Every subset that contains the base.
        for subset in (0..1_usize << beams.len()).filter(|subset| subset >> assembly.base & 1 == 1) {
            let stands = |index: usize| subset >> index & 1 == 1;
            let in_assembly: Vec<String> = (0..beams.len())
                .filter(|&index| stands(index))
                .map(|index| beams[index].to_string())
                .collect();
            let closed = assembly
                .connections
                .iter()
                .filter(|pair| stands(pair.female.beam) && stands(pair.male.beam))
                .enumerate()
                .map(|(index, pair)| (pair.name.clone(), format!("p{}", index + 1)));
            let off: Vec<String> = in_assembly.iter().filter(|beam| *beam != "b7").cloned().collect();
            for (fastened, misaligned) in [(closed.collect(), vec![]), (vec![], off)] {
                let state =
                    State { in_assembly: in_assembly.clone(), fastened, misaligned, ..State::default() };
                match plan(&assembly, &state, domains()) {
                    Ok(plan) => {
                        assert_eq!(
                            replay(&assembly, &state, &plan.steps),
                            Ok(()),
                            "{name} {state:?}\n{plan}"
                        );
                        outcomes[0] += 1;
                    }
                    Err(PlanError::Illegal { .. } | PlanError::NoOrder { .. }) => outcomes[1] += 1,
                    Err(error) => panic!("{name} {state:?}: {error}"),
                }
            }
        }
    }
    // Only a beam without support, or one in the way, has no plan.
    assert!(outcomes[0] > outcomes[1] && outcomes[1] > 0, "{outcomes:?}");
}

#[test]
fn a_beam_that_stands_off_its_place_is_pushed_before_its_peg() {
    let state =
        State { in_assembly: vec!["b4".to_string()], misaligned: vec!["b4".to_string()], ..State::default() };
    let plan = plan(&goal("easy-1"), &state, domains()).unwrap();
    assert_eq!(replay(&goal("easy-1"), &state, &plan.steps), Ok(()));
    let work: Vec<String> = plan.steps.iter().map(|step| step.coarse.to_string()).take(9).collect();
    assert_eq!(work[2], "push b4");
    assert_eq!(work[8], "fasten C1 with p1");
    assert!(!plan.statistics.optimal, "what a push before the first item costs is not proven");
}

#[test]
fn pegs_are_taken_in_the_order_of_the_kit() {
    let state = State {
        in_assembly: vec!["b4".to_string()],
        fastened: vec![("C1".to_string(), "p2".to_string())],
        lost_pegs: vec!["p1".to_string(), "p4".to_string()],
        ..State::default()
    };
    let plan = plan(&goal("easy-3"), &state, domains()).unwrap();
    assert_eq!(replay(&goal("easy-3"), &state, &plan.steps), Ok(()));
    let pegs: Vec<&str> = plan
        .steps
        .iter()
        .filter_map(|step| match &step.coarse {
            CoarseAction::PickUp { item: Item::Peg(peg) } => Some(peg.as_str()),
            _ => None,
        })
        .collect();
    assert_eq!(pegs, ["p3", "p5", "p6"]);
}

#[test]
fn the_same_input_gives_the_same_plan() {
    for name in EASY.into_iter().chain(["hard-1"]) {
        let assembly = goal(name);
        let first = fresh(&assembly);
        assert_eq!(first, fresh(&assembly), "{name}");
        std::thread::scope(|scope| {
            let others = [0, 1].map(|_| scope.spawn(|| fresh(&assembly)));
            for other in others {
                assert_eq!(first, other.join().unwrap(), "{name} in another thread");
            }
        });
    }
}

#[test]
fn names_need_not_be_names_of_the_rules() {
    let odd = |name: &str| format!("Not \"a\\name, {name}.");
    for name in EASY {
        let mut assembly = goal(name);
        for placed in &mut assembly.beams {
            placed.beam.name = odd(&placed.beam.name);
            placed.beam.joints.iter_mut().for_each(|joint| joint.name = odd(&joint.name));
            placed.beam.links.iter_mut().for_each(|link| link.name = odd(&link.name));
        }
        assembly.connections.iter_mut().for_each(|connection| connection.name = odd(&connection.name));
        let renamed = plan(&assembly, &State::default(), domains()).unwrap().to_string();
        let plain = renamed.replace("Not \"a\\name, ", "");
        let expected = fresh(&goal(name)).to_string();
        assert_eq!(plain.replace('.', ""), expected);
    }
}
