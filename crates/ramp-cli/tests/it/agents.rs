//! Custom agents: their abilities, and the protection of a run or a bench from them.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use ramp_testing::program::text;
use serde_json::Value;
use tempfile::TempDir;

fn agent(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/agents").join(name)
}

fn ramp(folder: &TempDir, arguments: &[&str], file: &Path, way: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ramp"));
    command.current_dir(folder).args(arguments).arg("--agent").arg(file).env("BAD_WAY", way);
    command.env("PYTHONDONTWRITEBYTECODE", "1").env("BAD_SLEEP", sleep()).output().unwrap()
}

/// A sleep that no other test has.
fn sleep() -> String {
    format!("9{:08}", std::process::id())
}

fn file(folder: &TempDir, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(folder.path().join(name)).unwrap()).unwrap()
}

/// Every call of the seam is there for an agent that is not written in Rust, on every track.
#[test]
fn an_agent_in_python_gets_what_its_track_gives() {
    let folder = TempDir::new().unwrap();
    for track in ["state", "noisy", "tags"] {
        let output = ramp(
            &folder,
            &["run", "easy-2", "--track", track, "--force", "-o", "out.json"],
            &agent("good.py"),
            "",
        );
        assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
        let result = file(&folder, "out.json");
        assert_eq!(result["ended"]["reason"], "done", "{}", text(&output.stderr));
        assert_eq!(result["agent"]["name"], "good");
        assert_eq!(result["agent"]["sha256"].as_str().unwrap().len(), 64);
        assert_eq!(result["plan"]["fine"], 5);
        let events = result["events"].as_array().unwrap();
        assert_eq!((events.len(), &events[0]["action"]), (16, &serde_json::json!("stay_a_while")));
        assert_eq!(events[1]["item"]["beam"], "b4");
        assert_eq!((&events[3]["fault"], &events[3]["force"]), (&"jammed".into(), &25.0.into()));
        let schema = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/schema/episode.schema.json");
        let schema = serde_json::from_str(&std::fs::read_to_string(schema).unwrap()).unwrap();
        assert!(jsonschema::is_valid(&schema, &result));
        let replay = Command::new(env!("CARGO_BIN_EXE_ramp"))
            .current_dir(&folder)
            .args(["replay", "out.mcap"])
            .output()
            .unwrap();
        assert!(text(&replay.stdout).contains("equal to the log"), "{}", text(&replay.stdout));
        // It asks for what only the track `state` gives: elsewhere its episode counts on no board.
        let expected = if track == "state" { 0 } else { 1 };
        assert_eq!(replay.status.code(), Some(expected), "{}", text(&replay.stdout));
    }
}

/// The example of the book works: a corner of two beams, pinned by plain Python.
#[test]
fn the_example_builds_a_corner() {
    let folder = TempDir::new().unwrap();
    let goal = r#"<assembly>
  <component beam="b7" base="True"/>
  <component beam="b4"/>
  <connection name="C1">
    <element component="b4" joint="b4j1"/>
    <element component="b7" joint="b7j1"/>
  </connection>
</assembly>"#;
    std::fs::write(folder.path().join("corner.xml"), goal).unwrap();
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/agents/build.py");
    let output = ramp(
        &folder,
        &["run", "./corner.xml", "--track", "state", "--world", "ideal", "-o", "out.json"],
        &example,
        "",
    );
    assert_eq!(output.status.code(), Some(0), "{}{}", text(&output.stdout), text(&output.stderr));
    assert_eq!(file(&folder, "out.json")["completion"], 1.0);
}

/// Each way to behave badly ends in a result that says so, soon, and without much memory.
#[test]
fn whatever_an_agent_does_is_scored_with_its_reason() {
    let folder = TempDir::new().unwrap();
    for (way, reason) in [
        ("silent", "the agent sent nothing for 1 s"),
        ("dies at once", "the agent crashed: it ended with status 3"),
        ("odd name", "the agent's name must be 1 to 64 letters"),
        ("other protocol", "the agent speaks protocol 7, and 1 is spoken here"),
        ("hangs", "the agent sent nothing for 1 s"),
        ("crashes", "the agent crashed: it ended with status 1"),
        ("is killed", "the agent was killed by signal 11"),
        ("leaves", "the agent ended without saying that it is done"),
        ("nan", "message 3 of the agent holds NaN, which is no number for a robot"),
        ("too strong", "the command's gripper force is 1e12, above the limit of 140 N"),
        ("too long", "message 3 of the agent asks for 6000000000000000000 periods"),
        ("crooked", "message 3 of the agent has a quaternion of length 1.4142, and 1 is expected"),
        ("misspelt", "message 3 of the agent is not understood: unknown field `comands`"),
        ("no json", "message 3 of the agent is no message: `Hello, robot!`. Standard output is for messages"),
        ("deep", "message 3 of the agent is no message: `[[[["),
        ("floods", "the agent did not read its answer for 1 s"),
        ("asks for ever", "the agent sent 10000 messages in a row that let no robot time pass"),
        ("endless line", "the agent sent a line of more than 4194304 bytes"),
        ("chatters", "the agent sent nothing for 1 s"),
    ] {
        let begin = Instant::now();
        let output = ramp(
            &folder,
            &["run", "easy-1", "--track", "state", "--agent-limit", "1", "-o", "out.json"],
            &agent("bad.py"),
            way,
        );
        assert_eq!(output.status.code(), Some(1), "{way}: {}", text(&output.stderr));
        let result = file(&folder, "out.json");
        let said = result["ended"]["reason"].as_str().unwrap();
        assert!(said.contains(reason), "{way}: {said}");
        assert_eq!(result["pegs"].as_array().unwrap().len(), 3);
        assert!(begin.elapsed() < Duration::from_secs(30), "{way} took {:?}", begin.elapsed());
        assert!(output.stderr.len() < 2 << 20, "{way}");
    }
}

/// A target that the arm cannot follow ends the episode, unless the agent asks for a motion in its place; the
/// log then holds that motion.
#[test]
fn a_target_that_jumps_is_refused_or_clipped() {
    let folder = TempDir::new().unwrap();
    let arguments = ["run", "easy-1", "--track", "state", "-o", "out.json"];
    ramp(&folder, &arguments, &agent("jumper.py"), "refuse");
    let refused = file(&folder, "out.json");
    assert_eq!(
        refused["ended"]["reason"],
        "the commanded first step of joint 1 is 0.500 rad, above the limit of 0.010: one command is expected every 1 ms"
    );
    let output = ramp(&folder, &arguments, &agent("jumper.py"), "clip");
    let clipped = file(&folder, "out.json");
    assert_eq!(clipped["ended"]["reason"], "done", "{}", text(&output.stderr));
    let told: Vec<&str> =
        clipped["events"].as_array().unwrap().iter().map(|it| it["kind"].as_str().unwrap()).collect();
    assert_eq!(told, ["clipped"]);
    let mut replay = Command::new(env!("CARGO_BIN_EXE_ramp"));
    let replay = replay.current_dir(&folder).args(["replay", "out.mcap"]).output().unwrap();
    assert!(text(&replay.stdout).contains("equal to the log"), "{}", text(&replay.stdout));
}

/// A reflex in the world `real` does not end the episode of an agent in another process: it is told that the
/// arm is ready again, and goes on.
#[test]
fn an_agent_is_told_of_a_reflex_and_goes_on() {
    let folder = TempDir::new().unwrap();
    let arguments = ["run", "easy-1", "--track", "state", "--seed", "3", "-o", "out.json"];
    let output = ramp(&folder, &arguments, &agent("presser.py"), "");
    let result = file(&folder, "out.json");
    assert_eq!(result["ended"]["reason"], "done", "{}", text(&output.stderr));
    assert_eq!(result["physics"]["stops"], 1);
    let events = result["events"].as_array().unwrap();
    assert_eq!((events.len(), &events[0]["kind"]), (1, &"recovered".into()), "{events:?}");
    assert!(text(&output.stdout).contains("the arm stopped and was ready again 1 time"));
}

/// No process outlives its episode, not even one that has left its group.
#[test]
fn what_an_agent_has_started_ends_with_it() {
    let folder = TempDir::new().unwrap();
    let arguments = ["run", "easy-1", "--track", "state", "-o", "out.json"];
    ramp(&folder, &arguments, &agent("bad.py"), "leaves children");
    assert_eq!(file(&folder, "out.json")["ended"]["reason"], "done");
    let sleeping = std::fs::read_dir("/proc").unwrap().flatten().any(|entry| {
        std::fs::read_to_string(entry.path().join("cmdline"))
            .is_ok_and(|line| line == format!("sleep\0{}\0", sleep()))
    });
    assert!(!sleeping);
}

/// Not even when its run is killed and can do nothing any more.
#[test]
fn an_agent_does_not_outlive_a_run_that_is_killed() {
    let folder = TempDir::new().unwrap();
    let mut run = Command::new(env!("CARGO_BIN_EXE_ramp"))
        .current_dir(&folder)
        .args(["run", "easy-1", "--track", "state", "-o", "out.json", "--agent"])
        .arg(agent("bad.py"))
        .env("BAD_WAY", "silent")
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    // The run guards another process, and the agent is a child of that.
    let first_child = |process: &str| {
        let children = format!("/proc/{process}/task/{process}/children");
        let list = std::fs::read_to_string(children).unwrap_or_default();
        list.split_whitespace().next().map(str::to_string)
    };
    let guard = run.id().to_string();
    let begin = Instant::now();
    let process = loop {
        let found = first_child(&guard).and_then(|work| first_child(&work)).map(|it| format!("/proc/{it}"));
        // It is the agent's once Python runs in it.
        let line = found.as_ref().and_then(|it| std::fs::read_to_string(format!("{it}/cmdline")).ok());
        match (found, line) {
            (Some(process), Some(line)) if line.contains("bad.py") && !line.contains("agent-process") => {
                break process;
            }
            _ => assert!(begin.elapsed() < Duration::from_secs(60), "there is no agent"),
        }
        std::thread::sleep(Duration::from_millis(10));
    };
    run.kill().unwrap();
    run.wait().unwrap();
    let gone = || {
        let stat = std::fs::read_to_string(format!("{process}/stat"));
        stat.map_or(true, |text| text.rsplit(')').next().unwrap().trim_start().starts_with('Z'))
    };
    while !gone() {
        assert!(begin.elapsed() < Duration::from_secs(60), "the agent lives on");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// A bench resumes, scores every episode, and keeps to one agent.
#[test]
fn a_bench_goes_on_whatever_its_agent_does() {
    let folder = TempDir::new().unwrap();
    let arguments =
        ["bench", "easy", "--track", "state", "--repeats", "1", "--agent-limit", "1", "-o", "out"];
    let output = ramp(&folder, &arguments, &agent("bad.py"), "by goal");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let table = text(&output.stdout);
    for reason in
        ["easy-1 seed 1: 0 of 3 pegs: the agent sent nothing", "did not read", "it ended with status 1"]
    {
        assert!(table.contains(reason), "{table}");
    }
    // Its last words are kept.
    let said = std::fs::read_to_string(folder.path().join("out/easy-3-state-1.log")).unwrap();
    assert!(said.contains("it was all too much"), "{said}");
    // Another agent cannot resume in the same folder.
    let output = ramp(&folder, &arguments, &agent("good.py"), "");
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("is of the agent bad 1.0"), "{}", text(&output.stderr));
}

#[test]
fn a_file_that_is_no_agent_is_refused() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("notes.txt"), "no program").unwrap();
    for (name, expected) in [("nowhere.py", "cannot be read"), ("notes.txt", "neither a Python file")] {
        for command in [&["run", "easy-1"][..], &["bench", "easy-1"]] {
            let output = ramp(&folder, command, Path::new(name), "");
            assert_eq!(output.status.code(), Some(2));
            assert!(text(&output.stderr).contains(expected), "{}", text(&output.stderr));
        }
    }
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
}
