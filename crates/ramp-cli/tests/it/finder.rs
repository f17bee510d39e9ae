//! Finders of parts that are programs: what they are asked, and what happens when they fail.

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;

fn ramp(folder: &Path, finder: &Path) -> Command {
    let mut command = Command::cargo_bin("ramp").unwrap();
    command.current_dir(folder).args([
        "run",
        "easy-1",
        "--world",
        "ideal",
        "--output",
        "result.json",
        "--finder",
    ]);
    command.arg(finder);
    command
}

fn program(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("mine.py");
    std::fs::write(&path, text).unwrap();
    path
}

fn result(folder: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("result.json")).unwrap()).unwrap()
}

#[test]
fn a_finder_needs_images() {
    let folder = tempfile::tempdir().unwrap();
    let mine = program(folder.path(), "");
    let error = ramp(folder.path(), &mine).args(["--track", "noisy"]).assert().code(2);
    assert!(String::from_utf8_lossy(&error.get_output().stderr).contains("track `noisy` gives none"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// It gets as many bytes as the line says, and what it does not find is not there for the baseline.
#[test]
fn a_finder_is_asked_about_each_image() {
    let folder = tempfile::tempdir().unwrap();
    let mine = program(
        folder.path(),
        r#"
import json, sys
read = sys.stdin.buffer
goal = json.loads(read.readline())
assert goal["finder"] == 1 and goal["goal"]["tags"] == [] and goal["goal"]["track"] == "depth"
while line := read.readline():
    image = json.loads(line)["image"]
    assert image["bytes"] == 3 * image["width"] * image["height"]
    assert len(read.read(image["bytes"])) == image["bytes"]
    depth = read.read(image["depth_bytes"])
    # The table is 2.5 m below the camera above.
    at = 2 * (700 * 1280 + 1000)
    assert image["camera"] == "wrist" or abs(depth[at] + 256 * depth[at + 1] - 25000) < 200
    open("asked.txt", "a").write(image["camera"] + "\n")
    print(json.dumps({"parts": []}), flush=True)
"#,
    );
    ramp(folder.path(), &mine).args(["--track", "depth"]).assert().code(1);
    let asked = std::fs::read_to_string(folder.path().join("asked.txt")).unwrap();
    assert!(asked.contains("wrist") && asked.contains("birds-eye"), "{asked}");
    let result = result(folder.path());
    assert!(result["agent"]["name"].as_str().unwrap().starts_with("baseline+finder-mine."), "{result}");
    assert!(!result.to_string().contains("the finder "), "{result}");
}

/// The episode ends, is scored, and says why.
#[test]
fn a_finder_that_crashes_ends_the_episode() {
    for (text, why) in [
        ("raise SystemExit(3)", "the finder crashed: it ended with status 3"),
        ("while True: print('x' * 1000)", "the finder "),
        (
            "import sys\nread = sys.stdin.buffer\nread.readline(), read.readline(), read.read(3 * 1280 * 800)\n\
             print('{\"parts\": [{\"part\": \"b77\"}]}', flush=True)\nread.readline()",
            "the finder did not answer",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let mine = program(folder.path(), text);
        ramp(folder.path(), &mine).args(["--track", "tags", "--agent-limit", "5"]).assert().code(1);
        let result = result(folder.path());
        assert!(result["ended"]["reason"].as_str().unwrap().contains(why), "{why}: {result}");
        assert_eq!(result["completion"], 0.0);
    }
}
