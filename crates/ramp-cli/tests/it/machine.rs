//! Machine faults: they count as no result, and finished results are kept.

use std::path::Path;
use std::process::{Command, Output};

use ramp_testing::program::text;
use serde_json::Value;
use tempfile::TempDir;

/// The program in a shell in which no file can be larger than so many blocks of 512 bytes. A write beyond
/// that fails as it does on a full disk.
fn with_full_disk(folder: &Path, blocks: u32, arguments: &str) -> Output {
    let line = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$RAMP\" {arguments}");
    let mut command = Command::new("sh");
    command.current_dir(folder).args(["-c", &line]).env("RAMP", env!("CARGO_BIN_EXE_ramp"));
    command.output().unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap().flatten();
    let mut names: Vec<String> = entries.map(|it| it.file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// An agent that moves for some seconds: its log needs more room than its result.
fn agent(folder: &Path) {
    let program = r#"
import json, math, sys
def tell(message):
    print(json.dumps(message), flush=True)
    return json.loads(sys.stdin.readline())
goal = tell({"hello": {"protocol": 1, "name": "mover", "version": "1"}})["goal"]
home = goal["arm"]["home"]
for period in range(3000):
    arm = [home[0] + 0.1 * (1 - math.cos(period * 1e-3))] + home[1:]
    tell({"step": {"commands": [{"arm": {"joint_positions": arm}, "gripper": {"width": 0.04, "force": 10.0}}]}})
tell({"done": {}})
"#;
    std::fs::write(folder.join("mover.py"), program).unwrap();
}

#[test]
fn a_log_that_cannot_be_written_does_not_cost_the_result() {
    let folder = TempDir::new().unwrap();
    agent(folder.path());
    let output = with_full_disk(folder.path(), 128, "run easy-1 --agent mover.py -o out.json");
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("there is no log"), "{}", text(&output.stderr));
    assert_eq!(names(folder.path()), ["mover.py", "out.json", "out.svg"]);
    let result: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("out.json")).unwrap()).unwrap();
    assert_eq!(result["ended"]["reason"], "done");
    assert_eq!(result["log"], Value::Null);
}

#[test]
fn a_bench_on_a_full_disk_stops_and_counts_nothing() {
    let folder = TempDir::new().unwrap();
    agent(folder.path());
    let bench = "bench easy-1 --repeats 3 --agent mover.py -o results";
    let output = with_full_disk(folder.path(), 128, bench);
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("disk full or read-only"), "{}", text(&output.stderr));
    assert_eq!(text(&output.stdout), "", "no sums");
    assert_eq!(names(&folder.path().join("results")), [".lock"]);
    // With free space again, the same command runs all episodes.
    let output = with_full_disk(folder.path(), 1 << 20, bench);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("3/3"), "{}", text(&output.stdout));
}

#[test]
fn a_disk_that_was_full_from_the_start_stops_a_bench() {
    let folder = TempDir::new().unwrap();
    agent(folder.path());
    let output = with_full_disk(folder.path(), 0, "bench easy-1 --agent mover.py -o results");
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    assert_eq!(text(&output.stdout), "", "no sums");
}

/// A shell may allow a small stack, on which the argument parser alone would overflow.
#[test]
fn a_small_stack_suffices() {
    let folder = TempDir::new().unwrap();
    let mut command = Command::new("sh");
    let line = "ulimit -s 64; exec \"$RAMP\" check easy-1";
    command.current_dir(&folder).args(["-c", line]).env("RAMP", env!("CARGO_BIN_EXE_ramp"));
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{} {}", output.status, text(&output.stderr));
}

/// An agent that says much to a person, reports an event, and is done.
const TALKER: &str = r#"
import json, sys
def tell(message):
    print(json.dumps(message), flush=True)
    return json.loads(sys.stdin.readline())
tell({"hello": {"protocol": 1, "name": "talker", "version": "1"}})
sys.stderr.write("words " * 60000)
sys.stderr.flush()
tell({"event": {"kind": "note", "text": "still here"}})
tell({"done": {}})
"#;

/// The program in a shell with other streams.
fn with_streams(folder: &Path, arguments: &str, streams: &str) -> Output {
    let mut command = Command::new("sh");
    command.current_dir(folder).args(["-c", &format!("exec \"$RAMP\" {arguments} {streams}")]);
    command.env("RAMP", env!("CARGO_BIN_EXE_ramp")).output().unwrap()
}

#[test]
fn a_message_that_cannot_be_written_ends_no_run() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("talker.py"), TALKER).unwrap();
    for (name, streams) in [("full", "2>/dev/full"), ("closed", "2>&-")] {
        let output =
            with_streams(folder.path(), &format!("run easy-1 --agent talker.py -o {name}.json"), streams);
        assert_eq!(output.status.code(), Some(1), "{name}: {}", text(&output.stderr));
        let result = std::fs::read(folder.path().join(format!("{name}.json"))).unwrap();
        let result: Value = serde_json::from_slice(&result).unwrap();
        assert_eq!(result["ended"], serde_json::json!({"reason": "done", "kind": "done"}), "{name}");
        assert!(result["log"].is_string(), "{name}");
    }
    for streams in ["2>/dev/full", "2>&-"] {
        let output = with_streams(folder.path(), "run nothing", streams);
        assert_eq!(output.status.code(), Some(2), "{streams}");
        let bench = format!("bench easy-1 --repeats 1 --agent talker.py -o bench{}", streams.len());
        let output = with_streams(folder.path(), &bench, streams);
        assert_eq!(output.status.code(), Some(0), "{streams}");
        assert!(text(&output.stdout).contains("1/1"), "{}", text(&output.stdout));
    }
}

#[test]
fn results_that_cannot_be_printed_are_a_fault_of_the_machine() {
    let folder = TempDir::new().unwrap();
    for arguments in ["goals", "world show real", "plan easy-1"] {
        let output = with_streams(folder.path(), arguments, ">/dev/full");
        assert_eq!(output.status.code(), Some(3), "{arguments}");
        assert!(text(&output.stderr).contains("standard output cannot be written to"), "{arguments}");
    }
}

#[test]
fn a_disk_that_an_agents_words_fill_costs_no_episode() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("talker.py"), TALKER).unwrap();
    // The words need 360 kB, and no file has more than 200 kB.
    let output = with_full_disk(folder.path(), 400, "bench easy-1 --repeats 1 --agent talker.py -o out");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("1/1"), "{}", text(&output.stdout));
}
