//! The real program in a temporary folder, as a user has it.

use std::path::Path;

use crate::ramp;
use ramp_testing::program::text;
use tempfile::TempDir;

/// Status 2, one message that holds all of `words`, nothing on standard output, nothing written.
fn refused(folder: &TempDir, arguments: &[&str], words: &[&str]) {
    let before = std::fs::read_dir(folder).unwrap().count();
    let output = ramp(folder, arguments);
    // miette wraps long lines and draws a border: compare without either.
    let message: String = text(&output.stderr)
        .replace(['│', '╭', '╰', '─', '·'], " ")
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ");
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
    for word in words {
        assert!(message.contains(word), "{arguments:?} should say `{word}`: {message}");
    }
    assert!(!message.contains("panicked"), "{message}");
    assert_eq!(before, std::fs::read_dir(folder).unwrap().count(), "{arguments:?} wrote something");
}

fn write(folder: &TempDir, name: &str, content: &str) {
    std::fs::write(folder.path().join(name), content).unwrap();
}

/// Without the feature, a station is refused at once, and what it needs is told.
#[test]
fn a_station_needs_the_feature_of_the_wire() {
    if cfg!(feature = "franka") {
        return;
    }
    let folder = TempDir::new().unwrap();
    let words = ["built without Franka's protocol", "--features franka"];
    refused(&folder, &["run", "easy-1", "--robot", "station.toml", "--yes"], &words);
    refused(&folder, &["run", "easy-1", "--yes"], &["--robot <FILE>"]);
    refused(
        &folder,
        &["run", "easy-1", "--robot", "station.toml", "--fault", "jam"],
        &["cannot be used with"],
    );
}

#[test]
fn goals_lists_the_nine() {
    let folder = TempDir::new().unwrap();
    let output = ramp(&folder, &["goals"]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(text(&output.stdout).lines().count(), 1 + 9);
    let json: serde_json::Value =
        serde_json::from_slice(&ramp(&folder, &["goals", "--json"]).stdout).unwrap();
    assert_eq!(json.as_array().unwrap().len(), 9);
    assert_eq!(json[6]["name"], "hard-1");
    assert_eq!(json[6]["pegs"], 15);
}

#[test]
fn check_says_that_each_goal_can_be_built() {
    let folder = TempDir::new().unwrap();
    let goals: serde_json::Value =
        serde_json::from_slice(&ramp(&folder, &["goals", "--json"]).stdout).unwrap();
    for goal in goals.as_array().unwrap() {
        let output = ramp(&folder, &["check", goal["name"].as_str().unwrap(), "--json"]);
        assert_eq!(output.status.code(), Some(0));
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(report["good"], true);
        for connection in report["connections"].as_array().unwrap() {
            assert!(connection["residual"].as_f64().unwrap() <= 0.01e-3);
        }
    }
}

#[test]
fn show_draws_svg_and_png() {
    let folder = TempDir::new().unwrap();
    let svg = ramp(&folder, &["show", "easy-3"]);
    assert!(text(&svg.stdout).starts_with("<svg"));
    assert_eq!(ramp(&folder, &["show", "easy-3", "-o", "goal.png"]).status.code(), Some(0));
    let png = std::fs::read(folder.path().join("goal.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG"));
    refused(&folder, &["show", "easy-3", "-o", "goal.gif"], &["neither an SVG nor a PNG"]);
}

#[test]
fn plan_prints_coarse_and_fine_actions() {
    let folder = TempDir::new().unwrap();
    let output = ramp(&folder, &["plan", "easy-3", "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let steps = json["plan"]["steps"].as_array().unwrap();
    assert!(steps.len() > 30);
    assert!(steps.iter().all(|step| !step["fine"].as_array().unwrap().is_empty()));
    assert!(text(&ramp(&folder, &["plan", "easy-1"]).stdout).contains("fasten C1"));
}

/// The main job: planned, built and scored, with a result that follows the schema and a curve beside it.
#[test]
fn run_builds_easy_1_and_prints_and_writes_what_the_readme_shows() {
    let folder = TempDir::new().unwrap();
    let output =
        ramp(&folder, &["run", "easy-1", "--track", "state", "--seed", "12", "--scene", "scene.xml"]);
    let (said, told) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{said}{told}");
    assert!(said.contains("3 of 3 pegs"), "{said}");
    crate::docs::has_the_form_of_the_sample(&said);
    let file = |ending: &str| format!("results/easy-1-12.{ending}");
    for file in ["json", "svg", "mcap"].map(file) {
        assert!(said.contains(&file) && folder.path().join(&file).exists(), "{said}");
    }
    assert!(told.contains("fasten C1"), "progress goes to standard error: {told}");
    let result: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join(file("json"))).unwrap()).unwrap();
    // Another run does not silently take its place.
    let other = ["run", "easy-1", "--track", "noisy", "--seed", "12"];
    refused(&folder, &other, &["results/easy-1-12.json exists already", "--force"]);
    let schema = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/schema/episode.schema.json");
    let schema: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(schema).unwrap()).unwrap();
    assert!(jsonschema::is_valid(&schema, &result));
    assert_eq!(result["seed"], 12);
    assert_eq!(result["completion"], 1.0);
    // The bound and the reference of the robot time equal those of the planner, and no arm is faster than the
    // bound.
    let plan = ramp(&folder, &["plan", "easy-1", "--check-motion", "--bound", "--json"]);
    let plan: serde_json::Value = serde_json::from_slice(&plan.stdout).unwrap();
    assert_eq!(result["robot_time"], plan["robot_time"]);
    let seconds = |value: &serde_json::Value| value.as_f64().unwrap();
    let (bound, reference) =
        (seconds(&result["robot_time"]["bound"]), seconds(&result["robot_time"]["reference"]));
    assert!(0.0 < bound && bound < reference && reference < seconds(&result["time"]["robot"]), "{result}");
    let compared = format!("bound {bound:.1} s, reference {reference:.1} s");
    assert!(said.contains(&compared), "{said}");
    assert!(std::fs::read_to_string(folder.path().join(file("svg"))).unwrap().contains("easy-1: 100 %"));
    let scene = std::fs::read_to_string(folder.path().join("scene.xml")).unwrap();
    assert!(scene.contains("<key name=\"start\"") && scene.contains("<key name=\"end\""));
}

#[test]
fn an_unknown_goal_suggests_the_nearest() {
    let folder = TempDir::new().unwrap();
    for command in ["check", "show", "plan", "run"] {
        refused(&folder, &[command, "easy-33"], &["easy-33", "did you mean `easy-3`?"]);
    }
    refused(&folder, &["check", "nowhere/goal.xml"], &["goal.xml"]);
}

#[test]
fn bad_usage_is_refused() {
    let folder = TempDir::new().unwrap();
    refused(&folder, &["run"], &["GOAL"]);
    refused(&folder, &["fly", "easy-1"], &["fly"]);
    refused(&folder, &["run", "easy-1", "--seed", "three"], &["seed", "three"]);
    refused(&folder, &["run", "easy-1", "--track", "telepathy"], &["telepathy"]);
    write(&folder, "file", "");
    refused(&folder, &["run", "easy-1", "-o", "file/out.json"], &["file is no folder"]);
    refused(&folder, &["run", "easy-1", "-o", "out.svg"], &["where the curve goes"]);
    refused(&folder, &["run", "easy-1", "-o", "out.mcap"], &["where the log goes"]);
    refused(&folder, &["run", "easy-1", "--record", "file/out.mcap"], &["file is no folder"]);
    refused(&folder, &["run", "easy-1", "--agent-limit", "nan"], &["a number of seconds"]);
    refused(&folder, &["run", "easy-1", "--video", "film.avi"], &["neither a GIF nor an MP4"]);
    refused(&folder, &["replay", "nowhere.mcap"], &["nowhere.mcap"]);
    refused(&folder, &["--data", "nowhere", "goals"], &["no kit.xml"]);
}

/// The forms of a broken goal that the issue of the main job lists.
#[test]
fn broken_goals_are_refused_at_their_line_and_column() {
    let folder = TempDir::new().unwrap();
    let goal = |components: &str, connections: &str| {
        format!("<assembly>\n{components}\n{connections}\n</assembly>\n")
    };
    let b7b4 = "<component beam=\"b7\" base=\"True\"/>\n<component beam=\"b4\"/>";
    let connect = |a: &str, b: &str| {
        let beam = |joint: &str| joint[..2].to_string();
        format!(
            "<connection name=\"C1\"><element component=\"{}\" joint=\"{a}\"/><element component=\"{}\" joint=\"{b}\"/></connection>",
            beam(a),
            beam(b)
        )
    };
    let c1 = connect("b4j1", "b7j1");
    let cases: Vec<(String, Vec<&str>)> = vec![
        ("<assembly><component".to_string(), vec!["bad.xml:1:"]),
        (
            goal("<component beam=\"b7\" base=\"True\"/>\n<component beam=\"b44\"/>", &c1),
            vec!["bad.xml:3:", "b44", "b4"],
        ),
        (goal(b7b4, &connect("b4j9", "b7j1")), vec!["bad.xml:4:", "b4j9"]),
        (
            goal(
                "<component beam=\"b7\" base=\"True\"/>\n<component beam=\"b8\" flipped=\"True\"/>",
                &connect("b8j1", "b7j1"),
            ),
            vec!["bad.xml:4:", "female"],
        ),
        (
            goal(
                "<component beam=\"b7\" base=\"True\"/>\n<component beam=\"b4\"/><component beam=\"b1\"/>",
                &format!("{c1}\n{}", connect("b4j3", "b1j1").replace("C1", "C2")),
            ),
            vec!["bad.xml:5:", "male"],
        ),
        (
            goal(
                "<component beam=\"b7\" base=\"True\"/>\n<component beam=\"b4\"/><component beam=\"b5\"/>",
                &format!("{c1}\n{}", connect("b5j1", "b7j1").replace("C1", "C2")),
            ),
            vec!["bad.xml:5:", "b7j1"],
        ),
        (goal(b7b4, &connect("b4j1", "b4j2")), vec!["bad.xml:4:", "b4"]),
        (goal("<component beam=\"b7\"/>\n<component beam=\"b4\"/>", &c1), vec!["base"]),
        (
            goal("<component beam=\"b7\" base=\"True\"/>\n<component beam=\"b4\" base=\"True\"/>", &c1),
            vec!["bad.xml:3:", "base"],
        ),
        (
            goal(
                "<component beam=\"b7\" base=\"True\"/>\n<component beam=\"b4\"/><component beam=\"b8\" flipped=\"True\"/><component beam=\"b5\"/>",
                &format!(
                    "{c1}\n{}\n{}\n{}",
                    connect("b5j1", "b7j3").replace("C1", "C2"),
                    connect("b4j3", "b8j1").replace("C1", "C3"),
                    connect("b5j3", "b8j5").replace("C1", "C4")
                ),
            ),
            vec!["bad.xml:"],
        ),
    ];
    for (content, words) in &cases {
        write(&folder, "bad.xml", content);
        for command in ["check", "run"] {
            refused(&folder, &[command, "./bad.xml"], words);
        }
    }
}

/// The typo of the published beam set: a link whose child names itself must be an error, never a hang.
#[test]
fn a_kit_whose_link_names_itself_is_refused() {
    let folder = TempDir::new().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let kit = std::fs::read_to_string(data.join("kit.xml")).unwrap();
    let at = kit.find("<joint name=\"b2j1\"").unwrap();
    let broken =
        format!("{}{}", &kit[..at], kit[at..].replacen("<child link=\"b2l1\"", "<child link=\"b2j1\"", 1));
    assert_ne!(kit, broken);
    let line = kit[..at].lines().count();
    write(&folder, "kit.xml", &broken);
    let place = format!("kit.xml:{}", line + 1);
    refused(&folder, &["--data", ".", "goals"], &[&place[..place.len() - 1], "b2j1"]);
}

#[test]
fn view_without_a_window_says_how_to_get_one() {
    if cfg!(feature = "view") {
        return;
    }
    let folder = TempDir::new().unwrap();
    refused(&folder, &["run", "easy-1", "--view"], &["without a window", "--features view"]);
    #[cfg(not(feature = "franka"))]
    refused(&folder, &["twin", "serve", "easy-1"], &["without Franka's protocol", "--features franka"]);
    #[cfg(not(feature = "rerun"))]
    refused(&folder, &["run", "easy-1", "--rerun", "it.rrd"], &["without Rerun", "--features rerun"]);
}

#[test]
fn a_closed_pipe_is_no_error() {
    let program = assert_cmd::cargo::cargo_bin("ramp");
    let output = std::process::Command::new("sh")
        .args(["-c", &format!("'{}' show hard-1 | head -c 10", program.display())])
        .output()
        .unwrap();
    assert!(!text(&output.stderr).contains("panicked"), "{}", text(&output.stderr));
}

/// Frames that cannot be taken apart are refused before anything is written.
#[test]
fn only_a_built_frame_on_the_sheet_is_taken_apart() {
    let folder = TempDir::new().unwrap();
    write(&folder, "mine.py", "");
    for (more, why) in [
        (["--start", "scattered"], "its parts have no places on the sheet"),
        (["--planner", "mine.py"], "--plan and --planner build frames"),
        (["--state", "state.json"], "cannot be used with"),
    ] {
        let arguments = [&["run", "easy-1", "--task", "take-apart", "-o", "apart.json"][..], &more].concat();
        refused(&folder, &arguments, &[why]);
    }
}
