//! `ramp replay` as a user has it: a log that is whole, one that is not, and films.

use std::path::Path;
use std::process::{Command, Output};

use crate::ramp;
use tempfile::TempDir;

fn words(output: &Output) -> String {
    [&output.stdout[..], &output.stderr]
        .map(|bytes| String::from_utf8_lossy(bytes).replace(['│', '╭', '╰', '─'], " "))
        .join(" ")
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}

/// An episode that began in a state of its own is replayed with it, and counts in no table.
#[test]
fn a_state_is_part_of_the_log_and_of_no_report() {
    let folder = TempDir::new().unwrap();
    let agent = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/agents/good.py");
    let agent = agent.to_str().unwrap();
    let write = |text: &str| std::fs::write(folder.path().join("state.json"), text).unwrap();
    let run = |output| {
        let run =
            ["run", "easy-1", "--track", "state", "--agent", agent, "--state", "state.json", "-o", output];
        ramp(&folder, &run)
    };
    for (text, expected) in [
        ("{\n\"in_assembly\": [\"b44\"]}", "state.json:2:"),
        ("{\"deep\": [\"b4\"]}", "give its pose"),
        ("{\"poses\": {\"b4\": {\"position\": [0.3, -0.9, 0.0], \"yaw\": 0}}}", "mm in each other"),
        ("{\"poses\": {\"b4\": {\"position\": [9, 0, 0], \"yaw\": 0}}}", "off the table"),
    ] {
        write(text);
        let output = run("results/a.json");
        assert_eq!(output.status.code(), Some(2), "{}", words(&output));
        assert!(words(&output).contains(expected), "{text}: {}", words(&output));
        assert!(!folder.path().join("results").exists(), "{text}");
    }
    write("{\"poses\": {\"b4\": {\"position\": [0.3, -0.9, 0.1], \"yaw\": 0}}}");
    assert_eq!(run("results/a.json").status.code(), Some(1));
    let output = ramp(&folder, &["replay", "results/a.mcap"]);
    assert!(words(&output).contains("equal to the log, to the last bit"), "{}", words(&output));
    let output = ramp(&folder, &["report", "results"]);
    assert_eq!(output.status.code(), Some(2), "{}", words(&output));
    // A run without the state does not replace it.
    let other = ["run", "easy-1", "--track", "state", "--agent", agent, "-o", "results/a.json"];
    let output = ramp(&folder, &other);
    assert_eq!(output.status.code(), Some(2), "{}", words(&output));
    assert!(words(&output).contains("that began in another state, or in none"), "{}", words(&output));
}

#[test]
fn a_log_is_replayed_filmed_and_refused_when_it_is_cut() {
    let folder = TempDir::new().unwrap();
    let agent = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/agents/good.py");
    let agent = agent.to_str().unwrap();
    let run = ["run", "easy-1", "--track", "state", "--agent", agent, "-o", "a.json", "--record", "b.mcap"];
    assert_eq!(ramp(&folder, &run).status.code(), Some(1));
    assert!(!folder.path().join("a.mcap").exists());

    let output = ramp(&folder, &["replay", "b.mcap", "--video", "b.gif"]);
    assert_eq!(output.status.code(), Some(0), "{}", words(&output));
    assert!(words(&output).contains("the replay is equal to the log, to the last bit"), "{}", words(&output));
    assert!(std::fs::read(folder.path().join("b.gif")).unwrap().starts_with(b"GIF89a"));
    let json: serde_json::Value =
        serde_json::from_slice(&ramp(&folder, &["replay", "b.mcap", "--json"]).stdout).unwrap();
    let result: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("a.json")).unwrap()).unwrap();
    assert_eq!(json["equal"], true);
    assert_eq!(json["sha256"], result["log"]);

    let bytes = std::fs::read(folder.path().join("b.mcap")).unwrap();
    std::fs::write(folder.path().join("cut.mcap"), &bytes[..bytes.len() / 2]).unwrap();
    for (arguments, expected) in [
        (&["replay", "cut.mcap"][..], "cut.mcap is not a complete MCAP file: it ends too early"),
        (&["replay", "a.json"], "a.json is not a complete MCAP file"),
        (&["replay", "b.mcap", "--video", "b.mp4"], "there is no ffmpeg on the PATH"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_ramp"))
            .current_dir(&folder)
            .args(arguments)
            .env("PATH", folder.path())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{}", words(&output));
        assert!(words(&output).contains(expected), "{arguments:?}: {}", words(&output));
        assert!(output.stdout.is_empty());
    }
    assert!(!folder.path().join("b.mp4").exists());
}
