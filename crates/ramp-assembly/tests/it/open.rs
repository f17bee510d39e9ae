//! Sets of the open class.

use ramp_assembly::{
    Class, Features, OpenGoal, OpenGoals, OpenSet, Size, generate::GenerateError, goal_names, read_goal,
    read_goal_str,
};
use ramp_kit::{Kit, read_kit};
use std::collections::BTreeSet;
use std::path::PathBuf;

fn data() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

/// The first goals of a set, with the checks of this crate alone.
fn set(kit: &Kit, seed: u64, count: usize) -> Vec<OpenGoal> {
    let folder = data().join("goals");
    let known: Vec<_> = goal_names(&folder)
        .unwrap()
        .iter()
        .map(|name| {
            read_goal(&folder.join(format!("{name}.xml")), &read_kit(&data().join("kit.xml")).unwrap())
                .unwrap()
        })
        .collect();
    let mut open = OpenGoals::new(kit, Class::Open(OpenSet::Seed(seed)), seed, &known).unwrap();
    std::iter::from_fn(|| open.next_goal(&mut |_| true).unwrap()).take(count).collect()
}

#[test]
fn a_set_has_twenty_goals_of_each_size_over_all_of_the_kit() {
    let kit = read_kit(&data().join("kit.xml")).unwrap();
    let goals = set(&kit, 1, 61);
    assert_eq!(goals.len(), 60);
    let mut types = BTreeSet::new();
    let mut beams = BTreeSet::new();
    for it in &goals {
        let goal = read_goal_str("open.xml", &it.goal.goal, &kit).unwrap_or_else(|e| panic!("{e:#}"));
        assert_eq!(Features::of(&goal), it.features, "{}", it.goal.name);
        assert!(it.size.beams().contains(&goal.beams.len()), "{}", it.goal.name);
        assert_eq!(Class::of_open_goal(&goal.name), goal.class, "{}", it.goal.name);
        assert_eq!(Size::of_goal_name(&goal.name), Some(it.size));
        for joint in goal.connections.iter().flat_map(|c| [c.female, c.male]) {
            types.insert(goal.beams[joint.beam].beam.joints[joint.joint].kind.name());
            beams.insert(goal.beams[joint.beam].beam.name.clone());
        }
    }
    for size in Size::ALL {
        let of_size: Vec<&OpenGoal> = goals.iter().filter(|it| it.size == size).collect();
        assert_eq!(of_size.len(), 20);
        let count = |is: fn(&Features) -> bool| of_size.iter().filter(|it| is(&it.features)).count();
        assert!(count(|it| it.oblique > 0) >= 3, "{}", size.name());
        assert!(count(|it| it.through > 0) >= 8, "{}", size.name());
        assert!(count(|it| it.oblique == 0 && it.through == 0) >= 4, "{}", size.name());
        assert!(count(|it| it.loops == 0) < 20 && count(|it| it.caps > 0) > 5, "{}", size.name());
    }
    assert_eq!(types.len(), 7, "{types:?}");
    assert_eq!(beams.len(), kit.beams.len(), "{beams:?}");
    // The same seed again, and another one.
    let texts = |goals: &[OpenGoal]| goals.iter().map(|it| it.goal.goal.clone()).collect::<Vec<_>>();
    assert_eq!(texts(&set(&kit, 1, 10)), texts(&goals)[..10]);
    assert!(texts(&set(&kit, 2, 10)).iter().zip(texts(&goals)).all(|(one, other)| *one != other));
}

/// A goal of the set, its mirror image, and one with beams of the same shape exchanged are copies.
#[test]
fn copies_are_left_out() {
    let kit = read_kit(&data().join("kit.xml")).unwrap();
    let first = set(&kit, 5, 10);
    let swapped: Vec<_> = first
        .iter()
        .map(|it| {
            // b1 and b2 have one shape.
            let text = it.goal.goal.replace("\"b1", "\"x").replace("\"b2", "\"b1").replace("\"x", "\"b2");
            read_goal_str("swapped.xml", &text, &kit).unwrap_or_else(|e| panic!("{e:#}"))
        })
        .collect();
    let mut open = OpenGoals::new(&kit, Class::Open(OpenSet::Seed(5)), 5, &swapped).unwrap();
    let again: Vec<OpenGoal> =
        std::iter::from_fn(|| open.next_goal(&mut |_| true).unwrap()).take(10).collect();
    let essence = |text: &str| text.split("<component").skip(1).map(str::to_string).collect::<String>();
    for it in &again {
        assert!(
            first.iter().all(|other| essence(&other.goal.goal) != essence(&it.goal.goal)),
            "{}",
            it.goal.name
        );
    }
}

#[test]
fn a_kit_with_new_parts_gives_a_set_with_them() {
    let kit = read_kit(&data().join("examples/kit-45.xml")).unwrap();
    let goals = set(&kit, 1, 20);
    let with = goals.iter().filter(|it| it.goal.goal.contains("\"b10\"")).count();
    assert!(with >= 3, "{with}");
}

#[test]
fn a_kit_without_enough_parts_is_refused() {
    let mut kit = read_kit(&data().join("kit.xml")).unwrap();
    kit.beams.retain(|beam| ["b4", "b7"].contains(&beam.name.as_str()));
    let mut open = OpenGoals::new(&kit, Class::Open(OpenSet::Seed(1)), 1, &[]).unwrap();
    let mut next = || open.next_goal(&mut |_| true);
    let error = std::iter::from_fn(|| next().transpose()).find_map(Result::err).unwrap();
    assert!(matches!(error, GenerateError::NoOpenGoal { .. }), "{error}");
}
