//! A run over the wire: an agent drives a robot behind guards, and what is measured is logged and judged.
//!
//! Data passes one way: the agent's commands go through the [`Guard`], which keeps them in the workspace
//! and stops the arm when a person asks for it, and on to the robot. The [`Recorder`] logs what comes
//! back, and at the end the poses of the parts that were measured. [`poses`](crate::poses) judges the
//! log, as it judges any other.

mod guard;
mod images;
mod recorder;
mod run;

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use ramp_log::LogError;
use ramp_result::EpisodeResult;
use ramp_result::episode::{EndKind, Host, PlanInfo};
use ramp_robot::{Account, Agent, Event, EventKind, MOST_EVENTS, Robot, RobotError};
use ramp_skills::survey;

pub use guard::{Guard, Workspace};
pub use recorder::{Recorder, RunHead};
pub use run::Run;

use crate::poses::{QuaternionOrder, Reader};

/// A run that was judged.
#[derive(Debug)]
pub struct Driven {
    /// Its result; it names the log.
    pub result: EpisodeResult,
    /// The error that stopped the robot, if any did.
    pub stopped: Option<RobotError>,
    /// Why the frame was not measured at the end, if the robot had not stopped before.
    pub unmeasured: Option<RobotError>,
}

/// Reasons for which a run has no result.
#[derive(Debug, thiserror::Error)]
pub enum DriveError {
    /// The log cannot be written, or says what cannot be.
    #[error(transparent)]
    Log(#[from] LogError),
}

/// Lets the agent drive the robot until it is done, something stops it, or `stop` gives a reason. Measures
/// what stands, leaves the log at `path`, and judges it.
///
/// # Errors
/// When the log cannot be written, or cannot be judged.
pub fn drive(
    run: &Run,
    robot: &mut dyn Robot,
    agent: &mut dyn Agent,
    stop: &dyn Fn() -> Option<String>,
    path: &Path,
) -> Result<Driven, DriveError> {
    let mut recorder = Recorder::create(path, robot, run)?;
    let mut guard = Guard::new(&mut recorder, [run.arm, run.told], run.workspace, stop);
    let outcome = agent.run(&mut guard);
    agent.finish();
    guard.robot.end();
    let Account { coarse, fine, replans, mut events, .. } = agent.account();
    events.truncate(MOST_EVENTS - 1);
    let (stopped, mut unmeasured) = (outcome.err(), None);
    if let Some(error) = &stopped {
        let what = EventKind::Stopped { why: error.to_string() };
        events.push(Event::new(guard.robot.robot_time(), what));
    }
    let (ended, kind) = match (agent.failure(), &stopped) {
        (Some(failure), _) => (failure, EndKind::Agent),
        (None, Some(error)) => (error.to_string(), EndKind::Robot),
        (None, None) => ("done".to_string(), EndKind::Done),
    };
    // A robot that stopped measures nothing any more: what was measured before counts.
    if stopped.is_none() {
        let begin = Instant::now();
        // It begins where the agent left the arm, which may be off what it commanded last.
        guard.smooths = true;
        let seen = survey(run.assembly, run.told, run.track, &mut guard, u64::from(run.repeat));
        let seen = seen.unwrap_or_else(|error| {
            unmeasured = Some(error);
            BTreeMap::new()
        });
        guard.robot.surveyed(seen, begin.elapsed());
    }
    let (name, version) = agent.name();
    let host = Host::here();
    let head = RunHead { run, agent: name, version, ended: &ended, host: &host };
    let bytes = recorder.finish(&head, &events)?;
    let goals = std::slice::from_ref(run.assembly);
    let order = QuaternionOrder::default();
    let reader = Reader { kit: &run.assembly.kit, goals, software: run.software, order, unmeasured: true };
    let mut result = reader.from_bytes(path, &bytes)?.result;
    result.plan = PlanInfo { coarse, fine, replans };
    result.events = events;
    result.ended.kind = Some(kind);
    result.agent.sha256 = agent.file_hash().map(str::to_string);
    Ok(Driven { result, stopped, unmeasured })
}
