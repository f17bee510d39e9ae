//! The agent of an episode: the baseline or an external program.

use std::cell::Cell;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use miette::{IntoDiagnostic, Report, miette};
use ramp_assembly::{Assembly, Task};
use ramp_data::Texts;
use ramp_external_agent::sandbox::{Inside, open_ends};
use ramp_external_agent::{
    AgentFile, ExternalAgent, GoalMessage, Patience, Sandbox, SandboxError, adopt_orphans,
};
use ramp_planner::Plan;
use ramp_policy_client::{PolicyAgent, PolicyServer, PolicyUrl};
use ramp_robot::{Agent, Event};
use ramp_twin::Setup;
use serde_json::{Value, json};

use crate::command::parts::{self, Parts, Sandboxes};
use crate::command::program::{command_of, find_policy, words_of};
use crate::output::tell;

/// Agent options of `ramp run` and `ramp bench`.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("program").multiple(true))]
pub struct Arguments {
    /// Run this agent instead of the baseline: an executable, or a Python file
    #[arg(long, value_name = "FILE", conflicts_with = "path", group = "program")]
    pub agent: Option<PathBuf>,
    /// Run the policy behind this server of openpi's or RoboArena's kind instead of the baseline
    #[arg(long, value_name = "ws://HOST:PORT", conflicts_with_all = ["agent", "path", "skill", "plan", "planner", "finder", "domain"])]
    pub policy: Option<PolicyUrl>,
    /// Let the robot go on while the policy computes: its last actions play on, and then it holds still. Such
    /// a result is no function of its seed, and is kept apart from others
    #[arg(long = "async", requires = "policy")]
    pub asynchronous: bool,
    /// Time limit for each message of the agent, or answer of the policy; if it is exceeded, the episode ends
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = seconds)]
    pub agent_limit: f64,
    /// Run the agent, the planner and the finder in sandboxes, without access to your files, the network and
    /// other processes
    #[arg(long, requires = "program")]
    pub sandbox: bool,
    #[command(flatten)]
    pub parts: parts::Arguments,
}

/// Reads a number of seconds from the command line.
pub fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.01..=1e6).contains(&seconds) => Ok(seconds),
        _ => Err("a number of seconds from 0.01 to 1000000 is expected".to_string()),
    }
}

impl Arguments {
    /// Returns true if an external program runs.
    pub fn has_program(&self) -> bool {
        self.agent.is_some() || self.parts.has_program()
    }

    /// The agent's file, if there is one.
    pub fn file(&self) -> Result<Option<AgentFile>, Report> {
        self.agent.as_deref().map(AgentFile::find).transpose().into_diagnostic()
    }

    /// The policy server, if there is one: it has said what its policy is.
    ///
    /// # Errors
    /// If it cannot be reached, or is not one.
    pub fn policy(&self) -> Result<Option<PolicyServer>, Report> {
        self.policy.as_ref().map(|url| find_policy(url, self.agent_limit)).transpose()
    }

    /// The sandboxes of the programs, if requested. `hidden` lists files and folders that they must not see.
    /// Tells which things they do not hide on this system.
    ///
    /// # Errors
    /// If this system has no sandbox, or if a program's own folder contains a hidden file.
    pub fn sandboxes(
        &self,
        agent: Option<&AgentFile>,
        parts: &Parts,
        hidden: &[&Path],
    ) -> Result<Sandboxes, Report> {
        let sandboxes = Sandboxes {
            agent: self.sandbox(agent, hidden)?,
            planner: self.sandbox(parts.planner.as_ref(), hidden)?,
            finder: self.sandbox(parts.finder.as_ref(), hidden)?,
        };
        let Sandboxes { agent, planner, finder } = &sandboxes;
        if let Some(sandbox) = agent.as_ref().or(planner.as_ref()).or(finder.as_ref()) {
            let open = open_ends(sandbox.has_rooms()).join("; ");
            tell(&format!("the sandbox does not hide: {open}"));
        }
        Ok(sandboxes)
    }

    /// The sandbox of a program, if requested.
    fn sandbox(&self, file: Option<&AgentFile>, hidden: &[&Path]) -> Result<Option<Sandbox>, Report> {
        let Some(file) = file.filter(|_| self.sandbox) else { return Ok(None) };
        let sandbox = Sandbox::find(file, hidden).map_err(|error| match error {
            SandboxError::NoLandlock => miette!(
                help = "run agents of strangers in a container (docs/src/howto/run-a-strangers-agent.md)",
                "{error}"
            ),
            SandboxError::Exposed { .. } => {
                miette!(help = "put the agent into a folder of its own, away from the results", "{error}")
            }
            _ => miette!("{error}"),
        })?;
        let sandbox = sandbox.with_rooms();
        Ok(Some(if rooms_stand(&sandbox).into_diagnostic()? { sandbox } else { sandbox.without_rooms() }))
    }
}

/// Whether this system allows the name spaces of a sandbox: a process tries them.
fn rooms_stand(sandbox: &Sandbox) -> std::io::Result<bool> {
    let status = std::process::Command::new(std::env::current_exe()?)
        .args(["agent-process", &std::process::id().to_string(), "--try"])
        .args(words_of(&sandbox.inside()))
        .args(["--", "true"])
        .stdin(std::process::Stdio::null())
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .status()?;
    Ok(status.success())
}

/// Inputs from which an agent is built.
pub struct AgentSetup<'a> {
    /// The episode.
    pub setup: Setup<'a>,
    pub texts: &'a Texts,
    /// Parts of the baseline.
    pub parts: &'a Parts,
    /// Plan that the baseline executes instead of its own.
    pub plan: Option<Plan>,
    /// The policy, if one runs instead of the baseline.
    pub policy: Option<&'a PolicyServer>,
    /// Whether the robot goes on while it computes.
    pub asynchronous: bool,
    /// Whether every peg of the goal counts now.
    pub complete: &'a Cell<bool>,
}

/// Starts the agent. It reports its actions to `listener`.
pub fn start<'a>(
    inputs: &AgentSetup<'a>,
    file: Option<&AgentFile>,
    sandboxes: Sandboxes,
    limit: f64,
    end: Option<Instant>,
    listener: impl FnMut(&Event) + 'a,
) -> Result<Box<dyn Agent + 'a>, Report> {
    let AgentSetup { ref setup, texts, parts, ref plan, policy, asynchronous, complete } = *inputs;
    let Setup { assembly, arm, track, start, .. } = *setup;
    let patience = Patience { answer: Duration::from_secs_f64(limit), end };
    if let Some(server) = policy {
        let is_complete = Box::new(|| complete.get());
        let agent = PolicyAgent::new(server, patience, assembly, arm, is_complete);
        return Ok(Box::new(agent.asynchronous(asynchronous)));
    }
    let Some(file) = file else {
        return Ok(Box::new(
            parts.agent(setup, texts, limit, plan.clone(), sandboxes)?.with_listener(listener),
        ));
    };
    adopt_orphans();
    let mut goal = GoalMessage::new(assembly, arm, track, start, texts.sources());
    if setup.task != Task::Build {
        goal = goal.with_task(take_apart(assembly));
    }
    let command = command_of(file, sandboxes.agent.as_ref())?;
    let agent = ExternalAgent::start(file, &command, goal, patience, sandboxes.agent).into_diagnostic()?;
    Ok(Box::new(agent.with_listener(listener)))
}

/// The task of taking a frame apart as an agent is told it: what pins the frame.
fn take_apart(assembly: &Assembly) -> Value {
    let connections = assembly.connections.iter().map(|connection| &connection.name);
    let pinned: Vec<_> = connections.zip(assembly.built_with()).collect();
    json!({"kind": Task::TakeApart.name(), "pinned": pinned, "parts": assembly.movable_parts()})
}

/// Arguments of the internal command that starts an agent which ends with its run.
#[derive(clap::Args)]
pub struct ProcessArguments {
    /// Number of the run's process
    parent: u32,
    /// The agent's own folder, where it is in a sandbox
    #[arg(long, requires_all = ["disk", "tasks"])]
    folder: Option<PathBuf>,
    /// Space for its files, bytes
    #[arg(long)]
    disk: Option<u64>,
    /// Processes and threads that it may have
    #[arg(long)]
    tasks: Option<u64>,
    /// Other paths that it may read
    #[arg(long)]
    readable: Vec<PathBuf>,
    /// Give it name spaces of its own
    #[arg(long)]
    rooms: bool,
    /// Only try whether the sandbox stands
    #[arg(long = "try", requires = "folder")]
    try_only: bool,
    /// The agent's program and its arguments
    #[arg(last = true, required = true)]
    command: Vec<OsString>,
}

/// Replaces this process by the agent's program (`exec`).
pub fn become_agent(arguments: &ProcessArguments) -> ExitCode {
    let ProcessArguments { parent, folder, disk, tasks, readable, rooms, try_only, command } = arguments;
    let inside = folder.clone().zip(*disk).zip(*tasks).map(|((folder, disk), tasks)| Inside {
        readable: readable.clone(),
        folder,
        disk,
        tasks,
        rooms: *rooms,
    });
    if let Some(inside) = inside.as_ref().filter(|_| *try_only) {
        return if inside.enter().is_ok() { ExitCode::SUCCESS } else { ExitCode::FAILURE };
    }
    let error = ramp_external_agent::become_agent(*parent, inside.as_ref(), command);
    let program = command.first().map(|it| it.to_string_lossy()).unwrap_or_default();
    tell(&format!("{program} cannot be started: {error}"));
    ExitCode::from(127)
}
