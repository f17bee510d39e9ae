//! One environment: reset, act, be judged.

use std::sync::Arc;

use nalgebra::{Translation3, Vector6};
use ramp_abilities::manipulation::{Aim, Progress, missing, progress};
use ramp_kit::Pose;
use ramp_referee::Referee;
use ramp_render::{Looks, LooksError};
use ramp_robot::random::Stream;
use ramp_robot::{GripperCommand, Observation, PERIOD, Robot, RobotError, Track};
use ramp_twin::{RestoreError, Twin};

use crate::action::{ActionKind, Driver};
use crate::observe::{Field, Row, error, fields};
use crate::pictures::{Painter, View};
use crate::reward::{Outcome, RewardTerms, Weights};
use crate::scenario::{Mission, Scenario};
use crate::start::{BeginError, KEPT, Pool, Prepared};

/// A part that was in the hand at the start and is further from the tip than this, m, is lost.
const DROPPED: f64 = 0.06;

/// How an environment is driven, what it shows, and how it rewards.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Meaning of the numbers of an action.
    pub action: ActionKind,
    /// Whether an action has a number for the gripper.
    pub gripper: bool,
    /// Control periods of a millisecond for each action.
    pub periods: u32,
    /// An episode is cut off after so much robot time, s.
    pub limit: f64,
    /// Starts that episodes are drawn from: the first seed, and how many in a row. 0 of them: each episode
    /// has its own.
    pub starts: (u64, u64),
    /// Standard deviation of the error of the believed goal pose along x and y, m; a fifth of it along z.
    /// Constant within an episode.
    pub belief_error: f64,
    /// How the reward is weighed.
    pub weights: Weights,
    /// Images.
    pub views: Vec<View>,
    /// Whether to tell the truth about the task with each step: for labels and training, never for a policy.
    pub truth: bool,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            action: ActionKind::Cartesian(crate::action::Cartesian::default()),
            gripper: true,
            periods: 50,
            limit: 10.0,
            starts: (1, 64),
            belief_error: 0.0,
            weights: Weights::sparse(),
            views: Vec::new(),
            truth: false,
        }
    }
}

/// Why an environment cannot go on.
#[derive(Debug, Clone, thiserror::Error)]
pub enum EnvError {
    /// There is no start.
    #[error(transparent)]
    Begin(#[from] BeginError),
    /// The state of a start cannot be taken up.
    #[error("{0}")]
    State(String),
    /// Seeds of starts beyond the largest number.
    #[error("found {count} starts from seed {first} on, expected seeds below 2^64")]
    Starts {
        /// The first seed.
        first: u64,
        /// The number of starts.
        count: u64,
    },
    /// It was not reset.
    #[error("the environment was not reset")]
    NotReset,
    /// An action of the wrong length.
    #[error("the action has {found} numbers, and {expected} were expected")]
    Length {
        /// How many it has.
        found: usize,
        /// How many it should have.
        expected: usize,
    },
    /// The cameras have nothing to show.
    #[error("{0}")]
    Looks(String),
}

impl From<RestoreError> for EnvError {
    fn from(error: RestoreError) -> EnvError {
        EnvError::State(error.to_string())
    }
}

impl From<LooksError> for EnvError {
    fn from(error: LooksError) -> EnvError {
        EnvError::Looks(error.to_string())
    }
}

/// Outcome of an action.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Step {
    /// The terms of the reward.
    pub terms: RewardTerms,
    /// The task is done, as its judge sees it.
    pub success: bool,
    /// The episode is over: done, or lost, or the arm has stopped.
    pub terminated: bool,
    /// The episode's time is over.
    pub truncated: bool,
    /// Why the arm has stopped, or what was lost.
    pub cause: Option<String>,
    /// How far the truth is from the aim.
    pub progress: Progress,
    /// Share of the goal's pegs that count; of a skill 1 if it is done.
    pub completion: f64,
}

/// The episode that is running.
struct Episode {
    twin: Twin,
    start: Arc<Prepared>,
    driver: Driver,
    tare: Vector6<f64>,
    /// Error of the belief, m in the world.
    off: Translation3<f64>,
    referee: Option<Referee>,
    completion: f64,
    /// Poses of the parts that are told on a noisy track, as they were read at the start.
    readings: Vec<Option<Pose>>,
    /// Robot time at which it is cut off, s.
    end: f64,
    over: bool,
}

/// One environment.
pub struct Env {
    scenario: Arc<Scenario>,
    options: Arc<Options>,
    pool: Arc<Pool>,
    fields: Arc<[Field]>,
    /// The parts whose poses are told.
    part_names: Arc<[String]>,
    /// Source of the episodes' seeds.
    stream: Stream,
    episode: Option<Episode>,
    painters: Vec<Painter>,
}

/// Meshes and textures for the images of a scenario.
fn looks_of(scenario: &Scenario) -> Result<Arc<Looks>, LooksError> {
    let (kit, arm) = (&scenario.benchmark.kit, &scenario.benchmark.arm);
    if scenario.track.has_tags() { Looks::shared(kit, arm) } else { Looks::shared_without_tags(kit, arm) }
}

impl Env {
    /// An environment; its episodes are drawn from seed 0 until it is reset with another.
    ///
    /// # Errors
    /// When there is nothing to draw for its images, or seeds of its starts are too large.
    pub fn new(scenario: Arc<Scenario>, options: Options) -> Result<Env, EnvError> {
        let (first, count) = options.starts;
        if first.checked_add(count).is_none() {
            return Err(EnvError::Starts { first, count });
        }
        let looks = if options.views.is_empty() { None } else { Some(looks_of(&scenario)?) };
        let skill = scenario.mission != Mission::Goal;
        let mut part_names: Vec<String> = Vec::new();
        // Part poses follow the track: exact, or as they were read at the start.
        if !skill && !scenario.track.gives_images() {
            let kit = &scenario.benchmark.kit;
            part_names.extend(kit.beams.iter().map(|it| it.name.clone()));
            part_names.extend(kit.pegs.iter().map(|it| it.name.clone()));
        }
        let mut env = Env {
            fields: fields(scenario.world.has_touch(), skill, part_names.len()).into(),
            part_names: part_names.into(),
            pool: Arc::default(),
            stream: Stream::new(0, "episodes"),
            episode: None,
            painters: Vec::new(),
            scenario,
            options: Arc::new(options),
        };
        if let Some(looks) = looks {
            env.painters = env.paint_with(&looks);
        }
        Ok(env)
    }

    /// Another environment of the same kind, which shares the starts.
    ///
    /// # Errors
    /// As [`Env::new`].
    pub fn sibling(&self) -> Result<Env, EnvError> {
        let looks = if self.options.views.is_empty() { None } else { Some(looks_of(&self.scenario)?) };
        Ok(Env {
            scenario: Arc::clone(&self.scenario),
            options: Arc::clone(&self.options),
            pool: Arc::clone(&self.pool),
            fields: Arc::clone(&self.fields),
            part_names: Arc::clone(&self.part_names),
            stream: Stream::new(0, "episodes"),
            episode: None,
            painters: looks.map(|looks| self.paint_with(&looks)).unwrap_or_default(),
        })
    }

    fn paint_with(&self, looks: &Arc<Looks>) -> Vec<Painter> {
        let tip = self.scenario.benchmark.arm.hand.tip;
        self.options.views.iter().map(|view| Painter::new(*view, Arc::clone(looks), tip)).collect()
    }

    /// Its scenario.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// How it is driven.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// The names, shapes and places of the numbers of an observation.
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// Numbers of an observation.
    pub fn width(&self) -> usize {
        self.fields.last().map_or(0, |last| last.offset + last.len())
    }

    /// Numbers of an action.
    pub fn actions(&self) -> usize {
        self.options.action.numbers() + usize::from(self.options.gripper)
    }

    /// Lowest and highest of each number of an action.
    pub fn bounds(&self) -> Vec<[f64; 2]> {
        self.options.action.bounds(&self.scenario.benchmark.arm, self.options.gripper)
    }

    /// The parts whose poses an observation tells.
    pub fn part_names(&self) -> &[String] {
        &self.part_names
    }

    /// Makes all starts that episodes are drawn from, on so many threads: later resets take microseconds. At
    /// most 1024 are kept. Does nothing where each episode has its own.
    ///
    /// # Errors
    /// When one of them cannot be made.
    pub fn prepare(&self, threads: usize) -> Result<(), EnvError> {
        let (first, count) = self.options.starts;
        let count = count.min(KEPT as u64);
        Ok(self.pool.fill(&self.scenario, first..first.saturating_add(count), threads)?)
    }

    /// Begins a new episode. With a seed, the episodes from here on are those of the seed; without one, the
    /// next of them.
    ///
    /// # Errors
    /// When there is no start.
    pub fn reset(&mut self, seed: Option<u64>) -> Result<(), EnvError> {
        if let Some(seed) = seed {
            self.stream = Stream::new(seed, "episodes");
        }
        let (first, count) = self.options.starts;
        let draw = self.stream.uniform();
        let off = [0, 1, 2].map(|axis| {
            let sigma = self.options.belief_error * if axis == 2 { 0.2 } else { 1.0 };
            self.stream.normal(sigma)
        });
        let own = if count == 0 { (draw * (1u64 << 53) as f64) as u64 } else { (draw * count as f64) as u64 };
        let start = self.pool.get(&self.scenario, first.saturating_add(own))?;
        let before = self.episode.take().map(|episode| episode.twin);
        let mut twin = match before {
            Some(mut twin) => match twin.restore(&start.twin.snapshot()) {
                Ok(()) => twin,
                // Of another scene.
                Err(_) => start.twin.duplicate(),
            },
            None => start.twin.duplicate(),
        };
        let readings = self.readings(&mut twin);
        for painter in &mut self.painters {
            painter.dress(&twin).map_err(|error| EnvError::Looks(error.to_string()))?;
        }
        let seen = twin.observe();
        let (gripper, held) = match &start.known {
            Some(known) => (known.gripper, known.held.clone()),
            None => (GripperCommand { width: seen.width, force: 20.0 }, None),
        };
        let referee = (self.scenario.mission == Mission::Goal).then(|| {
            let assembly = &self.scenario.goals[0].assembly;
            Referee::new(assembly, twin.part_names())
        });
        self.episode = Some(Episode {
            driver: Driver::new(&self.options.action, &self.scenario.benchmark.arm, &seen, gripper, held),
            tare: seen.wrench,
            off: Translation3::from(off),
            end: seen.time + self.options.limit,
            referee,
            completion: 0.0,
            readings,
            over: false,
            twin,
            start,
        });
        self.paint();
        Ok(())
    }

    /// Reads the parts once, on a track that has noisy readings.
    fn readings(&self, twin: &mut Twin) -> Vec<Option<Pose>> {
        if self.scenario.track != Track::Noisy || self.part_names.is_empty() {
            return Vec::new();
        }
        let readings = twin.read_parts().unwrap_or_default();
        let of = |name: &String| readings.iter().find(|it| it.part == *name).map(|it| it.x_wp);
        self.part_names.iter().map(of).collect()
    }

    /// Lets an action work for its periods. A number that is not finite, or an arm that stops, ends the
    /// episode with its cause; an episode that is over stays so.
    ///
    /// # Errors
    /// When it was not reset, or the action has not as many numbers as it should.
    pub fn step(&mut self, action: &[f64]) -> Result<Step, EnvError> {
        let expected = self.actions();
        if action.len() != expected {
            return Err(EnvError::Length { found: action.len(), expected });
        }
        let Some(episode) = &mut self.episode else { return Err(EnvError::NotReset) };
        let mut stopped = None;
        if episode.over {
            stopped = Some("the episode was over".to_string());
        } else if action.iter().any(|number| !number.is_finite()) {
            stopped = Some("a number of the action is not finite".to_string());
        } else {
            let mut seen = episode.twin.observe();
            for _ in 0..self.options.periods {
                let command = episode.driver.command(action, &seen);
                match episode.twin.step(&command) {
                    Ok(now) => seen = now,
                    Err(error) => {
                        stopped = Some(words(&error));
                        break;
                    }
                }
            }
        }
        Ok(self.judge(stopped))
    }

    fn judge(&mut self, stopped: Option<String>) -> Step {
        let Some(episode) = &mut self.episode else { return Step::default() };
        let start = &episode.start;
        let setup = self.scenario.setup(start.task.0, start.seed);
        let mut step = Step { cause: stopped, ..Step::default() };
        let mut gained = 0.0;
        match (&self.scenario.mission, &mut episode.referee) {
            (Mission::Skill { .. }, _) => {
                let task = &self.scenario.goals[start.task.0].steps[start.task.1].task;
                let held = start.known.as_ref().and_then(|known| known.held.as_ref());
                let peg = held.map(|held| held.part.as_str());
                step.progress = progress(&setup, task, &start.places, peg, &episode.twin);
                step.success =
                    step.cause.is_none() && missing(&setup, task, &start.places, &episode.twin).is_none();
                step.completion = f64::from(u8::from(step.success));
                let lost = held.filter(|_| !step.success && !laid(&task.aim)).is_some_and(|held| {
                    let index = episode.twin.part_names().position(|name| name == held.part);
                    let tip = episode.twin.observe().x_wt;
                    let meant = tip * held.x_tp;
                    let truth = index.and_then(|index| episode.twin.truth().x_wp.get(index).copied());
                    truth.is_some_and(|x| (x.translation.vector - meant.translation.vector).norm() > DROPPED)
                });
                if lost && step.cause.is_none() {
                    step.cause = held.map(|held| format!("{} is no longer in the hand", held.part));
                }
            }
            (Mission::Goal, Some(referee)) => {
                referee.watch(&episode.twin.truth(), 0.0);
                let verdict = referee.verdict();
                let counted = verdict.iter().flatten().count() as f64;
                step.completion = counted / verdict.len().max(1) as f64;
                step.success = counted as usize == verdict.len();
                gained = step.completion - episode.completion;
                episode.completion = step.completion;
            }
            (Mission::Goal, None) => {}
        }
        let time = episode.twin.time();
        let seen = episode.twin.observe();
        let force = seen.wrench - episode.tare;
        let outcome = Outcome {
            progress: step.progress,
            success: step.success,
            lost: step.cause.is_some(),
            sideways: force.xy().norm(),
            took: f64::from(self.options.periods) * PERIOD / self.options.limit,
            left: ((episode.end - time) / self.options.limit).clamp(0.0, 1.0),
        };
        step.terms = self.options.weights.terms(&outcome);
        if self.scenario.mission == Mission::Goal {
            // Peg by peg, as the benchmark counts.
            step.terms.progress = gained;
        }
        step.terminated = step.success || step.cause.is_some();
        step.truncated = !step.terminated && time >= episode.end - PERIOD / 2.0;
        episode.over = step.terminated || step.truncated;
        self.paint();
        step
    }

    fn paint(&mut self) {
        if let Some(episode) = &self.episode {
            self.painters.iter_mut().for_each(|painter| painter.paint(&episode.twin));
        }
    }

    /// Writes what an agent on this track knows now, as [`Env::fields`] says; nothing before the first reset.
    pub fn observe(&self, out: &mut [f32]) {
        let Some(episode) = &self.episode else { return };
        let seen = episode.twin.observe();
        let mut row = Row::new(out);
        row.sensed(&seen, &episode.tare, &episode.driver.lead(&seen));
        if episode.start.known.is_some() {
            let (x_wp, x_goal) = self.believed(episode, &seen);
            row.pose(&x_wp);
            let from = if matches!(self.aim(episode), Some(Aim::Held { .. })) { seen.x_wt } else { x_wp };
            row.put(error(&from, &x_goal).as_slice());
        }
        if !self.part_names.is_empty() {
            let truth = (self.scenario.track == Track::State).then(|| episode.twin.truth().x_wp);
            for (index, name) in self.part_names.iter().enumerate() {
                let at = truth.as_ref().and_then(|truth| {
                    let index = episode.twin.part_names().position(|other| other == name)?;
                    truth.get(index).copied()
                });
                let read = episode.readings.get(index).copied().flatten();
                row.pose(&at.or(read).unwrap_or_default());
            }
        }
        row.put(&[((episode.end - seen.time) / self.options.limit).clamp(0.0, 1.0)]);
    }

    fn aim(&self, episode: &Episode) -> Option<&Aim> {
        let (goal, step) = episode.start.task;
        self.scenario.goals.get(goal)?.steps.get(step).map(|step| &step.task.aim)
    }

    /// Believed poses of the task's part and of its goal, in the world. A held part moves with the hand; on
    /// track `state` the pose of a part is exact.
    fn believed(&self, episode: &Episode, seen: &Observation) -> (Pose, Pose) {
        let Some(known) = &episode.start.known else { return Default::default() };
        let true_pose = |name: &str| {
            let index = episode.twin.part_names().position(|other| other == name)?;
            episode.twin.truth().x_wp.get(index).copied()
        };
        let exact = if self.scenario.track == Track::State { true_pose(&known.part) } else { None };
        let by_hand = known.held.as_ref().map(|held| seen.x_wt * held.x_tp);
        let x_wp = exact.or(by_hand).unwrap_or(known.x_wp);
        (x_wp, episode.off * known.x_goal)
    }

    /// The image of a view: red, green and blue of each pixel, row by row from the top left.
    pub fn image(&self, view: usize) -> Option<&[u8]> {
        self.painters.get(view).map(|painter| painter.colour.as_slice())
    }

    /// The depth image of a view: m along the optical axis, infinite where nothing is; empty where none was
    /// asked for.
    pub fn depth(&self, view: usize) -> Option<&[f32]> {
        self.painters.get(view).map(|painter| painter.depth.as_slice())
    }

    /// The views that it draws.
    pub fn views(&self) -> impl Iterator<Item = View> {
        self.painters.iter().map(Painter::view)
    }

    /// The twin of the running episode, to be looked at.
    pub fn twin(&self) -> Option<&Twin> {
        self.episode.as_ref().map(|episode| &episode.twin)
    }

    /// The start of the running episode.
    pub fn start(&self) -> Option<&Prepared> {
        self.episode.as_ref().map(|episode| episode.start.as_ref())
    }
}

/// Whether the task ends with the part out of the hand.
fn laid(aim: &Aim) -> bool {
    matches!(aim, Aim::Laid { .. })
}

/// The reason why an episode ended, for a person.
fn words(error: &RobotError) -> String {
    error.to_string()
}
