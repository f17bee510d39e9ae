//! An episode again, from its log alone: the same world from the seed, the same commands, the same referee,
//! and a comparison of every bit in the log.

use std::path::Path;

use ramp_assembly::{Assembly, GoalError, Task};
use ramp_kit::KitError;
use ramp_kit::source::SourceFile;
use ramp_robot::Track;
use ramp_robot::arm::{ArmError, ArmModel};
use ramp_twin::{Fault, GivenState, Setup, StateFault, Twin, TwinError};
use ramp_world::{Start, WorldFault};

use crate::again::{AgainError, call_again};
use crate::conduct::Breach;
use crate::difference::{Difference, compare};
use crate::judged::{Judged, Watcher};
use ramp_log::calls::CallsError;
use ramp_log::{Header, Log};
use ramp_result::episode::{EpisodeResult, RULES, WorldInfo};

/// The result of a replay.
#[derive(Clone, Debug)]
pub struct Replayed {
    /// The log's result with what the replay found in place of what the log says of it: pegs, completion,
    /// robot time and physics.
    pub result: EpisodeResult,
    /// The differences; empty when all is equal.
    pub differences: Vec<Difference>,
    /// The agent's violations of its track. An episode with a breach counts on no leaderboard.
    pub breach: Option<Breach>,
}

impl Replayed {
    /// True if the replay matches the log to the last bit.
    pub fn is_equal(&self) -> bool {
        self.differences.is_empty()
    }
}

/// Reasons for which a log cannot be replayed.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// Its calls are invalid.
    #[error("the log's calls cannot be read")]
    Calls(#[from] CallsError),
    /// Its kit is invalid.
    #[error("the log's kit cannot be read")]
    Kit(#[from] KitError),
    /// Its goal is invalid.
    #[error("the log's goal cannot be read")]
    Goal(#[from] Box<GoalError>),
    /// Its arm is invalid.
    #[error("the log's arm cannot be read")]
    Arm(#[from] ArmError),
    /// Its world or its start is invalid.
    #[error("the log's world or its start cannot be read")]
    World(#[from] WorldFault),
    /// Its state is invalid.
    #[error("the log's state cannot be read")]
    State(#[from] StateFault),
    /// No twin can be made from it.
    #[error("no twin can be made from the log")]
    Twin(#[from] TwinError),
    /// It was judged by other rules.
    #[error("the log uses rules `{found}`, but this program judges by `{RULES}`")]
    Rules {
        /// The value in the log.
        found: String,
    },
    /// Its parts do not fit each other.
    #[error("the log contradicts itself: its {what} is {header} at its start and {result} in its result")]
    Contradiction {
        /// Of what.
        what: &'static str,
        /// In the header.
        header: String,
        /// In the result, or in the goal file.
        result: String,
    },
    /// Its result names other numbers than its world and seed give.
    #[error(
        "the log contradicts itself: the numbers in its result are not those that its world and seed give"
    )]
    Draw,
    /// A frame is to be taken apart that is not built at the start.
    #[error(
        "the log contradicts itself: a frame is to be taken apart, and its state is not that of the built frame"
    )]
    Unbuilt,
    /// The header has an invalid value.
    #[error("invalid {what} in the log: {found}")]
    Impossible {
        /// The item.
        what: &'static str,
        /// The value found.
        found: String,
    },
}

/// The files of a log, read.
pub struct LoggedSetup {
    /// The goal.
    pub assembly: Assembly,
    /// The arm.
    pub arm: ArmModel,
    /// The world.
    pub world: ramp_world::World,
    track: Track,
    seed: u64,
    start: Start,
    state: Option<GivenState>,
    task: Task,
    fault: Option<Fault>,
}

impl LoggedSetup {
    /// The inputs of a logged episode.
    ///
    /// # Errors
    /// When the log holds something that no episode can be made from, or contradicts itself.
    pub fn of(log: &Log) -> Result<LoggedSetup, ReplayError> {
        let header = &log.header;
        if header.rules != RULES {
            return Err(ReplayError::Rules { found: short(&header.rules) });
        }
        check_agreement(header, &log.result)?;
        let kit = ramp_kit::read_kit_str("kit.xml", &header.kit.xml)?;
        let name = &header.goal.name;
        let assembly =
            ramp_assembly::read_goal_str(&format!("{name}.xml"), &header.goal.xml, &kit).map_err(Box::new)?;
        if assembly.name != *name {
            return Err(contradiction("goal", name, &assembly.name));
        }
        let arm = ArmModel::from_json(Path::new("arm.json"), &header.arm.json)?;
        let world = SourceFile::new("world.toml", &header.world.toml);
        let world = ramp_world::World::from_source(&world)?;
        if world.name != header.world.name {
            return Err(contradiction("world", &header.world.name, &world.name));
        }
        let track = Track::ALL
            .into_iter()
            .find(|track| track.name() == header.track)
            .ok_or_else(|| ReplayError::Impossible { what: "track", found: short(&header.track) })?;
        let start = Start::from_source(&SourceFile::new("start.toml", &header.start.toml))?;
        if start.name != header.start.name {
            return Err(contradiction("start", &header.start.name, &start.name));
        }
        let state = header.state.as_ref().map(|state| SourceFile::new("state.json", &state.json));
        let state = state.map(|file| GivenState::from_source(&file, &assembly)).transpose()?;
        let fault = match &header.fault {
            Some(fault) => Some(
                fault.parse().map_err(|_| ReplayError::Impossible { what: "fault", found: short(fault) })?,
            ),
            None => None,
        };
        let seed = header.secret.as_ref().map_or(header.seed, |secret| secret.seed);
        if log.result.world != Some(WorldInfo::of(&world, seed)) {
            return Err(ReplayError::Draw);
        }
        let task = header.task.as_deref().unwrap_or(Task::Build.name());
        let task =
            Task::named(task).ok_or_else(|| ReplayError::Impossible { what: "task", found: short(task) })?;
        if task == Task::TakeApart {
            let built = GivenState::built(&assembly)?;
            if state.as_ref().is_none_or(|state| state.text != built.text) {
                return Err(ReplayError::Unbuilt);
            }
        }
        Ok(LoggedSetup { assembly, arm, world, track, seed, start, state, task, fault })
    }

    /// As the twin is made from it.
    pub fn setup(&self) -> Setup<'_> {
        Setup {
            assembly: &self.assembly,
            arm: &self.arm,
            track: self.track,
            seed: self.seed,
            start: &self.start,
            state: self.state.as_ref(),
            task: self.task,
            world: &self.world,
            fault: self.fault,
        }
    }
}

/// Runs a log's episode again and compares. It takes as long as the episode's physics and images.
///
/// The software that made the log is not compared: another version may find differences without fraud.
///
/// # Errors
/// When the log holds something that no episode can be made from, or contradicts itself.
pub fn replay(log: &Log) -> Result<Replayed, ReplayError> {
    replay_watched(log, &LoggedSetup::of(log)?, &mut |_, _| {})
}

/// As [`replay`], with an observer.
///
/// # Errors
/// As [`replay`].
pub fn replay_watched(
    log: &Log,
    world: &LoggedSetup,
    watcher: &mut Watcher,
) -> Result<Replayed, ReplayError> {
    let setup = world.setup();
    let mut twin = Twin::new(&setup)?;
    let mut judged = Judged::new(&mut twin, &setup, None, watcher);
    let again = call_again(&mut judged, log.calls()).map_err(|error| match error {
        AgainError::Calls(error) => ReplayError::Calls(error),
        AgainError::Idle => ReplayError::Impossible { what: "calls", found: error.to_string() },
    })?;
    let mut differences = Vec::from_iter(again.difference);
    judged.judge_end();
    let mut result = log.result.clone();
    result.pegs = judged.pegs(&setup);
    result.parts = judged.parts(&setup);
    result.rejected = judged.rejected(&setup);
    result.physics = Some(judged.physics());
    result.fault = judged.fault();
    result.completion = result.share();
    result.time.robot = judged.twin.time();
    let end = result.time.robot;
    compare(&log.result, &result, again.stopped.as_ref(), end, &mut differences);
    let breach = again.conduct.breach(world.track, first_success(&setup, &result));
    for (peg, logged) in result.pegs.iter_mut().zip(&log.result.pegs) {
        if let (Some(peg), Some(logged)) = (peg, logged)
            && (peg.t_robot, &peg.peg) == (logged.t_robot, &logged.peg)
        {
            peg.t_total = logged.t_total;
        }
    }
    for (part, logged) in result.parts.iter_mut().zip(&log.result.parts) {
        if (part.t_robot, &part.part) == (logged.t_robot, &logged.part) {
            part.t_total = logged.t_total;
        }
    }
    Ok(Replayed { result, differences, breach })
}

/// Robot time since which the first peg or part counts that the agent has brought there, s. Of pegs that may
/// have been in place when the episode began, nothing is said.
fn first_success(setup: &Setup, result: &EpisodeResult) -> Option<f64> {
    let pegs = result.pegs.iter().flatten().map(|peg| peg.t_robot).filter(|_| setup.state.is_none());
    let parts = result.parts.iter().filter_map(|part| part.t_robot);
    pegs.chain(parts).min_by(f64::total_cmp)
}

/// Fields that the start of the log and its result must share.
fn check_agreement(header: &Header, result: &EpisodeResult) -> Result<(), ReplayError> {
    // In the header with its occasion, if one was asked for.
    let kind = |fault: Option<&str>| match fault {
        Some(fault) => fault.split('@').next().unwrap_or_default().to_string(),
        None => "none".to_string(),
    };
    let world = |name: &str, sha256: &str| format!("{name} ({sha256})");
    let theirs = result.world.as_ref().map_or("none".to_string(), |it| world(&it.name, &it.sha256));
    let start = result.start.as_ref().map_or("none".to_string(), |it| world(&it.name, &it.sha256));
    let theirs_state = result.state.as_ref().map(|it| &it.sha256);
    let state = |hash: Option<&String>| hash.map_or("none", String::as_str).to_string();
    let task = |name: Option<&str>| name.unwrap_or(Task::Build.name()).to_string();
    let secret = |commitment: Option<&String>| commitment.map_or("none", String::as_str).to_string();
    let pairs = [
        ("rules", header.rules.clone(), result.rules.clone()),
        ("goal", header.goal.name.clone(), result.goal.clone()),
        ("world", world(&header.world.name, &header.world.sha256), theirs),
        ("start", world(&header.start.name, &header.start.sha256), start),
        ("state", state(header.state.as_ref().map(|it| &it.sha256)), state(theirs_state)),
        ("task", task(header.task.as_deref()), task(result.task.as_deref())),
        ("track", header.track.clone(), result.track.clone()),
        ("seed", header.seed.to_string(), result.seed.to_string()),
        ("secret", secret(header.secret.as_ref().map(|it| &it.commitment)), secret(result.secret.as_ref())),
        ("repeat", header.repeat.to_string(), result.repeat.to_string()),
        ("fault", kind(header.fault.as_deref()), kind(result.fault.as_ref().map(|it| it.kind.as_str()))),
        ("software's version", header.software.version.clone(), result.software.version.clone()),
        ("software's commit", header.software.commit.clone(), result.software.commit.clone()),
    ];
    match pairs.into_iter().find(|(_, header, result)| header != result) {
        Some((what, header, result)) => Err(contradiction(what, &header, &result)),
        None => Ok(()),
    }
}

fn contradiction(what: &'static str, header: &str, result: &str) -> ReplayError {
    ReplayError::Contradiction { what, header: short(header), result: short(result) }
}

fn short(text: &str) -> String {
    ramp_kit::source::shorten(text)
}
