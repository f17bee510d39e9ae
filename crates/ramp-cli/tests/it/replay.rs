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
