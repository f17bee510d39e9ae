//! Arguments shared by the commands that run many episodes.

use std::path::Path;
use std::time::Duration;

use miette::Report;
use ramp_data::Data;
use ramp_robot::Track;

use super::batch::{Batch, BatchPolicy, BatchStart, BatchWorld};
use super::goals::{BatchError, BatchGoal};
use crate::command::agent;
use crate::command::task::{self, state_hash};
use crate::engine::Backend;
use crate::options::{ArmOption, StartOption, TrackName, WorldOption};
use crate::software::software;

/// Arguments shared by the commands that run many episodes.
#[derive(clap::Args)]
pub struct Arguments {
    /// Knowledge that the agent has of the parts' poses
    #[arg(long, value_enum, default_value_t = TrackName::Tags)]
    track: TrackName,
    #[command(flatten)]
    arm: ArmOption,
    #[command(flatten)]
    pub world: WorldOption,
    #[command(flatten)]
    start: StartOption,
    #[command(flatten)]
    agent: agent::Arguments,
    /// Seed of the first episode of each goal
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    first_seed: u64,
    /// Number of parallel episodes; with more than one, planning and compute times are longer
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    jobs: u32,
    /// Run the episodes on a cluster of Ray, one on each processor. It needs the Python package with the
    /// extra `ray`, on all nodes. Without an address, it is the cluster that runs here, or a new one
    #[arg(long, value_name = "ray[:ADDRESS]", conflicts_with = "jobs")]
    pub backend: Option<Backend>,
    /// Wall-clock limit of an episode; if it is exceeded, the episode counts as lost
    #[arg(long, value_name = "SECONDS", default_value_t = 1800, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    limit: u64,
    /// Print the table as JSON
    #[arg(long)]
    pub json: bool,
}

impl Arguments {
    /// Returns true if an external agent program runs.
    pub fn has_agent(&self) -> bool {
        self.agent.has_program()
    }

    /// Gives the episodes of a batch their task, and the states in which their frames begin.
    ///
    /// # Errors
    /// If a frame cannot begin like that, or this agent has no such task.
    pub fn set_task<'a>(&self, batch: &mut Batch<'a>, task: &'a task::Arguments) -> Result<(), Report> {
        if task.has_state() && batch.goals.len() != 1 {
            return Err(BatchError::StateOfMany { count: batch.goals.len() }.into());
        }
        let start = self.start.read(batch.data)?;
        for goal in &mut batch.goals {
            let assembly = batch.data.goal(&goal.argument)?;
            let state = task.state(&assembly, &start, &self.agent)?;
            goal.state = state.as_ref().map(state_hash);
            goal.count = assembly.wanted(task.task());
        }
        batch.task = Some(task);
        Ok(())
    }

    /// The batch of `count` episodes of each of these goals, with its results folder. `option` is the option
    /// that gave the count, and `hidden` a file that the agent must not see.
    ///
    /// # Errors
    /// If the agent's file is invalid, or if the seeds exceed the largest `u64`.
    pub fn batch<'a>(
        &'a self,
        data: &'a Data,
        folder: &'a Path,
        goals: Vec<BatchGoal>,
        count: u32,
        option: &'static str,
        hidden: Option<&Path>,
    ) -> Result<Batch<'a>, Report> {
        if let Some(backend) = &self.backend {
            backend.check()?;
        }
        let last = self.first_seed.checked_add(u64::from(count) - 1);
        let agent = self.agent.file()?;
        let parts = self.agent.parts.read(&self.arm.of(data)?, self.track.into())?;
        // Report problems of the sandbox before any episode starts.
        let hidden = Vec::from_iter([Some(folder), hidden].into_iter().flatten());
        self.agent.sandboxes(agent.as_ref(), &parts, &hidden)?;
        if let Some(plans) = &parts.plans {
            plans.check(goals.iter().map(|goal| goal.name.as_str()))?;
            for goal in &goals {
                parts.plan(&data.goal(&goal.argument)?)?;
            }
        }
        let policy = self.agent.policy()?.map(|server| BatchPolicy {
            url: server.url().clone(),
            sha256: server.metadata().sha256.clone(),
            asynchronous: self.agent.asynchronous,
            name: (server.metadata().name.clone(), server.metadata().version.clone()),
        });
        let name = match &policy {
            Some(policy) => Some(policy.name.clone()),
            None => agent.is_none().then(|| parts.name()),
        };
        Ok(Batch {
            data,
            folder,
            track: Track::from(self.track).name(),
            arm: self.arm.name(),
            worlds: vec![BatchWorld::new(self.world.argument(), &self.world.read(data)?)],
            start: BatchStart::new(self.start.argument(), &self.start.read(data)?),
            limit: Duration::from_secs(self.limit),
            jobs: self.jobs as usize,
            agent,
            policy,
            agent_limit: self.agent.agent_limit,
            sandbox: self.agent.sandbox,
            secret: None,
            name,
            tapes: None,
            backend: self.backend.clone(),
            parts: &self.agent.parts,
            task: None,
            has_program: self.has_agent(),
            parameters_hash: parts.parameters.sha256.clone(),
            goals,
            count,
            seeds: self.first_seed..=last.ok_or(BatchError::Seeds { repeats: option })?,
            software: software(),
        })
    }
}
