//! Generated goals: valid, different, reproducible and fast.

use ramp_assembly::generate::GenerateError;
use ramp_assembly::{Class, Request, generate, generate_many, read_goal, read_goal_str, report};
use ramp_kit::{Kit, read_kit, read_kit_str};
use std::collections::HashSet;
use std::path::PathBuf;
use std::time::Instant;

fn data() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

fn kit() -> Kit {
    read_kit(&data().join("kit.xml")).unwrap()
}

#[test]
fn a_thousand_goals_all_valid_all_different() {
    let kit = kit();
    let start = Instant::now();
    let mut seen = HashSet::new();
    let mut made = Vec::new();
    for beams in [4, 5, 7, 8] {
        made.extend(generate_many(&kit, Request { beams, seed: 1000, class: None }, 150).unwrap());
    }
    for class in [Class::Medium, Class::Hard] {
        made.extend(generate_many(&kit, Request { beams: 6, seed: 5000, class: Some(class) }, 200).unwrap());
    }
    assert_eq!(made.len(), 1000);
    let mut classes = [0; 3];
    for made in &made {
        // Read, placed and proven once more from its text alone.
        let goal = read_goal_str("made.xml", &made.goal, &kit).unwrap_or_else(|e| panic!("{e:#}"));
        assert_eq!(goal.class, Some(goal.likely_class()), "{}", made.goal);
        classes[Class::ALL.iter().position(|class| Some(*class) == goal.class).unwrap()] += 1;
        // The connections, sorted, and the poses.
        let mut lines: Vec<String> = Vec::new();
        for c in &goal.connections {
            lines.push(format!("{} {}", goal.joint_name(c.male), goal.joint_name(c.female)));
        }
        for placed in &goal.beams {
            let [x, y, _] = (placed.x_ab.translation.vector * 1e3).map(f64::round).into();
            lines.push(format!("{} {x} {y}", placed.beam.name));
        }
        lines.sort_unstable();
        seen.insert(lines);
    }
    let took = start.elapsed();
    println!("1000 goals in {took:?}: {classes:?}");
    assert_eq!(seen.len(), 1000);
    assert!(classes.iter().all(|count| *count > 20), "{classes:?}");
    assert!(took.as_secs() < 60, "{took:?}");
}

#[test]
fn every_goal_passes_the_check() {
    let kit = kit();
    for seed in 0..40 {
        let beams = 3 + (seed % 6) as usize;
        let made = generate(&kit, Request { beams, seed, class: None }).unwrap();
        let goal = read_goal_str("made.xml", &made.goal, &kit).unwrap_or_else(|e| panic!("{e:#}"));
        let report = report(&goal);
        assert!(report.overlaps.is_empty());
        assert_eq!(report.insertions.unwrap().len(), beams - 1);
        for fit in report.fits {
            assert!(fit.residual < 0.1e-3, "{fit:?}\n{}", made.goal);
            assert!(fit.gap > 0.0, "{fit:?}\n{}", made.goal);
        }
        let again = generate(&kit, Request { beams, seed, class: None }).unwrap();
        assert_eq!(again.goal, made.goal);
    }
}

#[test]
fn of_the_class_that_is_asked_for() {
    let kit = kit();
    for class in Class::ALL {
        for seed in 0..10 {
            let made = generate(&kit, Request { beams: 4, seed, class: Some(class) }).unwrap();
            assert_eq!(made.assembly.class, Some(class));
            assert_eq!(made.assembly.likely_class(), class, "{}", made.goal);
        }
    }
    // The nine goals of the benchmark have the classes that the rule gives.
    for name in ramp_assembly::goal_names(&data().join("goals")).unwrap() {
        let goal = read_goal(&data().join(format!("goals/{name}.xml")), &kit).unwrap();
        assert_eq!(goal.class, Some(goal.likely_class()), "{name}");
    }
}

#[test]
fn frames_of_any_size() {
    let kit = kit();
    for beams in [10, 20, 50, 100] {
        for (seed, class) in [(1, None), (2, Some(Class::Easy)), (3, Some(Class::Hard))] {
            let start = Instant::now();
            let request = Request { beams, seed, class };
            let made = generate(&kit, request).unwrap_or_else(|e| panic!("{beams}, {seed}: {e}"));
            let took = start.elapsed();
            println!("{beams} beams, {} pegs: {took:?}", made.assembly.connections.len());
            assert!(took.as_secs_f64() < 5.0, "{beams}: {took:?}");
            assert_eq!(made.assembly.beams.len(), beams);
            assert_eq!(made.assembly.insertions.len(), beams - 1);
            let extended = read_kit_str("kit.xml", made.kit.as_ref().unwrap()).unwrap();
            let goal = read_goal_str("made.xml", &made.goal, &extended).unwrap();
            assert!(report(&goal).overlaps.is_empty());
            // Insertions from above are rare: most beams are joined to placed ones.
            let above = goal.insertions.iter().filter(|insertion| insertion.direction.z != 0.0).count();
            assert!(above <= beams / 25, "{beams} beams, seed {seed}: {above} from above");
            let specials = goal.specials();
            match class {
                Some(Class::Easy) => assert_eq!(specials, 0),
                Some(Class::Hard) => assert!(specials > 0, "{beams}"),
                _ => {}
            }
            let again = generate(&kit, request).unwrap();
            assert_eq!((again.goal, again.kit), (made.goal, made.kit));
        }
    }
}

#[test]
fn requests_that_make_no_sense() {
    let kit = kit();
    for beams in [0, 1, 257, 100_000] {
        let error = generate(&kit, Request { beams, seed: 1, class: None }).unwrap_err();
        assert_eq!(error, GenerateError::Beams { found: beams });
    }
    let error = generate(&kit, Request { beams: 9, seed: 1, class: Some(Class::Easy) }).unwrap_err();
    assert_eq!(error.to_string(), "found no easy goal of 9 beams with the seed 1");
    let mut loose = kit.clone();
    loose.beams.retain(|beam| beam.start.is_some());
    assert_eq!(
        generate(&loose, Request { beams: 4, seed: 1, class: None }).unwrap_err(),
        GenerateError::NoBase
    );
}

/// A frame may run out of slots for its last beams. Then a new attempt starts.
#[test]
fn a_frame_without_room_for_its_last_beams_is_begun_anew() {
    let kit = kit();
    for seed in 1..=30 {
        let made = generate(&kit, Request { beams: 20, seed, class: None }).unwrap();
        assert_eq!(made.assembly.beams.len(), 20, "seed {seed}");
    }
}
