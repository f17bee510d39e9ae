//! The result of an episode: one JSON file, of the schema in `data/schema/episode.schema.json`.

use std::collections::BTreeMap;

use ramp_robot::Event;
use ramp_world::{Spread, World};
use serde::{Deserialize, Serialize};

use crate::older;
use crate::sha256;
pub use crate::start::{StartInfo, StateInfo};

/// The version of the schema these files follow.
pub const SCHEMA: &str = "ramp-episode-5";

/// The versions before, which are read, too: without arm and start, and one with events that are a kind and a
/// text.
const OLDER_SCHEMAS: [&str; 2] = ["ramp-episode-3", "ramp-episode-4"];

/// Version of the rules by which episodes are judged (`docs/src/reference/rules.md`).
pub const RULES: &str = "ramp-rules-9";

/// Everything recorded about one episode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EpisodeResult {
    /// [`SCHEMA`].
    pub schema: String,
    /// [`RULES`].
    pub rules: String,
    /// The goal's name.
    pub goal: String,
    /// Its class, if it has one.
    pub class: Option<String>,
    /// The track: the agent's sensors.
    pub track: String,
    /// The robot and the scorer of a run of a real robot; `None` in the twin.
    pub real: Option<RealRun>,
    /// The name of the arm; `None` of a real run that does not tell it, and then not in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arm: Option<String>,
    /// The world of the physics; `None` of a real run, and then not in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world: Option<WorldInfo>,
    /// The start of the parts; `None` of a real run, and then not in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<StartInfo>,
    /// The state in which the frame began; `None` if nothing was built, and then not in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<StateInfo>,
    /// The task ([`TAKE_APART`]); `None` if it was to build the frame, and then not in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub task: Option<String>,
    /// All randomness of the world came from here; with a secret, from both together; of a real run, the
    /// repeat.
    pub seed: u64,
    /// The commitment of the secret that was mixed into the seed; `None` without one, and then not in the
    /// file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub secret: Option<String>,
    /// Number of this run in a row of repeats, from 1.
    pub repeat: u32,
    /// The agent.
    pub agent: AgentInfo,
    /// The program that made this file.
    pub software: Software,
    /// The machine.
    pub host: Host,
    /// Pegs counted / pegs in the goal; where the frame was to be taken apart, parts back / parts.
    pub completion: f64,
    /// For each connection of the goal, in its order: the peg that counts, or null. Empty where the frame was
    /// to be taken apart.
    pub pegs: Vec<Option<PegResult>>,
    /// Where the frame was to be taken apart: each of its parts that is not clamped. Empty otherwise, and
    /// then not in the file.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<PartResult>,
    /// Pegs that were in their place at the end and do not count; empty without one, and then not in the
    /// file.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rejected: Vec<RejectedPeg>,
    /// Planning, compute and robot time.
    pub time: Time,
    /// Times to compare robot time with; `None` of a real run, where the baseline has no plan for the
    /// goal, and in files of earlier versions. Then it is not in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot_time: Option<RobotTime>,
    /// The agent's plan.
    pub plan: PlanInfo,
    /// The events, in order.
    pub events: Vec<Event>,
    /// Figures of the physics that a reader may want to check; `None` for a real run.
    pub physics: Option<Physics>,
    /// The injected fault; `None` without one, and then not in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fault: Option<FaultInfo>,
    /// Reason of the end.
    pub ended: Ended,
    /// SHA-256 of the episode's log, in hex; `None` without a log.
    pub log: Option<String>,
}

/// The world of an episode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorldInfo {
    /// Its name.
    pub name: String,
    /// SHA-256 of its file, in hex.
    pub sha256: String,
    /// The numbers that the episode drew, of those that differ between episodes: by group and quantity, such
    /// as `friction.coulomb`.
    pub draw: BTreeMap<String, Vec<f64>>,
}

impl WorldInfo {
    /// The world of an episode with this seed.
    pub fn of(world: &World, seed: u64) -> WorldInfo {
        let drawn = world.quantities().zip(world.numbers(seed));
        let drawn = drawn.filter(|((_, _, quantity), _)| quantity.spread != Spread::Fixed);
        let draw = drawn.map(|(_, (group, field, numbers))| (format!("{group}.{field}"), numbers)).collect();
        WorldInfo { name: world.name.clone(), sha256: sha256(world.text.as_bytes()), draw }
    }

    /// Whether it is a shipped world, and not another one of the same name.
    pub fn is_shipped(&self) -> bool {
        World::shipped(&self.name).is_some_and(|world| sha256(world.text.as_bytes()) == self.sha256)
    }

    /// A label that no other world has: its name, and for one that is not the program's the begin of its
    /// hash.
    pub fn title(&self) -> String {
        if self.is_shipped() {
            return self.name.clone();
        }
        let hash: String = self.sha256.chars().take(8).collect();
        format!("{} ({hash})", self.name)
    }
}

/// The label of a world in results.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorldLabel {
    /// SHA-256 of its file, in hex.
    pub sha256: String,
    /// As [`WorldInfo::title`].
    pub title: String,
}

impl WorldLabel {
    /// Of a world.
    pub fn of(world: &World) -> WorldLabel {
        let sha256 = sha256(world.text.as_bytes());
        let info = WorldInfo { name: world.name.clone(), sha256, draw: BTreeMap::new() };
        WorldLabel { title: info.title(), sha256: info.sha256 }
    }
}

/// Name and version of an agent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AgentInfo {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// SHA-256 of its file, in hex. For the baseline that of a file of parameters of its skills; `None` with
    /// its own ones, which the software's commit tells.
    pub sha256: Option<String>,
    /// Whether the robot went on while it computed: such a result is no function of its seed. In the file
    /// only if it did.
    #[serde(default, rename = "async", skip_serializing_if = "std::ops::Not::not")]
    pub asynchronous: bool,
}

/// A run of a real robot, in the words of its scorer.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct RealRun {
    /// The robot.
    pub robot: String,
    /// The person with the stopwatch.
    pub scorer: String,
    /// The place or publication.
    pub source: String,
    /// Its kind.
    #[serde(default)]
    pub kind: RobotKind,
}

/// The kind of robot in a run outside of the twin. It says which clock a run had.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RobotKind {
    /// An arm. Its time is that of the wall.
    #[default]
    Arm,
    /// The twin behind the protocol of an arm, in real time: while the agent thinks, its time goes on.
    ServedTwin,
    /// The same, waiting for each command: while the agent thinks, its time stands still.
    ServedTwinInLockStep,
}

impl RobotKind {
    /// For a person.
    pub fn words(self) -> &'static str {
        match self {
            RobotKind::Arm => "real robot",
            RobotKind::ServedTwin => "served twin in real time",
            RobotKind::ServedTwinInLockStep => "served twin in lock-step",
        }
    }
}

/// Version and commit of this software.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Software {
    /// The version.
    pub version: String,
    /// The commit it was built from, followed by `-dirty` if the sources were modified, or
    /// `unknown`.
    pub commit: String,
}

/// The machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Host {
    /// The processor's name as the system gives it, or `unknown`.
    pub cpu: String,
    /// Number of hardware threads.
    pub cores: usize,
}

impl Host {
    /// This machine.
    pub fn here() -> Host {
        let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let cpu = text
            .lines()
            .find_map(|line| line.strip_prefix("model name")?.split_once(':').map(|(_, name)| name.trim()))
            .unwrap_or("unknown");
        Host {
            cpu: cpu.to_string(),
            cores: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
        }
    }
}

/// A peg that counts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PegResult {
    /// The connection's name in the goal.
    pub connection: String,
    /// Its two joints, female first.
    pub joints: [String; 2],
    /// The peg.
    pub peg: String,
    /// Robot time since which it has been seated, s.
    pub t_robot: f64,
    /// The same plus the agent's planning and compute up to then, s.
    pub t_total: f64,
}

/// [`EpisodeResult::task`] where the frame was to be taken apart.
pub const TAKE_APART: &str = "take-apart";

/// A part of a frame that was to be taken apart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartResult {
    /// Its name.
    pub part: String,
    /// Robot time since which it is back in its place, s; null if it is not.
    pub t_robot: Option<f64>,
    /// The same plus the agent's planning and compute up to then, s.
    pub t_total: Option<f64>,
}

/// A peg that was in its place at the end and does not count.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RejectedPeg {
    /// The connection's name in the goal.
    pub connection: String,
    /// The peg.
    pub peg: String,
    /// The reason.
    #[serde(flatten)]
    pub reason: RejectReason,
}

/// Reason why a peg in its place does not count.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "reason", rename_all = "kebab-case")]
pub enum RejectReason {
    /// It did not stay in its place when the arm was gone.
    Fell {},
    /// Two parts of its connection were too deep in each other.
    Penetration {
        /// The names of the two parts.
        parts: [String; 2],
        /// Depth, m.
        depth: f64,
    },
}

impl std::fmt::Display for RejectedPeg {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{} in {}: ", self.peg, self.connection)?;
        match &self.reason {
            RejectReason::Fell {} => f.write_str("not in its place once the arm is gone"),
            RejectReason::Penetration { parts: [one, other], depth } => {
                write!(f, "{one} and {other} were {:.1} mm in each other", depth * 1e3)
            }
        }
    }
}

/// Times of an episode, s, each counted separately.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Time {
    /// Task planning, by the agent's clock.
    pub planning: f64,
    /// The rest of the agent's compute, while the robot waited.
    pub compute: f64,
    /// The robot's own time.
    pub robot: f64,
    /// The sum of the three.
    pub total: f64,
    /// Processor time of all processes of an agent that is a program of its own, until they ended. `None`
    /// for other agents, and in files of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub agent_cpu: Option<f64>,
    /// Share of its time, ready to work, for which the program waited for a processor, 0 to 1. `None` where
    /// the system does not tell, and in files of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub waiting: Option<f64>,
}

/// Share of waiting ([`Time::waiting`]) above which the machine counts as loaded: computing times are then
/// longer than on an idle machine. On an idle machine with two processors the share is below 0.01.
pub const LOADED: f64 = 0.1;

impl Time {
    /// Whether the machine was loaded while the times were taken.
    pub fn is_loaded(&self) -> bool {
        self.waiting.is_some_and(|share| share > LOADED)
    }
}

/// Times to compare robot time with: of the baseline's plan for the goal, from the start, by the model
/// of the arm. It is the same for every agent, track, world and seed, and says nothing of the plan that the
/// agent carried out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RobotTime {
    /// Lower bound, s: no arm with these limits visits all grasps and goal poses of that plan in
    /// less time.
    pub bound: f64,
    /// Duration of that plan with motions at the arm's limits, without looks, searches, waits and tries, s.
    /// It is no bound.
    pub reference: f64,
}

/// Size of the agent's plan.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanInfo {
    /// Coarse actions of the first plan.
    pub coarse: usize,
    /// Fine actions of the first plan.
    pub fine: usize,
    /// Number of replans.
    pub replans: usize,
}

/// Figures of the physics.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Physics {
    /// Deepest penetration between two parts in any step, m.
    pub deepest_penetration: f64,
    /// Largest force between the hand and what it touched or held, N: at the wrist, filtered with 20 ms.
    pub largest_force: f64,
    /// Number of stops by reflex or for the speed of a joint after which the arm was ready again; 0 is not in
    /// the file.
    #[serde(default, skip_serializing_if = "is_none_at_all")]
    pub stops: usize,
    /// Hash of the final physics state: equal hashes mean equal states, bit by bit.
    pub state: String,
}

/// serde's rule for a count that is left out.
fn is_none_at_all(count: &usize) -> bool {
    *count == 0
}

/// An injected fault. The agent does not know of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FaultInfo {
    /// The name of its kind.
    pub kind: String,
    /// The occasion of this kind at which it was to strike, or struck, from 1.
    pub occasion: u32,
    /// Robot time at which it struck, s; `None` if the occasion did not occur.
    pub at: Option<f64>,
    /// The part that it struck, where it strikes a part.
    pub part: Option<String>,
    /// Its size, in the unit given in the text; `None` where it has no size.
    pub size: Option<f64>,
    /// For a person.
    pub text: String,
}

/// Reason of an episode's end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ended {
    /// `done` when the agent said so, otherwise the cause.
    pub reason: String,
    /// Origin of the cause; `None` of a real run and in files of earlier versions, and then not in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<EndKind>,
}

/// Origin of an episode's end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EndKind {
    /// The agent said that it is done.
    Done,
    /// The agent crashed, was silent for too long, or sent something invalid.
    Agent,
    /// The robot stopped for good because of a command or a collision.
    Robot,
    /// The limit of robot time.
    Time,
    /// The limit of time on the wall: a technical failure.
    Wall,
    /// The physics diverged: a technical failure.
    Simulation,
}

impl EndKind {
    /// Whether it is a technical failure, and not one of the agent.
    pub fn is_technical(self) -> bool {
        matches!(self, EndKind::Wall | EndKind::Simulation)
    }
}

impl EpisodeResult {
    /// From JSON of [`SCHEMA`] or of one of the two versions before, which it converts.
    ///
    /// # Errors
    /// When it is not JSON, or not a result. The field `schema` is not checked.
    pub fn from_json(bytes: &[u8]) -> Result<EpisodeResult, serde_json::Error> {
        older::read(bytes, OLDER_SCHEMAS, SCHEMA)
    }

    /// Whether results of this schema can be read.
    pub fn reads(schema: &str) -> bool {
        schema == SCHEMA || OLDER_SCHEMAS.contains(&schema)
    }

    /// As JSON, ending in a line break.
    pub fn to_json(&self) -> String {
        // Plain structs of numbers and strings always serialise.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// SHA-256, in hex, of everything in the result but the hash of its log: two results with the same digest
    /// are equal, to the last bit.
    pub fn digest(&self) -> String {
        sha256(EpisodeResult { log: None, ..self.clone() }.to_json().as_bytes())
    }

    /// The same result with everything that a clock on the wall decided set to zero, and without the hash of
    /// the log, in which clocks are kept: what two runs with one seed must share to the last bit.
    #[must_use]
    pub fn without_clock(&self) -> EpisodeResult {
        let mut result = self.clone();
        result.time.planning = 0.0;
        result.time.compute = 0.0;
        result.time.total = result.time.robot;
        result.time.agent_cpu = None;
        result.time.waiting = None;
        for peg in result.pegs.iter_mut().flatten() {
            peg.t_total = peg.t_robot;
        }
        result.log = None;
        result
    }

    /// Whether a technical failure ended it.
    pub fn is_technical(&self) -> bool {
        self.ended.kind.is_some_and(EndKind::is_technical)
    }

    /// Counted pegs, or parts that are back.
    pub fn counted(&self) -> usize {
        let back = self.parts.iter().filter(|part| part.t_robot.is_some()).count();
        self.pegs.iter().flatten().count() + back
    }

    /// Pegs of the goal, or parts that are to be back.
    pub fn wanted(&self) -> usize {
        self.pegs.len() + self.parts.len()
    }

    /// The share of [`EpisodeResult::counted`] in [`EpisodeResult::wanted`].
    pub fn share(&self) -> f64 {
        if self.wanted() == 0 { 0.0 } else { self.counted() as f64 / self.wanted() as f64 }
    }

    /// The counted things, for a person: pegs, or parts that are back.
    pub fn unit(&self) -> &'static str {
        if self.parts.is_empty() { "pegs" } else { "parts back" }
    }
}

/// Pegs counted / pegs in the goal.
pub fn completion(pegs: &[Option<PegResult>]) -> f64 {
    if pegs.is_empty() { 0.0 } else { pegs.iter().flatten().count() as f64 / pegs.len() as f64 }
}
