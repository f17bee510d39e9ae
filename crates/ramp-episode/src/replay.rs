//! An episode again, from its log alone: the same world from the seed, the same commands, the same referee, and a
//! comparison of every bit that the log tells.

use std::path::Path;

use ramp_assembly::{Assembly, GoalError};
use ramp_kit::{Kit, KitError};
use ramp_robot::arm::{ArmError, ArmModel};
use ramp_robot::{Robot, RobotError, Track};
use ramp_twin::{Disturbance, Fault, Setup, Twin, TwinError};

use crate::judged::{Judged, Watcher};
use ramp_log::calls::{CallsError, Entry};
use ramp_log::{Header, Log};
use ramp_result::episode::completion;
use ramp_result::episode::{EpisodeResult, RULES};

/// The most entries in a row that let no robot time pass: more than any agent has use for.
const MOST_IDLE: u32 = 1_000_000;
/// The largest disturbance of the start that is believed, m or rad.
const LARGEST_DISTURBANCE: f64 = 0.1;

/// What came out of running an episode again.
#[derive(Clone, Debug)]
pub struct Replayed {
    /// The log's result with what the replay found in place of what the log says of it: pegs, completion, robot time
    /// and physics.
    pub result: EpisodeResult,
    /// What differs; empty when all is equal.
    pub differences: Vec<Difference>,
}

impl Replayed {
    /// Whether the replay found what the log says, to the last bit.
    pub fn is_equal(&self) -> bool {
        self.differences.is_empty()
    }
}

/// Something that differs between a log and its replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Robot time at which it was found, s.
    pub time: f64,
    /// What it is.
    pub what: String,
    /// What the log says.
    pub logged: String,
    /// What the replay found.
    pub replayed: String,
}

/// Why a log cannot be replayed.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// Its calls are no calls.
    #[error("the log's calls cannot be read")]
    Calls(#[from] CallsError),
    /// Its kit is no kit.
    #[error("the log's kit cannot be read")]
    Kit(#[from] KitError),
    /// Its goal is no goal.
    #[error("the log's goal cannot be read")]
    Goal(#[from] Box<GoalError>),
    /// Its arm is no arm.
    #[error("the log's arm cannot be read")]
    Arm(#[from] ArmError),
    /// No world can be made from it.
    #[error("no world can be made from the log")]
    Twin(#[from] TwinError),
    /// It was judged by other rules.
    #[error("the log is of the rules `{found}`, and this program judges by `{RULES}`")]
    Rules {
        /// What it says.
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
    /// The header holds what cannot be.
    #[error("the log holds what cannot be as its {what}: {found}")]
    Impossible {
        /// What.
        what: &'static str,
        /// What was found.
        found: String,
    },
}

/// The files of a log, read.
pub struct World {
    /// The parts.
    pub kit: Kit,
    /// The goal.
    pub assembly: Assembly,
    /// The arm.
    pub arm: ArmModel,
    track: Track,
    seed: u64,
    disturbance: Disturbance,
    fault: Option<Fault>,
}

impl World {
    /// What a log's episode was made from.
    ///
    /// # Errors
    /// When the log holds something that no episode can be made from, or contradicts itself.
    pub fn of(log: &Log) -> Result<World, ReplayError> {
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
        let track = Track::ALL
            .into_iter()
            .find(|track| track.name() == header.track)
            .ok_or_else(|| ReplayError::Impossible { what: "track", found: short(&header.track) })?;
        let disturbance =
            Disturbance { position: header.disturbance.position, angle: header.disturbance.angle };
        for value in [disturbance.position, disturbance.angle] {
            if !(0.0..=LARGEST_DISTURBANCE).contains(&value) {
                return Err(ReplayError::Impossible { what: "disturbance", found: value.to_string() });
            }
        }
        let fault = match &header.fault {
            Some(fault) => Some(
                fault.parse().map_err(|_| ReplayError::Impossible { what: "fault", found: short(fault) })?,
            ),
            None => None,
        };
        Ok(World { kit, assembly, arm, track, seed: header.seed, disturbance, fault })
    }

    /// As the twin is made from it.
    pub fn setup(&self) -> Setup<'_> {
        Setup {
            kit: &self.kit,
            assembly: &self.assembly,
            arm: &self.arm,
            track: self.track,
            seed: self.seed,
            disturbance: self.disturbance,
            fault: self.fault,
        }
    }
}

/// Runs a log's episode again and compares. It takes as long as the episode's physics and images.
///
/// The software that made the log is not compared: another version may find differences where there is no fraud.
///
/// # Errors
/// When the log holds something that no episode can be made from, or contradicts itself.
pub fn replay(log: &Log) -> Result<Replayed, ReplayError> {
    replay_watched(log, &World::of(log)?, &mut |_, _| {})
}

/// As [`replay`], with somebody who looks on.
///
/// # Errors
/// As [`replay`].
pub fn replay_watched(log: &Log, world: &World, watcher: &mut Watcher) -> Result<Replayed, ReplayError> {
    let setup = world.setup();
    let mut twin = Twin::new(&setup)?;
    let mut judged = Judged::new(&mut twin, &setup, None, watcher);
    let mut differences = Vec::new();
    let stopped = call_again(&mut judged, log, &mut differences)?;
    judged.judge();
    let mut result = log.result.clone();
    result.pegs = judged.pegs(&setup);
    result.physics = Some(judged.physics());
    result.fault = judged.fault();
    result.completion = completion(&result.pegs);
    result.time.robot = judged.twin.time();
    let end = result.time.robot;
    compare(&log.result, &result, stopped.as_ref(), end, &mut differences);
    for (peg, logged) in result.pegs.iter_mut().zip(&log.result.pegs) {
        if let (Some(peg), Some(logged)) = (peg, logged)
            && (peg.t_robot, &peg.peg) == (logged.t_robot, &logged.peg)
        {
            peg.t_total = logged.t_total;
        }
    }
    Ok(Replayed { result, differences })
}

/// Makes the log's calls; what stopped the robot for good.
fn call_again(
    judged: &mut Judged,
    log: &Log,
    differences: &mut Vec<Difference>,
) -> Result<Option<RobotError>, ReplayError> {
    let mut idle = 0;
    for entry in log.calls() {
        let time = judged.twin.time();
        let outcome = match entry? {
            Entry::Step(command, periods) => (0..periods).try_for_each(|_| judged.step(&command).map(|_| ())),
            Entry::ReadParts => judged.read_parts().map(|_| ()),
            Entry::Look(camera) => judged.look(camera).map(|_| ()),
            Entry::State(logged) => {
                let hash = judged.twin.state_hash();
                // Once it differs it goes on differing: the first time tells where.
                if hash != logged && differences.is_empty() {
                    differences.push(Difference {
                        time: judged.twin.time(),
                        what: "state of the physics".to_string(),
                        logged: format!("{logged:016x}"),
                        replayed: format!("{hash:016x}"),
                    });
                }
                Ok(())
            }
        };
        match outcome {
            Err(error) if error.is_final() => return Ok(Some(error)),
            _ => {}
        }
        idle = if judged.twin.time() > time { 0 } else { idle + 1 };
        if idle > MOST_IDLE {
            let found = format!("more than {MOST_IDLE} in a row let no robot time pass");
            return Err(ReplayError::Impossible { what: "calls", found });
        }
    }
    Ok(None)
}

fn compare(
    logged: &EpisodeResult,
    replayed: &EpisodeResult,
    stopped: Option<&RobotError>,
    time: f64,
    differences: &mut Vec<Difference>,
) {
    let mut differ = |what: String, logged: String, replayed: String| {
        if logged != replayed {
            differences.push(Difference { time, what, logged, replayed });
        }
    };
    let peg = |peg: &ramp_result::episode::PegResult| format!("{} since {} s", peg.peg, peg.t_robot);
    let pegs = |result: &EpisodeResult, index: usize| match result.pegs.get(index) {
        Some(found) => found.as_ref().map_or_else(|| "no peg".to_string(), peg),
        None => "no such connection".to_string(),
    };
    for index in 0..logged.pegs.len().max(replayed.pegs.len()) {
        let what = format!("connection {}", index + 1);
        differ(what, pegs(logged, index), pegs(replayed, index));
    }
    differ("completion".into(), logged.completion.to_string(), replayed.completion.to_string());
    differ("robot time".into(), logged.time.robot.to_string(), replayed.time.robot.to_string());
    let told = |told: bool| if told { "told" } else { "missing" }.to_string();
    differ("physics".into(), told(logged.physics.is_some()), told(replayed.physics.is_some()));
    if let (Some(logged), Some(replayed)) = (&logged.physics, &replayed.physics) {
        differ(
            "deepest penetration".into(),
            logged.deepest_penetration.to_string(),
            replayed.deepest_penetration.to_string(),
        );
        differ("largest force".into(), logged.largest_force.to_string(), replayed.largest_force.to_string());
        differ("final state of the physics".into(), logged.state.clone(), replayed.state.clone());
    }
    let fault = |result: &EpisodeResult| match &result.fault {
        Some(fault) => format!("{fault:?}"),
        None => "none".to_string(),
    };
    differ("fault".into(), fault(logged), fault(replayed));
    if let Some(error) = stopped {
        differ("reason of the end".into(), logged.ended.reason.clone(), error.to_string());
    }
}

/// What the start of the log and its result must both say.
fn check_agreement(header: &Header, result: &EpisodeResult) -> Result<(), ReplayError> {
    // In the header with its occasion, if one was asked for.
    let kind = |fault: Option<&str>| match fault {
        Some(fault) => fault.split('@').next().unwrap_or_default().to_string(),
        None => "none".to_string(),
    };
    let pairs = [
        ("rules", header.rules.clone(), result.rules.clone()),
        ("goal", header.goal.name.clone(), result.goal.clone()),
        ("track", header.track.clone(), result.track.clone()),
        ("seed", header.seed.to_string(), result.seed.to_string()),
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
