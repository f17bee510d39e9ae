//! One episode: an agent, the twin, and the referee between them.

use std::time::Instant;

use ramp_robot::{Agent, Camera, CameraModel, Command, Image, Observation, PartReading, Robot, RobotError};
use ramp_twin::{Setup, Twin, TwinError};

use crate::referee::Referee;
use crate::result::{
    AgentInfo, Ended, EpisodeResult, EventInfo, Host, PegResult, Physics, PlanInfo, RULES, SCHEMA, Software,
    Time,
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

/// What stands between agent and twin: forwards every call, lets the referee look and keeps the agent's clock. An
/// agent gets it as `&mut dyn Robot` and has no way past it.
struct Judged<'a, 'w> {
    twin: &'a mut Twin,
    referee: Referee,
    /// The agent's own time so far, s.
    thought: f64,
    /// When the agent got the last answer.
    answered: Instant,
    steps: u64,
    watcher: &'a mut Watcher<'w>,
}

impl Judged<'_, '_> {
    /// The agent has called: what has passed since the last answer was its own time.
    fn called(&mut self) {
        self.thought += self.answered.elapsed().as_secs_f64();
    }

    fn judge(&mut self) {
        self.referee.watch(&self.twin.truth(), self.thought);
        let verdict = self.referee.verdict();
        let progress = Progress {
            time: self.twin.time(),
            seated: verdict.iter().flatten().count(),
            pegs: verdict.len(),
        };
        (self.watcher)(&progress, self.twin);
    }
}

impl Robot for Judged<'_, '_> {
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError> {
        self.called();
        let result = self.twin.step(command);
        self.steps += 1;
        if self.steps.is_multiple_of(WATCH_EVERY) {
            self.judge();
        }
        self.answered = Instant::now();
        result
    }

    fn observe(&self) -> Observation {
        self.twin.observe()
    }

    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        self.called();
        let before = self.twin.time();
        let result = self.twin.read_parts();
        // Where a reading takes time, the world has moved on.
        if self.twin.time() > before {
            self.judge();
        }
        self.answered = Instant::now();
        result
    }

    fn look(&mut self, camera: Camera) -> Result<Image, RobotError> {
        self.called();
        let result = self.twin.look(camera);
        self.judge();
        self.answered = Instant::now();
        result
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
    let referee = Referee::new(setup.kit, setup.assembly, twin.part_names());
    let mut judged =
        Judged { twin: &mut twin, referee, thought: 0.0, answered: Instant::now(), steps: 0, watcher };
    let outcome = agent.run(&mut judged);
    judged.called();
    judged.judge();
    let Judged { referee, thought, .. } = judged;
    let account = agent.account();
    let planning = account.planning.min(thought);
    let robot = twin.time();
    let assembly = setup.assembly;
    let pegs: Vec<Option<PegResult>> = assembly
        .connections
        .iter()
        .zip(referee.verdict())
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
        .collect();
    let (name, version) = agent.name();
    let counted = pegs.iter().flatten().count();
    Ok(EpisodeResult {
        schema: SCHEMA.to_string(),
        rules: RULES.to_string(),
        goal: assembly.name.clone(),
        class: assembly.class.map(|class| class.name().to_string()),
        track: setup.track.name().to_string(),
        real: None,
        seed: setup.seed,
        repeat,
        agent: AgentInfo { name: name.to_string(), version: version.to_string() },
        software: software.clone(),
        host: Host::here(),
        completion: if pegs.is_empty() { 0.0 } else { counted as f64 / pegs.len() as f64 },
        pegs,
        time: Time { planning, compute: thought - planning, robot, total: thought + robot },
        plan: PlanInfo { coarse: account.coarse, fine: account.fine, replans: account.replans },
        events: account
            .events
            .into_iter()
            .map(|event| EventInfo { t: event.time, kind: event.kind.to_string(), what: event.what })
            .collect(),
        physics: Some(Physics {
            deepest_penetration: twin.deepest_penetration(),
            state: format!("{:016x}", twin.state_hash()),
        }),
        ended: Ended {
            reason: match outcome {
                Ok(()) => "done".to_string(),
                Err(error) => error.to_string(),
            },
        },
    })
}
