//! Who works: the baseline, or a program of one's own.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

use miette::{IntoDiagnostic, Report};
use ramp_assembly::Assembly;
use ramp_external_agent::{AgentFile, ExternalAgent, Goal, Patience, adopt_orphans, exec_with_parent};
use ramp_kit::Kit;
use ramp_planner::Domains;
use ramp_robot::arm::ArmModel;
use ramp_robot::{Agent, Event, Track};
use ramp_skills::{Baseline, Parameters};

use crate::command::skills;
use crate::data::Texts;

/// What `ramp run` and `ramp bench` are told of the agent.
#[derive(clap::Args)]
pub struct Arguments {
    /// An agent of your own instead of the baseline: an executable, or a Python file
    #[arg(long, value_name = "FILE", conflicts_with = "path")]
    pub agent: Option<PathBuf>,
    /// Longest time that your agent may take for a message, after which its episode ends
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = seconds)]
    pub agent_limit: f64,
    #[command(flatten)]
    pub skills: skills::File,
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.01..=1e6).contains(&seconds) => Ok(seconds),
        _ => Err("a number of seconds from 0.01 to 1000000 is expected".to_string()),
    }
}

impl Arguments {
    /// The agent's file, if there is one.
    pub fn file(&self) -> Result<Option<AgentFile>, Report> {
        self.agent.as_deref().map(AgentFile::find).transpose().into_diagnostic()
    }
}

/// What an agent is made from.
pub struct World<'a> {
    pub kit: &'a Kit,
    pub assembly: &'a Assembly,
    pub arm: &'a ArmModel,
    pub domains: &'a Domains,
    pub texts: &'a Texts,
    pub track: Track,
    pub seed: u64,
    /// The numbers of the baseline's skills.
    pub parameters: &'a Arc<Parameters>,
}

/// Starts the agent. It tells `listener` what it does.
pub fn start<'a>(
    world: &World<'a>,
    file: Option<&AgentFile>,
    limit: f64,
    end: Option<Instant>,
    listener: impl FnMut(&Event) + 'a,
) -> Result<Box<dyn Agent + 'a>, Report> {
    let World { kit, assembly, arm, domains, texts, track, seed, parameters } = *world;
    let Some(file) = file else {
        let baseline = Baseline::new(kit, assembly, arm, domains, seed).with_parameters(parameters.clone());
        return Ok(Box::new(baseline.with_listener(listener)));
    };
    adopt_orphans();
    let goal = Goal::new(kit, assembly, arm, track, texts.sources());
    let patience = Patience { answer: Duration::from_secs_f64(limit), end };
    let mut command: Vec<OsString> = vec![
        std::env::current_exe().into_diagnostic()?.into(),
        "agent-process".into(),
        std::process::id().to_string().into(),
        "--".into(),
    ];
    command.extend(file.command());
    let agent = ExternalAgent::start(file, &command, goal, patience).into_diagnostic()?;
    Ok(Box::new(agent.with_listener(listener)))
}

/// How a run becomes the parent of an agent that cannot outlive it.
#[derive(clap::Args)]
pub struct ProcessArguments {
    /// Number of the run's process
    parent: u32,
    /// The agent's program and its arguments
    #[arg(last = true, required = true)]
    command: Vec<OsString>,
}

/// Replaces this program by the agent's.
pub fn become_agent(arguments: &ProcessArguments) -> ExitCode {
    let error = exec_with_parent(arguments.parent, &arguments.command);
    let program = arguments.command.first().map(|it| it.to_string_lossy()).unwrap_or_default();
    eprintln!("{program} cannot be started: {error}");
    ExitCode::from(127)
}
