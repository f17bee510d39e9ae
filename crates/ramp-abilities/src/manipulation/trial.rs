//! One trial: the twin is prepared, the agent does the task, the judge looks at the truth.

use ramp_result::episode::{AgentInfo, Host, Physics, Software, StartInfo, WorldInfo};
use ramp_result::manipulation::{SCHEMA, Trial};
use ramp_robot::{Agent, EventKind};
use ramp_twin::Setup;

use super::start::StartError;
use super::task::Task;
use super::{judge, start};

/// Prepares the twin, lets the agent do the task, and judges.
///
/// # Errors
/// When the twin cannot be made, or no start that is drawn holds. Whatever ends the trial afterwards is part
/// of its result.
pub fn run_trial(
    setup: &Setup,
    task: &Task,
    agent: &mut dyn Agent,
    software: &Software,
) -> Result<Trial, StartError> {
    let start::Start { mut twin, places, info: drawn } = start::draw(setup, task, &start::Cast::default())?;
    let outcome = agent.run(&mut twin);
    let missing = judge::missing(setup, task, &places, &twin);
    let account = agent.account();
    let cause = agent.failure().or_else(|| outcome.err().map(|error| error.to_string()));
    let (name, version) = agent.name();
    Ok(Trial {
        schema: SCHEMA.to_string(),
        skill: task.skill.clone(),
        track: setup.track.name().to_string(),
        world: WorldInfo::of(setup.world, setup.seed),
        seed: setup.seed,
        goal: setup.assembly.name.clone(),
        class: setup.assembly.class.map(|class| class.name()),
        step: task.step,
        action: task.action.clone(),
        start: StartInfo::of(setup.start),
        drawn,
        agent: AgentInfo {
            name: name.to_string(),
            version: version.to_string(),
            sha256: agent.file_hash().map(str::to_string),
            asynchronous: agent.is_asynchronous(),
        },
        software: software.clone(),
        host: Host::here(),
        success: missing.is_none(),
        cause,
        missing,
        retries: account.events.iter().filter(|it| matches!(it.kind, EventKind::Retry(_))).count(),
        time: twin.time(),
        physics: Physics {
            deepest_penetration: twin.deepest_penetration(),
            largest_force: twin.largest_force(),
            stops: twin.stops().len(),
            state: format!("{:016x}", twin.state_hash()),
        },
        events: account.events,
    })
}
