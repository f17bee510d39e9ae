//! Programs that a command starts, and policy servers that it connects to.

use std::ffi::OsString;
use std::time::Duration;

use miette::{IntoDiagnostic, Report, miette};
use ramp_external_agent::sandbox::Inside;
use ramp_external_agent::{AgentFile, Sandbox};
use ramp_policy_client::{PolicyServer, PolicyUrl};

/// Help for a policy server that cannot be used.
const POLICY_HELP: &str = "start the server first; docs/src/reference/policies.md says what it has to send";

/// Connects to a policy server, within `limit` seconds.
pub fn find_policy(url: &PolicyUrl, limit: f64) -> Result<PolicyServer, Report> {
    PolicyServer::find(url, Duration::from_secs_f64(limit))
        .map_err(|error| miette!(help = POLICY_HELP, "the policy server {url} {error}"))
}

/// The command line that starts a program which ends with this process, in its sandbox if it has one.
pub fn command_of(file: &AgentFile, sandbox: Option<&Sandbox>) -> Result<Vec<OsString>, Report> {
    let mut command: Vec<OsString> = vec![
        std::env::current_exe().into_diagnostic()?.into(),
        "agent-process".into(),
        std::process::id().to_string().into(),
    ];
    let program = match sandbox {
        Some(sandbox) => {
            command.extend(words_of(&sandbox.inside()));
            sandbox.command().to_vec()
        }
        None => file.command(),
    };
    command.push("--".into());
    command.extend(program);
    Ok(command)
}

/// The arguments of `ramp agent-process` that set up a sandbox.
pub fn words_of(inside: &Inside) -> Vec<OsString> {
    let Inside { readable, folder, disk, tasks, rooms } = inside;
    let mut words: Vec<OsString> = vec!["--folder".into(), folder.into()];
    words.extend(["--disk".into(), disk.to_string().into(), "--tasks".into(), tasks.to_string().into()]);
    words.extend(readable.iter().flat_map(|path| ["--readable".into(), path.into()]));
    words.extend(rooms.then(|| "--rooms".into()));
    words
}
