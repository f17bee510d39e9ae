//! An agent that takes more of the machine than it may is ended; files that it must not see are kept from it.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

use std::process::ExitCode;
use std::time::Duration;

use ramp_external_agent::limits::Allowance;
use ramp_external_agent::process::Process;
use ramp_external_agent::sandbox::is_available;
use ramp_external_agent::{AgentFile, Patience, Sandbox, Silence, adopt_orphans};
use ramp_testing::trials::{check_unless, run};

/// Each way takes more in several processes or files than it would in one.
const GREEDY: &str = r#"
import os, sys, tempfile, threading, time
way, folder = WAY, FOLDER
if way == "memory":
    for _ in range(4):
        if os.fork() == 0:
            block = bytearray(100 << 20)
            time.sleep(60)
elif way == "processes":
    for _ in range(40):
        if os.fork() == 0:
            os.setsid()
            time.sleep(60)
elif way == "threads":
    for _ in range(30):
        threading.Thread(target=time.sleep, args=(60,), daemon=True).start()
elif way == "unlinked":
    files = [tempfile.TemporaryFile(dir=folder) for _ in range(4)]
    for file in files:
        file.write(bytes(10 << 20))
        file.flush()
elif way == "disk":
    for number in range(4):
        with open(os.path.join(folder, str(number)), "wb") as file:
            file.write(bytes(10 << 20))
time.sleep(60)
"#;

/// One after the other: ending an agent ends all children of the process that were not there before.
fn agents_are_kept_within_their_sandbox() {
    // As every program does that starts agents: what is forked while its parent is killed is met here.
    adopt_orphans();
    an_agent_that_takes_too_much_is_ended_with_all_that_it_has_started();
    what_is_hidden_must_not_lie_where_the_agent_may_read();
}

fn an_agent_that_takes_too_much_is_ended_with_all_that_it_has_started() {
    let allowance = Allowance { memory: 300 << 20, tasks: 20, disk: 30 << 20 };
    for (way, reason) in [
        ("memory", "used more than 300 MiB of memory"),
        ("processes", "had more than 20 processes and threads"),
        ("threads", "had more than 20 processes and threads"),
        ("unlinked", "wrote more than 30 MiB"),
        ("disk", "wrote more than 30 MiB"),
    ] {
        let folder = tempfile::TempDir::new().unwrap();
        let path = folder.path().join("greedy.py");
        std::fs::write(&path, "").unwrap();
        let agent = AgentFile::find(&path).unwrap();
        let sandbox = Sandbox::find(&agent, &[]).unwrap().with_allowance(allowance);
        let own = sandbox.folder().display();
        let program = GREEDY.replace("WAY", &format!("{way:?}")).replace("FOLDER", &format!("\"{own}\""));
        std::fs::write(&path, program).unwrap();
        let patience = Patience { answer: Duration::from_secs(50), end: None };
        let mut process = Process::start(sandbox.command(), patience, Some(&sandbox)).unwrap();
        assert_eq!(process.hear(), Err(Silence::Ended { how: reason.to_string() }), "{way}");
    }
}

/// A folder that does not exist yet is hidden as well, and so is one behind a link.
fn what_is_hidden_must_not_lie_where_the_agent_may_read() {
    let folder = tempfile::TempDir::new().unwrap();
    let (own, away) = (folder.path().join("agent"), folder.path().join("results"));
    std::fs::create_dir_all(&own).unwrap();
    std::fs::create_dir_all(&away).unwrap();
    std::fs::write(own.join("agent.py"), "").unwrap();
    std::os::unix::fs::symlink(&own, away.join("link")).unwrap();
    let agent = AgentFile::find(&own.join("agent.py")).unwrap();
    assert!(Sandbox::find(&agent, &[&away.join("new/out.json")]).is_ok());
    for hidden in [own.join("new/out.json"), away.join("link/new/out.json"), own.clone()] {
        let error = Sandbox::find(&agent, &[&hidden]).unwrap_err().to_string();
        assert!(error.ends_with("which the agent may read"), "{error}");
    }
}

fn missing() -> Option<String> {
    (!is_available()).then(|| "this kernel has no Landlock or no seccomp".to_string())
}

fn main() -> ExitCode {
    let name = "agents_are_kept_within_their_sandbox";
    run(vec![check_unless(name, missing, agents_are_kept_within_their_sandbox)])
}
