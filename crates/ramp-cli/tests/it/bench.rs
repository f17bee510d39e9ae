//! `ramp bench` as a user has it: stopped, killed and started again.

use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::ramp;
use ramp_testing::program::{text, words};
use serde_json::Value;
use tempfile::TempDir;

const BENCH: [&str; 8] = ["bench", "easy-1", "--track", "state", "--repeats", "2", "--jobs", "2"];

fn command(folder: &TempDir, arguments: &[&str]) -> Command {
    started(Command::new(env!("CARGO_BIN_EXE_ramp")), folder, arguments)
}

fn started(mut command: Command, folder: &TempDir, arguments: &[&str]) -> Command {
    command.current_dir(folder).args(arguments).stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn send(signal: &str, process: u32) {
    assert!(Command::new("kill").args([signal, &process.to_string()]).status().unwrap().success());
}

/// The episodes that a bench has at work now, as process numbers.
fn episodes_of(bench: &Child) -> Vec<u32> {
    // Each thread of the bench starts its own episodes.
    let threads = std::fs::read_dir(format!("/proc/{}/task", bench.id())).into_iter().flatten().flatten();
    let lists = threads.map(|it| std::fs::read_to_string(it.path().join("children")).unwrap_or_default());
    let lists = lists.collect::<Vec<String>>().join(" ");
    lists.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

fn wait_for(what: &str, mut there: impl FnMut() -> bool) {
    let start = Instant::now();
    while !there() {
        assert!(start.elapsed() < Duration::from_secs(60), "{what} never came");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A process that has ended, or is a zombie.
fn is_gone(process: u32) -> bool {
    std::fs::read_to_string(format!("/proc/{process}/stat"))
        .map_or(true, |text| text.rsplit(')').next().is_some_and(|rest| rest.trim_start().starts_with('Z')))
}

/// The JSON without what a clock decides.
fn without_clock(value: &mut Value) {
    match value {
        Value::Object(map) => {
            for name in
                ["planning", "compute", "total", "total_deviation", "t_total", "waiting", "loaded", "log"]
            {
                map.remove(name);
            }
            map.values_mut().for_each(without_clock);
        }
        Value::Array(list) => list.iter_mut().for_each(without_clock),
        _ => {}
    }
}

fn sums(bytes: &[u8]) -> Value {
    let mut value = serde_json::from_slice(bytes).unwrap();
    without_clock(&mut value);
    value
}

fn file(folder: &Path, name: &str) -> Value {
    sums(&std::fs::read(folder.join(name)).unwrap())
}

/// The output of a bench that `nohup` protects: neither it nor an episode ends when the terminal closes.
fn protected(folder: &TempDir, arguments: &[&str]) -> Output {
    let mut protected = Command::new("nohup");
    protected.arg(env!("CARGO_BIN_EXE_ramp"));
    let bench = started(protected, folder, arguments).spawn().unwrap();
    wait_for("two episodes", || episodes_of(&bench).len() == 2);
    for process in [vec![bench.id()], episodes_of(&bench)].concat() {
        send("-HUP", process);
    }
    bench.wait_with_output().unwrap()
}

/// A bench that is finished already prints its table in pieces that fit.
fn has_a_table_for_a_narrow_terminal(folder: &TempDir, arguments: &[&str]) {
    let narrow = command(folder, arguments).env("COLUMNS", "60").output().unwrap();
    let table = text(&narrow.stdout);
    assert!(table.contains("completion") && table.contains("reference"), "{table}");
    let of_table = |line: &&str| line.starts_with("goal") || line.starts_with("easy");
    let lines: Vec<&str> = table.lines().filter(of_table).collect();
    assert_eq!(lines.len(), 6, "{table}");
    assert!(lines.iter().all(|line| line.chars().count() <= 60), "{table}");
}

/// Protected by `nohup`; and killed in the middle, stopped by Ctrl-C, robbed of an episode, and started anew.
#[test]
fn what_is_killed_and_started_again_gives_the_same_sums() {
    let folder = TempDir::new().unwrap();
    let with = |more: &[&'static str]| [&BENCH[..], more].concat();

    let output = protected(&folder, &with(&["-o", "whole", "--json"]));
    assert_eq!(output.status.code(), Some(0), "{}", words(&output.stderr));
    let whole = sums(&output.stdout);
    assert_eq!(whole["goals"][0]["sum"]["finished"], 2);
    assert_eq!(whole["goals"][0]["sum"]["pegs"], 6);
    assert_eq!(whole["classes"][0]["class"], "easy");

    has_a_table_for_a_narrow_terminal(&folder, &with(&["-o", "whole"]));

    // Killed in the middle: its episodes end with it.
    let arguments = with(&["-o", "killed", "--json"]);
    let mut bench = command(&folder, &arguments).spawn().unwrap();
    wait_for("two episodes", || episodes_of(&bench).len() == 2);
    let orphans = episodes_of(&bench);
    std::thread::sleep(Duration::from_millis(500));
    send("-KILL", bench.id());
    bench.wait().unwrap();
    wait_for("the end of the episodes", || orphans.iter().all(|&it| is_gone(it)));

    // Stopped by Ctrl-C. Tests that run in the background hand on that it is ignored.
    let mut stoppable = Command::new("env");
    stoppable.args(["--default-signal", env!("CARGO_BIN_EXE_ramp")]);
    let bench = started(stoppable, &folder, &arguments).spawn().unwrap();
    wait_for("two episodes", || episodes_of(&bench).len() == 2);
    let second = ramp(&folder, &arguments);
    assert_eq!(second.status.code(), Some(2));
    assert!(words(&second.stderr).contains("another bench is at work"), "{}", words(&second.stderr));
    let children = episodes_of(&bench);
    send("-INT", bench.id());
    let output = bench.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    assert!(output.stdout.is_empty());
    assert!(words(&output.stderr).contains("stopped: "), "{}", words(&output.stderr));
    assert!(children.iter().all(|&it| is_gone(it)));

    // One episode is killed: the other continues.
    let bench = command(&folder, &arguments).spawn().unwrap();
    wait_for("two episodes", || episodes_of(&bench).len() == 2);
    send("-KILL", episodes_of(&bench)[0]);
    let output = bench.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", words(&output.stderr));
    let robbed = sums(&output.stdout);
    assert_eq!(robbed["goals"][0]["sum"]["finished"], 1);
    assert_eq!(robbed["failures"][0]["lost"], true);
    assert!(robbed["failures"][0]["reason"].as_str().unwrap().contains("killed by signal 9"));

    // Started again it runs the lost one alone; once more, it runs none.
    let output = ramp(&folder, &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", words(&output.stderr));
    assert!(words(&output.stderr).contains("1 of 2 episodes are finished already"));
    assert_eq!(sums(&output.stdout), whole);
    let again = ramp(&folder, &arguments);
    assert_eq!(again.stdout, output.stdout);
    for name in ["easy-1-state-1.json", "easy-1-state-2.json"] {
        let (one, other) = (folder.path().join("whole"), folder.path().join("killed"));
        assert_eq!(file(&one, name), file(&other, name));
    }
    let mut names: Vec<_> = std::fs::read_dir(folder.path().join("killed"))
        .unwrap()
        .map(|it| it.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let stems = ["easy-1-state-1", "easy-1-state-2"];
    let expected: Vec<String> = stems
        .iter()
        .flat_map(|stem| ["json", "mcap", "svg"].map(|ending| format!("{stem}.{ending}")))
        .collect();
    assert_eq!(names, [&[".lock".to_string()][..], &expected].concat());

    // A blind tape is another agent, and needs logs of two seeds.
    for (goal, more, expected) in [
        ("easy-1", ["--tape", "whole", "-o", "whole"], "is of the agent baseline"),
        ("easy-2", ["--tape", "whole", "-o", "tape"], "fewer than two seeds of easy-2"),
    ] {
        let refused = ramp(&folder, &[&["bench", goal, "--track", "state"][..], &more].concat());
        assert_eq!(refused.status.code(), Some(2));
        assert!(words(&refused.stderr).contains(expected), "{}", words(&refused.stderr));
    }
    assert!(!folder.path().join("tape").exists());

    // The table for a person; then the folder becomes one of another version.
    let table = ramp(&folder, &with(&["-o", "killed"]));
    assert!(words(&table.stdout).contains("easy: 1 goal 2/2"), "{}", words(&table.stdout));
    let path = folder.path().join("killed/easy-1-state-2.json");
    let mut other: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    other["software"]["version"] = "0.0.9".into();
    std::fs::write(&path, other.to_string()).unwrap();
    let refused = ramp(&folder, &arguments);
    assert_eq!(refused.status.code(), Some(2));
    assert!(refused.stdout.is_empty());
    assert!(words(&refused.stderr).contains("was made by ramp 0.0.9"), "{}", words(&refused.stderr));
}

#[test]
fn what_takes_too_long_is_lost_and_said() {
    let folder = TempDir::new().unwrap();
    let output = ramp(
        &folder,
        &["bench", "hard-1", "--track", "state", "--repeats", "1", "--limit", "1", "-o", "out"],
    );
    assert_eq!(output.status.code(), Some(1));
    let said = words(&output.stdout);
    assert!(said.contains("hard-1 seed 1: lost: not done after 1 s on the wall"), "{said}");
    assert!(!folder.path().join("out/hard-1-state-1.json").exists());
    assert!(folder.path().join("out/hard-1-state-1.log").exists());
}

#[test]
fn bad_input_is_refused_and_nothing_written() {
    let folder = TempDir::new().unwrap();
    for (arguments, expected) in [
        (&["bench", "easy-33"][..], "did you mean `easy-3`?"),
        (&["bench", "easy", "meduim"], "did you mean `medium`?"),
        (&["bench", "table"], "the goals are easy-1"),
        (&["bench", "nowhere/goal.xml"], "goal.xml"),
        (&["bench"], "<CLASS|GOAL>"),
        (&["bench", "easy-1", "--repeats", "0"], "--repeats"),
        (&["bench", "easy-1", "--first-seed", "18446744073709551615"], "--first-seed"),
    ] {
        let output = ramp(&folder, arguments);
        let message = words(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(output.stdout.is_empty());
        assert!(message.contains(expected), "{arguments:?} should say `{expected}`: {message}");
        assert!(!message.contains("panicked"), "{message}");
    }
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0);
}

/// A frame is taken apart several times, and the bench counts the parts that are back. The same command runs
/// nothing again, and a bench that builds refuses the folder.
#[test]
fn a_bench_takes_a_frame_apart() {
    let folder = TempDir::new().unwrap();
    let apart = ["bench", "easy-1", "--task", "take-apart", "--track", "state", "--repeats", "1"];
    let json = [&apart[..], &["--json"]].concat();
    let output = ramp(&folder, &json);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("6 of 6 parts back"), "{}", text(&output.stderr));
    let sums: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&sums["task"], &sums["goals"][0]["sum"]["pegs_counted"]), (&"take-apart".into(), &6.into()));
    let output = ramp(&folder, &apart);
    assert!(text(&output.stdout).contains("parts back"), "{}", text(&output.stdout));
    assert!(!text(&output.stderr).contains("1/1"), "{}", text(&output.stderr));
    let output = ramp(&folder, &["bench", "easy-1", "--track", "state", "--repeats", "1"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(words(&output.stderr).contains("began in another state, or in none"), "{}", text(&output.stderr));
}

/// A bench from a state of the frame: the episodes begin with it, and it is one of a single goal.
#[test]
fn a_bench_begins_with_a_given_frame() {
    let folder = TempDir::new().unwrap();
    std::fs::write(
        folder.path().join("state.json"),
        r#"{"in_assembly": ["b4"], "fastened": [["C1", "p1"]]}"#,
    )
    .unwrap();
    let output = ramp(
        &folder,
        &["bench", "easy-1", "--state", "state.json", "--track", "state", "--repeats", "1", "-o", "given"],
    );
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let result = std::fs::read(folder.path().join("given/easy-1-state-1.json")).unwrap();
    let result: Value = serde_json::from_slice(&result).unwrap();
    assert!(result["state"]["sha256"].is_string(), "{result}");
    let output = ramp(&folder, &["bench", "easy", "--state", "state.json", "-o", "many"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(words(&output.stderr).contains("a state is one of a single goal"), "{}", text(&output.stderr));
    assert!(!folder.path().join("many").exists());
}
