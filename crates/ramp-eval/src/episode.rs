//! One episode: an agent, the twin, and the referee between them.

use std::path::Path;
use std::time::Instant;

use ramp_robot::{
    Account, Agent, Camera, CameraModel, Command, Image, Observation, PartReading, Robot, RobotError,
};
use ramp_twin::{Setup, Twin, TwinError};

use crate::log::{LogError, Recorder, Sources};
use crate::referee::Referee;
use crate::result::{
    AgentInfo, Ended, EpisodeResult, EventInfo, FaultInfo, Host, PegResult, Physics, PlanInfo, RULES, SCHEMA,
    Software, Time,
};

/// The referee looks once in so many steps (10 ms).
const WATCH_EVERY: u64 = 10;

/// What a display may want to know while an episode runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Robot time, s.
    pub time: f64,
    /// Pegs that count now.
    pub seated: usize,
    /// Pegs in the goal.
    pub pegs: usize,
}

/// Called now and then with the progress and the twin, to be looked at.
pub type Watcher<'a> = dyn FnMut(&Progress, &Twin) + 'a;

/// Why an episode has no result.
#[derive(Debug, thiserror::Error)]
pub enum EpisodeError {
    /// The twin cannot be made.
    #[error(transparent)]
    Twin(#[from] TwinError),
    /// The log cannot be written.
    #[error(transparent)]
    Log(#[from] LogError),
}

/// What stands between agent and twin: forwards every call, lets the referee look, keeps the log and the agent's
/// clock. An agent gets it as `&mut dyn Robot` and has no way past it.
pub(crate) struct Judged<'a, 'w> {
    pub(crate) twin: &'a mut Twin,
    referee: Referee,
    /// The agent's own time so far, s.
    thought: f64,
    /// When the agent got the last answer.
    answered: Instant,
    steps: u64,
    /// What stopped the robot for good.
    stopped: Option<RobotError>,
    recorder: Option<Recorder>,
    watcher: &'a mut Watcher<'w>,
}

impl<'a, 'w> Judged<'a, 'w> {
    pub(crate) fn new(
        twin: &'a mut Twin,
        setup: &Setup,
        recorder: Option<Recorder>,
        watcher: &'a mut Watcher<'w>,
    ) -> Judged<'a, 'w> {
        let referee = Referee::new(setup.kit, setup.assembly, twin.part_names());
        let mut judged = Judged {
            twin,
            referee,
            thought: 0.0,
            answered: Instant::now(),
            steps: 0,
            stopped: None,
            recorder,
            watcher,
        };
        if let Some(recorder) = &mut judged.recorder {
            recorder.watch(judged.twin);
        }
        judged
    }

    /// The agent has called: what has passed since the last answer was its own time.
    fn called(&mut self) {
        self.thought += self.answered.elapsed().as_secs_f64();
    }

    /// The log, as long as the robot works.
    fn recorder(&mut self) -> Option<&mut Recorder> {
        self.recorder.as_mut().filter(|_| self.stopped.is_none())
    }

    /// The agent gets its answer.
    fn answer<T>(&mut self, result: Result<T, RobotError>) -> Result<T, RobotError> {
        if let Some(recorder) = self.recorder.as_mut().filter(|_| self.stopped.is_none()) {
            recorder.watch(self.twin);
        }
        if let Err(error) = &result
            && error.is_final()
            && self.stopped.is_none()
        {
            self.stopped = Some(error.clone());
        }
        self.answered = Instant::now();
        result
    }

    pub(crate) fn judge(&mut self) {
        self.referee.watch(&self.twin.truth(), self.thought);
        if let Some(recorder) = &mut self.recorder {
            recorder.judge(&self.referee);
        }
        let verdict = self.referee.verdict();
        let progress = Progress {
            time: self.twin.time(),
            seated: verdict.iter().flatten().count(),
            pegs: verdict.len(),
        };
        (self.watcher)(&progress, self.twin);
    }

    /// The pegs that count now, for each connection of the goal.
    pub(crate) fn pegs(&self, setup: &Setup) -> Vec<Option<PegResult>> {
        let assembly = setup.assembly;
        assembly
            .connections
            .iter()
            .zip(self.referee.verdict())
            .map(|(connection, seated)| {
                seated.as_ref().map(|seated| PegResult {
                    connection: connection.name.clone(),
                    joints: [connection.female, connection.male]
                        .map(|joint| assembly.joint_name(joint).to_string()),
                    peg: seated.peg.clone(),
                    t_robot: seated.since,
                    t_total: seated.since + seated.thought,
                })
            })
            .collect()
    }

    /// What became of the episode's fault.
    pub(crate) fn fault(&self) -> Option<FaultInfo> {
        self.twin.fault().map(FaultInfo::of)
    }

    pub(crate) fn physics(&self) -> Physics {
        Physics {
            deepest_penetration: self.twin.deepest_penetration(),
            largest_force: self.twin.largest_force(),
            state: format!("{:016x}", self.twin.state_hash()),
        }
    }
}

/// Pegs counted / pegs in the goal.
pub(crate) fn completion(pegs: &[Option<PegResult>]) -> f64 {
    if pegs.is_empty() { 0.0 } else { pegs.iter().flatten().count() as f64 / pegs.len() as f64 }
}

impl Robot for Judged<'_, '_> {
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError> {
        self.called();
        if let Some(recorder) = self.recorder() {
            recorder.step(command);
        }
        let result = match &self.stopped {
            Some(error) => Err(error.clone()),
            None => command.check_limits().and_then(|()| self.twin.step(command)),
        };
        self.steps += 1;
        if self.steps.is_multiple_of(WATCH_EVERY) {
            self.judge();
        }
        self.answer(result)
    }

    fn observe(&self) -> Observation {
        self.twin.observe()
    }

    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        self.called();
        if let Some(recorder) = self.recorder() {
            recorder.read_parts();
        }
        let before = self.twin.time();
        let result = match &self.stopped {
            Some(error) => Err(error.clone()),
            None => self.twin.read_parts(),
        };
        // Where a reading takes time, the world has moved on.
        if self.twin.time() > before {
            self.judge();
        }
        self.answer(result)
    }

    fn look(&mut self, camera: Camera) -> Result<Image, RobotError> {
        self.called();
        if let Some(recorder) = self.recorder() {
            recorder.look(camera);
        }
        let result = match &self.stopped {
            Some(error) => Err(error.clone()),
            None => self.twin.look(camera),
        };
        self.judge();
        self.answer(result)
    }

    fn camera(&self, camera: Camera) -> CameraModel {
        self.twin.camera(camera)
    }
}

/// Runs one episode to its end and judges it.
///
/// # Errors
/// When the twin cannot be made. Whatever ends the episode afterwards is part of its result.
pub fn run_episode(
    setup: &Setup,
    agent: &mut dyn Agent,
    software: &Software,
    repeat: u32,
    watcher: &mut Watcher,
) -> Result<EpisodeResult, TwinError> {
    let mut twin = Twin::new(setup)?;
    let mut judged = Judged::new(&mut twin, setup, None, watcher);
    Ok(run(&mut judged, setup, agent, software, repeat))
}

/// Runs one episode to its end, judges it, and leaves its log at `path`: whole, or not at all. `sources` are the texts
/// that the setup was read from.
///
/// # Errors
/// When the twin cannot be made or the log cannot be written.
pub fn record_episode(
    setup: &Setup,
    sources: &Sources,
    agent: &mut dyn Agent,
    software: &Software,
    repeat: u32,
    path: &Path,
    watcher: &mut Watcher,
) -> Result<EpisodeResult, EpisodeError> {
    let mut twin = Twin::new(setup)?;
    let recorder = Recorder::create(path, setup, sources, software, repeat)?;
    let mut judged = Judged::new(&mut twin, setup, Some(recorder), watcher);
    let mut result = run(&mut judged, setup, agent, software, repeat);
    if let Some(recorder) = judged.recorder.take() {
        result.log = Some(recorder.finish(twin.state_hash(), &result)?);
    }
    Ok(result)
}

fn run(
    judged: &mut Judged,
    setup: &Setup,
    agent: &mut dyn Agent,
    software: &Software,
    repeat: u32,
) -> EpisodeResult {
    judged.answered = Instant::now();
    let outcome = agent.run(judged);
    judged.called();
    judged.judge();
    let Account { planning, coarse, fine, replans, events } = agent.account();
    let thought = judged.thought;
    let planning = planning.clamp(0.0, thought);
    let robot = judged.twin.time();
    let pegs = judged.pegs(setup);
    let (name, version) = agent.name();
    let reason = match (agent.failure(), outcome) {
        (Some(failure), _) => failure,
        (None, Err(error)) => error.to_string(),
        (None, Ok(())) => "done".to_string(),
    };
    EpisodeResult {
        schema: SCHEMA.to_string(),
        rules: RULES.to_string(),
        goal: setup.assembly.name.clone(),
        class: setup.assembly.class.map(|class| class.name().to_string()),
        track: setup.track.name().to_string(),
        real: None,
        seed: setup.seed,
        repeat,
        agent: AgentInfo {
            name: name.to_string(),
            version: version.to_string(),
            sha256: agent.file_hash().map(str::to_string),
        },
        software: software.clone(),
        host: Host::here(),
        completion: completion(&pegs),
        pegs,
        time: Time { planning, compute: thought - planning, robot, total: thought + robot },
        plan: PlanInfo { coarse, fine, replans },
        events: events
            .into_iter()
            .map(|event| EventInfo { t: event.time, kind: event.kind.to_string(), what: event.what })
            .collect(),
        physics: Some(judged.physics()),
        fault: judged.fault(),
        ended: Ended { reason },
        log: None,
    }
}
