//! Access and abilities of an agent, plain and in a sandbox. These tests verify the table of
//! `docs/src/howto/run-a-strangers-agent.md`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use ramp_external_agent::sandbox::{graphics, is_available};
use ramp_testing::trials::{Trial, check, check_unless};
use rustix::process::Signal;
use serde_json::Value;
use tempfile::TempDir;

use crate::{missing, missing_rooms};
use ramp_testing::program::text;

/// A seed that nothing else on a machine holds.
const SEED: &str = "918273645918";

/// A folder with an agent and what it needs, away from the folder of the results.
pub fn agents() -> TempDir {
    let folder = TempDir::new().unwrap();
    for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/agents")).unwrap() {
        let (from, name) = entry.map(|it| (it.path(), it.file_name())).unwrap();
        if from.is_file() {
            std::fs::copy(from, folder.path().join(name)).unwrap();
        }
    }
    folder
}

pub fn ramp(results: &TempDir, arguments: &[&str], agent: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ramp"));
    command.current_dir(results).args(arguments).arg("--agent").arg(agent);
    command.env("PYTHONDONTWRITEBYTECODE", "1").env("SPY_RESULTS", results.path());
    command
}

pub fn result(folder: &TempDir, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(folder.path().join(name)).unwrap()).unwrap()
}

/// Findings of the spy: each door, and what it found there.
fn spied(results: &TempDir, arguments: &[&str]) -> BTreeMap<String, Option<String>> {
    let agents = agents();
    let base = ["run", "easy-1", "--track", "tags", "--seed", SEED, "-o", "out.json"];
    let output = ramp(results, &[&base, arguments].concat(), &agents.path().join("spy.py")).output().unwrap();
    let result = result(results, "out.json");
    assert_eq!(result["ended"]["reason"], "done", "{}", text(&output.stderr));
    let events = result["events"].as_array().unwrap();
    let doors = events.iter().map(|event| {
        let door = event["door"].as_str().unwrap().to_string();
        let found = event["found"].as_str().map(str::to_string);
        assert!(!found.as_deref().unwrap_or_default().contains(SEED), "{door}: {found:?}");
        (door, found)
    });
    doors.collect()
}

/// Doors that must be shut. All others must be open, so that the table is correct.
fn doors_are_shut(found: &BTreeMap<String, Option<String>>, shut: &[&str]) {
    for (door, behind) in found {
        assert_eq!(behind.is_none(), shut.contains(&door.as_str()), "{door}: {behind:?}");
    }
    for door in shut {
        assert!(found.contains_key(*door), "{door}");
    }
}

/// Doors to what the track hides. They are shut to every agent.
const SEALED: [&str; 7] = [
    "command lines",
    "environment of the run",
    "open files of the run",
    "log that is being written",
    "memory of the run",
    "memory of the run by system call",
    "debugger on the run",
];
/// Doors that a sandbox shuts as well.
const SANDBOXED: [&str; 28] = [
    "list of processes",
    "signals to the run",
    "results of other episodes",
    "files of the user",
    "passwords of the system",
    "writing beside the agent",
    "writing to /tmp",
    "writing to /dev/shm",
    "changing modes of files",
    "network, TCP",
    "network, UDP",
    "sockets of the system",
    "other name spaces",
    "shared memory that stays",
    "limits of the run",
    "scheduling of the run",
    "attributes by a descriptor",
    "attributes by a path",
    "modes by a descriptor",
    "modes by a newer call",
    "flags of files",
    "name space by clone",
    "name space by clone3",
    "watching folders",
    "network of the system in /proc",
    "pair of sockets that reach others",
    "shared memory without a file",
    "shared memory by a descriptor",
];
/// Doors that are shut to some plain agents: to an ordinary user, on an older kernel, or by a file system.
const SHUT_TO_SOME: [&str; 8] = [
    "passwords of the system",
    "other name spaces",
    "attributes by a descriptor",
    "attributes by a path",
    "modes by a newer call",
    "flags of files",
    "name space by clone",
    "name space by clone3",
];

fn a_plain_agent_learns_nothing_of_its_own_episode() {
    let results = TempDir::new().unwrap();
    // A result of an earlier episode, which the plain agent may read.
    std::fs::write(results.path().join("old.json"), r#"{"seed": 123456789}"#).unwrap();
    let found = spied(&results, &[]);
    let mut shut = SEALED.to_vec();
    shut.extend(SHUT_TO_SOME.iter().filter(|door| found[**door].is_none()));
    doors_are_shut(&found, &shut);
    assert_eq!(found["results of other episodes"].as_deref(), Some("seed 123456789 in old.json"));
}

fn an_agent_in_a_sandbox_gets_nothing() {
    let results = TempDir::new().unwrap();
    std::fs::write(results.path().join("old.json"), r#"{"seed": 123456789}"#).unwrap();
    let found = spied(&results, &["--sandbox"]);
    let mut shut = [&SEALED[..], &SANDBOXED[..]].concat();
    if missing_rooms().is_none() {
        shut.push("names of files that it guesses");
    }
    if graphics() {
        shut.retain(|door| !door.starts_with("shared memory"));
    }
    doors_are_shut(&found, &shut);
}

/// Hidden files must not lie in a folder that the agent may read.
fn results_in_the_folder_of_the_agent_are_refused() {
    let agents = agents();
    let expected = if is_available() { "may read" } else { "Landlock" };
    for (command, name) in [("run", "results/out.json"), ("bench", "results")] {
        let output = Command::new(env!("CARGO_BIN_EXE_ramp"))
            .current_dir(&agents)
            .args([command, "easy-1", "--sandbox", "--agent", "spy.py", "-o", name])
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
        assert!(text(&output.stderr).contains(expected), "{}", text(&output.stderr));
        assert!(!agents.path().join("results").exists());
    }
}

fn is_sleeping(seconds: &str) -> bool {
    std::fs::read_dir("/proc").unwrap().flatten().any(|entry| {
        std::fs::read_to_string(entry.path().join("cmdline"))
            .is_ok_and(|line| line == format!("sleep\0{seconds}\0"))
    })
}

fn wait_until(what: &str, mut holds: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !holds() {
        assert!(begin.elapsed() < Duration::from_secs(60), "{what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// An agent that kills its run leaves nothing behind, and gets no result.
fn what_an_agent_has_started_ends_even_if_it_kills_its_run() {
    let (agents, results) = (agents(), TempDir::new().unwrap());
    let seconds = format!("8{:08}", std::process::id());
    let output = ramp(&results, &["run", "easy-1", "-o", "out.json"], &agents.path().join("bad.py"))
        .env("BAD_WAY", "kills its parent")
        .env("BAD_SLEEP", &seconds)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("the run was killed by signal 9"), "{}", text(&output.stderr));
    wait_until("a process is left", || !is_sleeping(&seconds));
    assert_eq!(names(results.path()), Vec::<String>::new());
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap().flatten();
    entries.map(|entry| entry.file_name().into_string().unwrap()).collect()
}

/// A request to end leaves nothing that is half done: no file, no process, no folder of an agent.
fn a_request_to_end_leaves_nothing_behind() {
    let (_folder, agent) = silent();
    ends_cleanly(&["run", "easy-1", "-o", "out.json", "--video", "film.gif"], None, Signal::TERM);
    ends_cleanly(&["run", "easy-1", "-o", "out.json"], Some(&agent), Signal::HUP);
    ends_cleanly(&["bench", "easy-1", "-o", "."], Some(&agent), Signal::INT);
    ends_cleanly(&["trials", "fasten-in-f", "-o", "."], Some(&agent), Signal::HUP);
}

fn a_request_to_end_leaves_nothing_of_a_sandbox_behind() {
    let (_folder, agent) = silent();
    ends_cleanly(&["run", "easy-1", "-o", "out.json", "--sandbox"], Some(&agent), Signal::TERM);
}

/// An agent that says nothing, in a folder of its own.
fn silent() -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let agent = folder.path().join("silent.py");
    std::fs::write(&agent, "import time\ntime.sleep(1000)\n").unwrap();
    (folder, agent)
}

/// The command gets a signal while it is at work. It exits with 128 and the signal's number, and leaves no
/// file.
fn ends_cleanly(arguments: &[&str], agent: Option<&Path>, signal: Signal) {
    let (results, temporary) = (TempDir::new().unwrap(), TempDir::new().unwrap());
    // Tests that run in the background hand on that INT is ignored.
    let mut command = Command::new("env");
    command.args(["--default-signal", env!("CARGO_BIN_EXE_ramp")]);
    command.current_dir(&results).args(arguments).env("TMPDIR", temporary.path());
    command.stdout(Stdio::null()).stderr(Stdio::null());
    if let Some(agent) = agent {
        command.arg("--agent").arg(agent);
    }
    let mut run = command.spawn().unwrap();
    // Long enough that it is at work.
    std::thread::sleep(Duration::from_secs(3));
    assert!(run.try_wait().unwrap().is_none(), "{arguments:?} ended by itself");
    let pid = rustix::process::Pid::from_child(&run);
    rustix::process::kill_process(pid, signal).unwrap();
    let status = run.wait().unwrap();
    assert_eq!(status.code(), Some(128 + signal.as_raw()), "{arguments:?}");
    let mut left = names(results.path());
    left.retain(|name| name != ".lock");
    assert_eq!(left, Vec::<String>::new(), "{arguments:?}");
    assert_eq!(names(temporary.path()), Vec::<String>::new(), "{arguments:?}");
}

/// The checks of this file.
pub fn checks() -> Vec<Trial> {
    vec![
        check(
            "a_plain_agent_learns_nothing_of_its_own_episode",
            a_plain_agent_learns_nothing_of_its_own_episode,
        ),
        check_unless("an_agent_in_a_sandbox_gets_nothing", missing, an_agent_in_a_sandbox_gets_nothing),
        check(
            "results_in_the_folder_of_the_agent_are_refused",
            results_in_the_folder_of_the_agent_are_refused,
        ),
        check(
            "what_an_agent_has_started_ends_even_if_it_kills_its_run",
            what_an_agent_has_started_ends_even_if_it_kills_its_run,
        ),
        check("a_request_to_end_leaves_nothing_behind", a_request_to_end_leaves_nothing_behind),
        check_unless(
            "a_request_to_end_leaves_nothing_of_a_sandbox_behind",
            missing,
            a_request_to_end_leaves_nothing_of_a_sandbox_behind,
        ),
    ]
}
