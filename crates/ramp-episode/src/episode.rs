//! One episode: an agent, the twin, and the referee between them.

use std::path::Path;
use std::time::Instant;

use ramp_assembly::Task;
use ramp_log::header::{
    ArmText, GoalText, Header, KitText, SCHEMA as LOG_SCHEMA, Sources, StartText, StateText, WorldText,
};
use ramp_log::{LogError, Recorder, SecretSeed};
use ramp_result::episode::{
    AgentInfo, EndKind, Ended, EpisodeResult, FaultInfo, Host, PlanInfo, RULES, RobotTime, SCHEMA, Software,
    StartInfo, StateInfo, Time, WorldInfo,
};
use ramp_result::sha256;
use ramp_robot::{Account, Agent, Event, EventKind, MOST_EVENTS, RobotError};
use ramp_twin::{Setup, Stop, Twin, TwinError};

use crate::judged::{Judged, Watcher};
use crate::waiting::Waiting;

/// Reasons for which an episode has no result.
#[derive(Debug, thiserror::Error)]
pub enum EpisodeError {
    /// The twin cannot be made.
    #[error(transparent)]
    Twin(#[from] TwinError),
    /// The log cannot be begun.
    #[error(transparent)]
    Log(#[from] LogError),
}

/// The labels of an episode in its result and its log.
#[derive(Clone, Debug)]
pub struct Label {
    /// With what it is run.
    pub software: Software,
    /// Number of this run in a series, from 1.
    pub repeat: u32,
    /// With a secret that was mixed into the seed: the number that stands for the seed, and the secret's
    /// commitment. The seed of the setup is the one that came of both.
    pub secret: Option<(u64, String)>,
    /// Times to compare robot time with, if they are known.
    pub robot_time: Option<RobotTime>,
}

impl Label {
    /// Of an episode with no secret and nothing to compare its robot time with.
    pub fn new(software: Software, repeat: u32) -> Label {
        Label { software, repeat, secret: None, robot_time: None }
    }

    /// The number that stands for the seed.
    fn seed(&self, setup: &Setup) -> u64 {
        self.secret.as_ref().map_or(setup.seed, |(number, _)| *number)
    }

    fn commitment(&self) -> Option<String> {
        self.secret.as_ref().map(|(_, commitment)| commitment.clone())
    }
}

/// Runs one episode to its end and judges it.
///
/// # Errors
/// When the twin cannot be made. Whatever ends the episode afterwards is part of its result.
pub fn run_episode(
    setup: &Setup,
    agent: &mut dyn Agent,
    label: &Label,
    watcher: &mut Watcher,
) -> Result<EpisodeResult, TwinError> {
    Ok(run_episode_in(&mut Twin::new(setup)?, setup, agent, label, watcher))
}

/// As [`run_episode`], in a twin of this setup that was made before: for starts that are not those of the
/// sheet.
pub fn run_episode_in(
    twin: &mut Twin,
    setup: &Setup,
    agent: &mut dyn Agent,
    label: &Label,
    watcher: &mut Watcher,
) -> EpisodeResult {
    run(&mut Judged::new(twin, setup, None, watcher), setup, agent, label)
}

/// An episode that was run and recorded.
#[derive(Debug)]
pub struct Recorded {
    /// Its result; it names the log, if there is one.
    pub result: EpisodeResult,
    /// The reason for a missing log, if it could not be written.
    pub unlogged: Option<LogError>,
}

/// Runs one episode to its end, judges it, and leaves its log at `path`: whole, or not at all. `sources` are
/// the texts that the setup was read from. A log that cannot be written costs the log, and not the result.
///
/// # Errors
/// When the twin cannot be made or the log cannot be begun.
pub fn record_episode(
    setup: &Setup,
    sources: &Sources,
    agent: &mut dyn Agent,
    label: &Label,
    path: &Path,
    watcher: &mut Watcher,
) -> Result<Recorded, EpisodeError> {
    let mut twin = Twin::new(setup)?;
    let recorder = Recorder::create(
        path,
        &header(setup, sources, label),
        twin.part_names().map(str::to_string).collect(),
        counted_names(setup),
    )?;
    let mut judged = Judged::new(&mut twin, setup, Some(recorder), watcher);
    let mut result = run(&mut judged, setup, agent, label);
    let recorder = judged.recorder.take();
    let unlogged = match recorder.map(|recorder| recorder.finish(twin.state_hash(), &result)) {
        Some(Ok(hash)) => {
            result.log = Some(hash);
            None
        }
        Some(Err(error)) => Some(error),
        None => None,
    };
    Ok(Recorded { result, unlogged })
}

/// The names of what the referee counts: connections, or parts.
fn counted_names(setup: &Setup) -> Vec<String> {
    let Setup { assembly, task, .. } = setup;
    match task {
        Task::Build => assembly.connections.iter().map(|connection| connection.name.clone()).collect(),
        Task::TakeApart => assembly.movable_parts().into_iter().map(str::to_string).collect(),
    }
}

/// The head of an episode's log.
fn header(setup: &Setup, sources: &Sources, label: &Label) -> Header {
    Header {
        schema: LOG_SCHEMA.to_string(),
        rules: RULES.to_string(),
        goal: GoalText { name: setup.assembly.name.clone(), xml: sources.goal.to_string() },
        kit: KitText { sha256: sha256(sources.kit.as_bytes()), xml: sources.kit.to_string() },
        arm: ArmText { sha256: sha256(sources.arm.as_bytes()), json: sources.arm.to_string() },
        world: WorldText {
            name: setup.world.name.clone(),
            sha256: sha256(setup.world.text.as_bytes()),
            toml: setup.world.text.clone(),
        },
        start: StartText {
            name: setup.start.name.clone(),
            sha256: sha256(setup.start.text.as_bytes()),
            toml: setup.start.text.clone(),
        },
        state: setup
            .state
            .map(|state| StateText { sha256: sha256(state.text.as_bytes()), json: state.text.clone() }),
        task: setup.task.told().map(str::to_string),
        track: setup.track.name().to_string(),
        seed: label.seed(setup),
        secret: label.commitment().map(|commitment| SecretSeed { commitment, seed: setup.seed }),
        repeat: label.repeat,
        fault: setup.fault.map(|fault| fault.to_string()),
        software: label.software.clone(),
    }
}

/// Adds the events that no agent reports: that the arm was ready again after a stop, that the injected fault
/// struck, and that the robot stopped for good at `end`, s.
fn add_own(
    events: &mut Vec<Event>,
    stops: &[Stop],
    fault: Option<&FaultInfo>,
    stopped: Option<&RobotError>,
    end: f64,
) {
    // Room for all of them: within the time limit there are fewer stops than events.
    events.truncate(MOST_EVENTS.saturating_sub(2 + stops.len()));
    for Stop { time, why, after } in stops {
        let kind = EventKind::Recovered { why: why.clone(), after: *after };
        let place = events.iter().position(|event| event.time > *time).unwrap_or(events.len());
        events.insert(place, Event::new(*time, kind));
    }
    if let Some((fault, at)) = fault.and_then(|fault| Some((fault, fault.at?))) {
        let kind = EventKind::FaultStruck { fault: fault.kind.clone(), part: fault.part.clone() };
        let place = events.iter().position(|event| event.time > at).unwrap_or(events.len());
        events.insert(place, Event::new(at, kind));
    }
    if let Some(error) = stopped.filter(|error| error.is_final()) {
        events.push(Event::new(end, EventKind::Stopped { why: error.to_string() }));
    }
}

/// The kind of an end that the robot's error is the reason for.
pub(crate) fn kind_of(error: &RobotError) -> EndKind {
    match error {
        RobotError::OutOfTime { .. } => EndKind::Time,
        RobotError::Diverged { .. } => EndKind::Simulation,
        _ => EndKind::Robot,
    }
}

fn run(judged: &mut Judged, setup: &Setup, agent: &mut dyn Agent, label: &Label) -> EpisodeResult {
    let waiting = Waiting::begin();
    judged.answered = Instant::now();
    let outcome = agent.run(judged);
    judged.called();
    let waiting = waiting.share();
    // Before the results are there, which are not for the agent.
    agent.finish();
    judged.judge_end();
    let Account { planning, coarse, fine, replans, overlapped, mut events } = agent.account();
    let overlapped = if agent.is_asynchronous() { overlapped.max(0.0) } else { 0.0 };
    let thought = (judged.thought - overlapped).max(0.0);
    let planning = planning.clamp(0.0, thought);
    let robot = judged.twin.time();
    let (pegs, parts) = (judged.pegs(setup), judged.parts(setup));
    let (name, version) = agent.name();
    let fault = judged.fault();
    add_own(&mut events, judged.twin.stops(), fault.as_ref(), outcome.as_ref().err(), robot);
    let (reason, kind) = match (agent.failure(), outcome) {
        (Some(failure), _) if agent.is_late() => (failure, EndKind::Wall),
        (Some(failure), _) => (failure, EndKind::Agent),
        (None, Err(error)) => (error.to_string(), kind_of(&error)),
        (None, Ok(())) => ("done".to_string(), EndKind::Done),
    };
    let mut result = EpisodeResult {
        schema: SCHEMA.to_string(),
        rules: RULES.to_string(),
        goal: setup.assembly.name.clone(),
        class: setup.assembly.class.map(|class| class.name()),
        track: setup.track.name().to_string(),
        real: None,
        world: Some(WorldInfo::of(setup.world, setup.seed)),
        arm: Some(setup.arm.name.clone()),
        start: Some(StartInfo::of(setup.start)),
        state: setup.state.map(|state| StateInfo::of(&state.text)),
        task: setup.task.told().map(str::to_string),
        seed: label.seed(setup),
        secret: label.commitment(),
        repeat: label.repeat,
        agent: AgentInfo {
            name: name.to_string(),
            version: version.to_string(),
            sha256: agent.file_hash().map(str::to_string),
            asynchronous: agent.is_asynchronous(),
        },
        software: label.software.clone(),
        host: Host::here(),
        completion: 0.0,
        pegs,
        parts,
        rejected: judged.rejected(setup),
        time: Time {
            planning,
            compute: thought - planning,
            robot,
            total: thought + robot,
            agent_cpu: agent.processor_time(),
            waiting,
        },
        robot_time: label.robot_time,
        plan: PlanInfo { coarse, fine, replans },
        events,
        physics: Some(judged.physics()),
        fault,
        ended: Ended { reason, kind: Some(kind) },
        log: None,
    };
    result.completion = result.share();
    result
}
