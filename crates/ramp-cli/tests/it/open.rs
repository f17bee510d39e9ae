//! The open class: its published test set, held-out sets, and their way through bench and report.

use std::path::Path;

use crate::ramp;
use ramp_assembly::Class;
use ramp_data::Data;
use ramp_planner::State;
use ramp_result::sha256;
use ramp_testing::program::{text, words};
use serde_json::Value;
use tempfile::TempDir;

/// The published test set.
const SET: &str = "open-2026";
/// Its goals by name and SHA-256, as first published.
const PUBLISHED: &str = include_str!("../golden/open-2026.txt");

/// Standard output of a command that is done.
fn done(folder: &TempDir, arguments: &[&str]) -> String {
    let output = ramp(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

fn list(folder: &Path) -> String {
    let names = ramp_assembly::goal_names(folder).unwrap();
    let line = |name: String| {
        let goal = std::fs::read(folder.join(format!("{name}.xml"))).unwrap();
        format!("{}  {name}\n", sha256(&goal))
    };
    names.into_iter().map(line).collect()
}

/// The published set never changes.
#[test]
fn the_published_set_is_the_one_that_was_published() {
    let folder = TempDir::new().unwrap();
    let table = done(&folder, &["goals", "open", "--seed", "2026", "-o", "written"]);
    assert_eq!(table.lines().count(), 1 + 60 + 3, "{table}");
    assert_eq!(list(&folder.path().join("written")), PUBLISHED);
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/goals").join(SET);
    assert_eq!(list(&shipped), PUBLISHED);
    // A changed file is not lost.
    let file = folder.path().join("written/open-2026-large-20.xml");
    std::fs::write(&file, "mine").unwrap();
    let refused = ramp(&folder, &["goals", "open", "--seed", "2026", "-o", "written"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(words(&refused.stderr).contains("large-20.xml is there already"), "{}", text(&refused.stderr));
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "mine");
}

#[test]
fn every_goal_of_the_published_set_is_planned_in_time() {
    let data = Data::built_in();
    let domains = data.domains(None, None).unwrap();
    let names = data.open_goal_names(Class::of_name(SET).unwrap()).unwrap();
    assert_eq!(names.len(), 60);
    let mut longest = 0.0_f64;
    for name in names {
        let goal = data.goal(&name).unwrap();
        let begin = std::time::Instant::now();
        let plan = ramp_planner::plan(&goal, &State::default(), &domains).unwrap();
        longest = longest.max(begin.elapsed().as_secs_f64());
        assert!(!plan.steps.is_empty());
    }
    assert!(longest < 2.0, "{longest} s");
}

/// An organiser's secret draws the same set again, under the name that its commitment gives. It is a class of
/// the data that its folder is in.
#[test]
fn a_secret_gives_a_held_out_set() {
    let folder = TempDir::new().unwrap();
    done(&folder, &["seeds", "commit", "-o", "kept"]);
    done(&folder, &["data", "export", "mine"]);
    let commitment = std::fs::read_to_string(folder.path().join("kept/commitment.json")).unwrap();
    let commitment: Value = serde_json::from_str(&commitment).unwrap();
    let set = format!("open-held-{}", &commitment["commitment"].as_str().unwrap()[..8]);
    let inside = format!("mine/goals/{set}");
    let sets = ["held", &inside].map(|place| {
        done(&folder, &["goals", "open", "--secret", "kept/secret.json", "-o", place]);
        list(&folder.path().join(place))
    });
    assert_eq!(sets[0], sets[1]);
    assert!(sets[0].starts_with(|first: char| first.is_ascii_hexdigit()) && sets[0].lines().count() == 60);
    assert!(sets[0].contains(&format!("  {set}-small-01\n")), "{}", sets[0]);
    // None of its goals is one of the published set under another name.
    let frame = |folder: &Path, name: &str| {
        let text = std::fs::read_to_string(folder.join(format!("{name}.xml"))).unwrap();
        text.split_once("<component").unwrap().1.to_string()
    };
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/goals").join(SET);
    for size in ["small", "medium", "large"] {
        let (one, other) = (format!("{set}-{size}-01"), format!("{SET}-{size}-01"));
        assert_ne!(frame(&folder.path().join("held"), &one), frame(&shipped, &other), "{size}");
    }
    done(&folder, &["--data", "mine", "check", &format!("{set}-large-20")]);
    let outside = ramp(&folder, &["check", &format!("{set}-large-20")]);
    assert_eq!(outside.status.code(), Some(2));
}

/// A bench of a few goals: results name the set, sums are by size, and a goal that is there is not run again.
#[test]
fn a_bench_names_the_set_and_sums_its_sizes() {
    let folder = TempDir::new().unwrap();
    let agent = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/agents/good.py");
    let agent = agent.to_str().unwrap();
    std::fs::create_dir(folder.path().join("few")).unwrap();
    for name in ["small-02", "small-01", "medium-01"] {
        let goal = Data::built_in().goal_with_texts(&format!("{SET}-{name}")).unwrap().1;
        std::fs::write(folder.path().join(format!("few/{SET}-{name}.xml")), goal.sources().goal).unwrap();
    }
    let bench = ["bench", "few/", "--track", "state", "--repeats", "1", "--agent", agent, "-o", "out"];
    let table = words(done(&folder, &bench).as_bytes());
    let rows = [
        "open-2026-small-01 1/1",
        "open-2026-small-02 1/1",
        "open-2026-medium-01 1/1",
        "open-2026 small: 2 goals 2/2",
        "open-2026 medium: 1 goal 1/1",
        "open-2026: 3 goals 3/3",
    ];
    let places: Vec<usize> =
        rows.iter().map(|row| table.find(row).unwrap_or_else(|| panic!("{row}: {table}"))).collect();
    assert!(places.is_sorted(), "{table}");
    let file = folder.path().join("out/open-2026-small-01-state-1.json");
    let written = std::fs::read_to_string(&file).unwrap();
    let result: Value = serde_json::from_str(&written).unwrap();
    assert_eq!(result["class"], SET);
    let schema = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/schema/episode.schema.json");
    let schema = serde_json::from_str(&std::fs::read_to_string(schema).unwrap()).unwrap();
    assert!(jsonschema::is_valid(&schema, &result));
    // Computing times would differ.
    done(&folder, &bench);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), written);
    // By name, the goal is the same one.
    let by_name = ramp(&folder, &["bench", "open-2026-small-01", "few/", "-o", "both", "--track", "state"]);
    assert_eq!(by_name.status.code(), Some(2));
    assert!(words(&by_name.stderr).contains("two goals of the name"), "{}", text(&by_name.stderr));

    let report = done(&folder, &["report", "out", "-o", "report.html"]);
    for row in ["open-2026, small,", "open-2026, medium,", "open-2026, track state"] {
        assert!(report.contains(row), "{report}");
    }
}

#[test]
fn an_unknown_set_is_refused_with_the_way_to_one() {
    let folder = TempDir::new().unwrap();
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    for (arguments, expected) in [
        (&["bench", "open-7"][..], "there is no set open-7"),
        (&["show", "open-7", "-o", "a.svg"], "`ramp goals open` writes a set"),
        (&["check", "open-2026-small-21"], "there is no goal `open-2026-small-21`"),
        (&["bench", "empty/"], "there is no goal file in empty/"),
        (&["goals", "open"], "--seed"),
        (&["goals", "open", "--seed", "-1"], "unexpected argument"),
        (&["goals", "open", "--secret", "none.json"], "none.json"),
    ] {
        let output = ramp(&folder, arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let message = words(&output.stderr);
        assert!(message.contains(expected), "{message}");
    }
}
