//! Limits of an agent in a sandbox: its notes, its disk space and memory, its time; and programs that must
//! run there.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

use ramp_external_agent::sandbox::graphics;
use ramp_external_agent::{AgentFile, Sandbox};
use ramp_testing::program::text;
use ramp_testing::trials::{Trial, check, check_unless};
use serde_json::Value;
use tempfile::TempDir;

use crate::seal::{agents, ramp, result};
use crate::{missing, missing_rooms};

/// The result of one of the agents of the tests, which must be done, and the standard error.
fn run(agents: &Path, name: &str, arguments: &[&str]) -> (Value, String) {
    let results = TempDir::new().unwrap();
    let base = ["run", "easy-1", "-o", "out.json"];
    let output = ramp(&results, &[&base, arguments].concat(), &agents.join(name)).output().unwrap();
    let result = result(&results, "out.json");
    let stderr = text(&output.stderr).to_string();
    assert_eq!(result["ended"]["reason"], "done", "{stderr}");
    (result, stderr)
}

/// The notes that the second of two episodes finds.
fn recalled(arguments: &[&str]) -> BTreeMap<String, bool> {
    let agents = agents();
    let mark = agents.path().join("mark");
    std::fs::write(&mark, "x").unwrap();
    let old = std::time::UNIX_EPOCH + std::time::Duration::from_secs(1000);
    let times = std::fs::FileTimes::new().set_accessed(old).set_modified(old);
    std::fs::File::options().write(true).open(&mark).unwrap().set_times(times).unwrap();
    let _ = run(agents.path(), "notes.py", arguments);
    let (second, _) = run(agents.path(), "notes.py", arguments);
    let events = second["events"].as_array().unwrap();
    events.iter().map(|it| (it["note"].as_str().unwrap().into(), it["found"] == "yes")).collect()
}

/// A plain agent shows that the ways to keep notes work.
fn a_plain_agent_keeps_notes() {
    let found = recalled(&[]);
    assert!(found["mode"] && found["file beside it"] && !found["file of its own"], "{found:?}");
}

fn an_agent_in_a_sandbox_keeps_no_notes_between_episodes() {
    let mut found = recalled(&["--sandbox"]);
    assert_eq!(found.len(), 7);
    // Reading leaves this mark, and only a read-only mount prevents it.
    if missing_rooms().is_some() {
        found.remove("time of access");
    }
    let kept: Vec<String> = found.into_iter().filter(|(_, found)| *found).map(|(way, _)| way).collect();
    assert!(kept.is_empty(), "{kept:?}");
}

/// A planner reads a file of its user, and in a sandbox it cannot.
fn a_planner_in_a_sandbox_cannot_read_other_files() {
    let (planners, results) = (TempDir::new().unwrap(), TempDir::new().unwrap());
    let secret = results.path().join("secret");
    std::fs::write(&secret, "x").unwrap();
    let planner = planners.path().join("planner.py");
    let spy = format!(
        "import sys\ntry:\n    open({secret:?}).read()\nexcept OSError:\n    sys.exit(0)\nsys.exit(9)\n"
    );
    std::fs::write(&planner, spy).unwrap();
    for (sandbox, why) in [
        (&[][..], "no plan: the planner crashed: it ended with status 9"),
        (&["--sandbox"], "no plan: the planner wrote no plan"),
    ] {
        let run = ["run", "easy-1", "--track", "state", "--world", "ideal", "--force", "-o", "out.json"];
        let mut command = Command::new(env!("CARGO_BIN_EXE_ramp"));
        let output =
            command.current_dir(&results).args(run).arg("--planner").arg(&planner).args(sandbox).output();
        let output = output.unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
        assert_eq!(result(&results, "out.json")["ended"]["reason"], why);
    }
}

/// A planner and a finder go together, and neither can read a file of its user in its sandbox.
fn a_planner_and_a_finder_have_sandboxes_of_their_own() {
    let [planners, finders, results] = [(); 3].map(|()| TempDir::new().unwrap());
    let secret = results.path().join("secret");
    std::fs::write(&secret, "x").unwrap();
    let (planner, finder) = (planners.path().join("planner.py"), finders.path().join("finder.py"));
    let spy = format!(
        "import sys\ntry:\n    open({secret:?}).read()\n    sys.exit(9)\nexcept OSError:\n    pass\n"
    );
    std::fs::write(&planner, &spy).unwrap();
    let sees_nothing = "import json\nread = sys.stdin.buffer\nread.readline()\nwhile line := read.readline():\n    \
                        read.read(json.loads(line)['image']['bytes'])\n    print('{\"parts\": []}', flush=True)\n";
    std::fs::write(&finder, spy + sees_nothing).unwrap();
    for (sandbox, why) in [
        (&[][..], "the finder crashed: it ended with status 9"),
        (&["--sandbox"], "no plan: the planner wrote no plan"),
    ] {
        let run = ["run", "easy-1", "--track", "tags", "--world", "ideal", "--force", "-o", "out.json"];
        let mut command = Command::new(env!("CARGO_BIN_EXE_ramp"));
        command.current_dir(&results).args(run).arg("--planner").arg(&planner).arg("--finder").arg(&finder);
        let output = command.args(sandbox).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
        let result = result(&results, "out.json");
        assert_eq!(result["ended"]["reason"], why);
        let name = result["agent"]["name"].as_str().unwrap();
        assert!(name.contains("+planner-planner.") && name.contains("+finder-finder."), "{name}");
    }
}

/// Space of files without a name and shared memory count: 64 MiB is the limit here.
fn unlinked_files_and_shared_memory_are_within_the_quota() {
    let agents = agents();
    let file = AgentFile::find(&agents.path().join("quota.py")).unwrap();
    let sandbox = Sandbox::find(&file, &[]).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_ramp"));
    command.args(["agent-process", &std::process::id().to_string(), "--rooms"]);
    command.args(["--disk", "67108864", "--tasks", "50", "--folder"]).arg(sandbox.folder());
    for path in sandbox.inside().readable {
        command.arg("--readable").arg(path);
    }
    let output = command.arg("--").args(sandbox.command()).stdin(Stdio::null()).output().unwrap();
    let told = text(&output.stdout);
    let said: BTreeMap<&str, &str> = told.lines().filter_map(|line| line.split_once(' ')).collect();
    let stderr = text(&output.stderr);
    assert!(output.status.success(), "{told}{stderr}");
    let unlinked: u32 = said["unlinked"].parse().unwrap();
    assert!((32..=64).contains(&unlinked), "{told}");
    assert!(matches!(said["zeros"], "ENOENT" | "EACCES"), "{told}");
    if !graphics() {
        assert_eq!((said["shared"], said["descriptor"]), ("EPERM", "EPERM"), "{told}");
    }
}

/// Without standing still, the busy processes would compute for as long as the images take the twin.
fn processes_stand_still_while_the_twin_takes_images() {
    let agents = agents();
    let (result, _) = run(agents.path(), "busy.py", &["--track", "tags"]);
    let time = |name: &str| result["time"][name].as_f64().unwrap();
    // Three processes and their parent may compute at once in the time that is counted as the agent's. The
    // rest is the start of Python.
    let (processor, counted) = (time("agent_cpu"), time("compute"));
    let at_once = std::thread::available_parallelism().map_or(1, std::num::NonZero::get).min(4);
    let most = at_once as f64 * counted + 1.0;
    assert!(processor <= most, "{processor} s of processors, {counted} s counted");
}

/// The agent waits 0.9 s after its end, which is not its compute; what it says moves no terminal.
fn the_end_of_an_agent_is_not_its_compute_and_its_words_are_plain() {
    let agents = agents();
    let (result, stderr) = run(agents.path(), "slow_end.py", &["--track", "state"]);
    let compute = result["time"]["compute"].as_f64().unwrap();
    assert!(compute < 0.9, "{compute} s");
    assert!(stderr.contains("hello") && !stderr.contains(['\u{1b}', '\u{7}', '\u{9b}', '\r']), "{stderr:?}");
}

fn python_with_numpy_runs_in_a_sandbox() {
    let agents = agents();
    let _ = run(agents.path(), "arrays.py", &["--track", "state", "--sandbox"]);
}

fn a_static_program_runs_in_a_sandbox() {
    let folder = TempDir::new().unwrap();
    let program = folder.path().join("plain");
    assert!(compile(&program), "cc -static has failed");
    let _ = run(folder.path(), "plain", &["--track", "state", "--sandbox"]);
}

/// Compiles the static program; false if that is not possible here.
fn compile(program: &Path) -> bool {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/agents/plain.c");
    let mut cc = Command::new("cc");
    cc.args(["-static", "-o"]).arg(program).arg(source).stdout(Stdio::null()).stderr(Stdio::null());
    cc.status().is_ok_and(|status| status.success())
}

fn missing_linker() -> Option<String> {
    let folder = TempDir::new().unwrap();
    let none = || "cc cannot link a static program here".to_string();
    missing().or((!compile(&folder.path().join("plain"))).then(none))
}

fn missing_numpy() -> Option<String> {
    let mut python = Command::new("python3");
    python.args(["-c", "import numpy"]).stdout(Stdio::null()).stderr(Stdio::null());
    let there = python.status().is_ok_and(|status| status.success());
    missing().or((!there).then(|| "python3 has no numpy".to_string()))
}

/// The checks of this file.
pub fn checks() -> Vec<Trial> {
    vec![
        check("a_plain_agent_keeps_notes", a_plain_agent_keeps_notes),
        check_unless(
            "an_agent_in_a_sandbox_keeps_no_notes_between_episodes",
            missing,
            an_agent_in_a_sandbox_keeps_no_notes_between_episodes,
        ),
        check_unless(
            "a_planner_in_a_sandbox_cannot_read_other_files",
            missing,
            a_planner_in_a_sandbox_cannot_read_other_files,
        ),
        check_unless(
            "a_planner_and_a_finder_have_sandboxes_of_their_own",
            missing,
            a_planner_and_a_finder_have_sandboxes_of_their_own,
        ),
        check_unless(
            "unlinked_files_and_shared_memory_are_within_the_quota",
            missing_rooms,
            unlinked_files_and_shared_memory_are_within_the_quota,
        ),
        check(
            "processes_stand_still_while_the_twin_takes_images",
            processes_stand_still_while_the_twin_takes_images,
        ),
        check(
            "the_end_of_an_agent_is_not_its_compute_and_its_words_are_plain",
            the_end_of_an_agent_is_not_its_compute_and_its_words_are_plain,
        ),
        check_unless(
            "python_with_numpy_runs_in_a_sandbox",
            missing_numpy,
            python_with_numpy_runs_in_a_sandbox,
        ),
        check_unless(
            "a_static_program_runs_in_a_sandbox",
            missing_linker,
            a_static_program_runs_in_a_sandbox,
        ),
    ]
}
