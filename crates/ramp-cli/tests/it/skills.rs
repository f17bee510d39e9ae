//! `ramp skills` and `--parameters` as a user has them: printed, overridden, refused.

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

/// Exit status, standard output and standard error of `ramp`.
fn ramp(folder: &TempDir, arguments: &[&str]) -> (i32, String, String) {
    let mut command = Command::cargo_bin("ramp").unwrap();
    let output = command.current_dir(folder).env("NO_COLOR", "1").args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn each_skill_is_printed_with_its_parameters() {
    let folder = TempDir::new().unwrap();
    let (status, said, _) = ramp(&folder, &["skills", "pick_up"]);
    assert_eq!(status, 0);
    for line in ["serves   pick_up", "needs    the hand is empty", "expects  the hand holds the part"] {
        assert!(said.contains(line), "{said}");
    }
    assert!(said.contains("lift           0.02 m"), "{said}");

    let (_, said, _) = ramp(&folder, &["skills", "--json"]);
    let all: Value = serde_json::from_str(&said).unwrap();
    let skills = all["skills"].as_array().unwrap();
    assert_eq!(skills.len(), 13);
    let mut actions: Vec<&str> = skills
        .iter()
        .flat_map(|skill| skill["serves"].as_array().unwrap())
        .map(|it| it.as_str().unwrap())
        .collect();
    actions.sort_unstable();
    actions.dedup();
    assert_eq!(actions.len(), 16, "{actions:?}");
    let tables = skills.iter().map(|skill| &skill["parameters"]).chain(all["shared"].as_array().unwrap());
    for parameter in tables.flat_map(|table| table["parameters"].as_array().unwrap()) {
        assert!(!parameter["meaning"].as_str().unwrap().is_empty(), "{parameter}");
    }

    let (status, _, told) = ramp(&folder, &["skills", "pikc_up"]);
    assert!(status == 2 && told.contains("did you mean `pick_up`?"), "{told}");
}

/// A file overrides only the parameters that it gives. An error is reported with its place, before
/// anything runs.
#[test]
fn a_file_overrides_numbers_and_a_wrong_one_is_refused() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("mine.toml"), "[pick_up]\nlift = 0.03\n").unwrap();
    let (status, said, _) = ramp(&folder, &["skills", "pick_up", "--parameters", "mine.toml"]);
    assert_eq!(status, 0);
    assert!(said.contains("0.03 m") && said.contains("0.045 m"), "{said}");

    for (text, place, why) in [
        ("[pick_up]\nlfit = 0.03\n", "wrong.toml:2:1", "did you mean `lift`?"),
        ("[pickup]\n", "wrong.toml:1:2", "did you mean `pick_up`?"),
        ("[pick_up]\n\nlift = \"high\"\n", "wrong.toml:3:8", "expected a number from 0.001 to 0.3 m"),
        ("[pick_up]\nlift = inf\n", "wrong.toml:2:8", "expected a number from"),
    ] {
        std::fs::write(folder.path().join("wrong.toml"), text).unwrap();
        for command in [&["skills"][..], &["run", "easy-3"], &["bench", "easy-3"], &["trials"]] {
            let (status, said, told) = ramp(&folder, &[command, &["--parameters", "wrong.toml"]].concat());
            assert_eq!((status, said.as_str()), (2, ""), "{command:?}: {told}");
            assert!(told.contains(place) && told.contains(why), "{command:?}: {told}");
        }
    }
    let (status, _, told) = ramp(&folder, &["skills", "--parameters", "none.toml"]);
    assert!(status == 2 && told.contains("cannot read none.toml"), "{told}");
    let (status, _, told) =
        ramp(&folder, &["run", "easy-3", "--parameters", "mine.toml", "--agent", "mine.py"]);
    assert!(status == 2 && told.contains("cannot be used with"), "{told}");
}

/// A result says which numbers its skills had, and so does a bench, which does not mix them.
#[test]
fn a_result_names_the_file_of_its_numbers() {
    let folder = TempDir::new().unwrap();
    // A guard so tight that the episode ends soon.
    std::fs::write(folder.path().join("mine.toml"), "[hand]\nguard = 5.0\n[agent]\nlatest = 0.0\n").unwrap();
    let arguments =
        ["bench", "easy-3", "--repeats", "1", "--track", "state", "-o", "own", "--parameters", "mine.toml"];
    let (_, _, told) = ramp(&folder, &arguments);
    let text = std::fs::read_to_string(folder.path().join("own/easy-3-state-1.json")).expect(&told);
    let result: Value = serde_json::from_str(&text).unwrap();
    let hash = result["agent"]["sha256"].as_str().unwrap();
    assert_eq!(hash.len(), 64);
    assert_eq!(result["agent"]["name"], format!("baseline+parameters.{}", &hash[..8]));
    let (status, _, told) = ramp(&folder, &arguments[..arguments.len() - 2]);
    assert!(status == 2 && told.contains("the folder would become one of two agents"), "{told}");
}

/// Pegs that never go in: each connection is left for later once, and the episode ends with what was tried.
#[test]
fn connections_that_always_fail_are_given_up_in_the_end() {
    let folder = TempDir::new().unwrap();
    let never = r#"
import json, sys
for message in (
    {"hello": {"protocol": 1, "name": "never", "version": "1"}},
    {"event": {"kind": "fault", "fault": "other", "why": "it never does"}},
    {"done": {}},
):
    print(json.dumps(message), flush=True)
    sys.stdin.readline()
"#;
    std::fs::write(folder.path().join("never.py"), never).unwrap();
    let run = ["run", "easy-1", "--track", "state", "--world", "ideal", "--skill", "fasten=never.py"];
    let (status, _, told) = ramp(&folder, &[&run[..], &["-o", "out.json"]].concat());
    assert_eq!(status, 1, "{told}");
    let result: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("out.json")).unwrap()).unwrap();
    let later = result["events"].as_array().unwrap().iter().filter(|event| {
        event["kind"] == "retry"
            && event["because"].as_str().is_some_and(|why| why.ends_with("after the rest"))
    });
    assert_eq!(later.count(), 3);
    let reason = result["ended"]["reason"].as_str().unwrap();
    assert!(reason.starts_with("nothing is left to try to fasten"), "{reason}");
}
