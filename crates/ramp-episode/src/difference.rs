//! Differences between an episode and its replay.

use ramp_result::EpisodeResult;
use ramp_result::episode::{EndKind, PegResult};
use ramp_robot::RobotError;

use crate::episode::kind_of;

/// Something that differs between a log and its replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Robot time at which it was found, s.
    pub time: f64,
    /// The quantity that differs.
    pub what: String,
    /// The value in the log.
    pub logged: String,
    /// The value in the replay.
    pub replayed: String,
}

/// Everything in which the result of a log and that of its replay differ. `stopped` is what stopped the robot
/// for good, `time` the end in robot time, s.
pub(crate) fn compare(
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
    let peg = |peg: &PegResult| {
        let [first, second] = &peg.joints;
        format!("{} at {} ({first}, {second}) since {} s", peg.peg, peg.connection, peg.t_robot)
    };
    let pegs = |result: &EpisodeResult, index: usize| match result.pegs.get(index) {
        Some(found) => found.as_ref().map_or_else(|| "no peg".to_string(), peg),
        None => "no such connection".to_string(),
    };
    for index in 0..logged.pegs.len().max(replayed.pegs.len()) {
        let what = format!("connection {}", index + 1);
        differ(what, pegs(logged, index), pegs(replayed, index));
    }
    let back = |result: &EpisodeResult| -> Vec<_> {
        result.parts.iter().map(|it| (it.part.clone(), it.t_robot.map(|time| time.to_string()))).collect()
    };
    differ("parts back".into(), format!("{:?}", back(logged)), format!("{:?}", back(replayed)));
    let rejected = |result: &EpisodeResult| format!("{:?}", result.rejected);
    differ("rejected pegs".into(), rejected(logged), rejected(replayed));
    differ("completion".into(), logged.completion.to_string(), replayed.completion.to_string());
    differ("robot time".into(), logged.time.robot.to_string(), replayed.time.robot.to_string());
    let told = |told: bool| if told { "present" } else { "missing" }.to_string();
    differ("physics".into(), told(logged.physics.is_some()), told(replayed.physics.is_some()));
    if let (Some(logged), Some(replayed)) = (&logged.physics, &replayed.physics) {
        differ(
            "deepest penetration".into(),
            logged.deepest_penetration.to_string(),
            replayed.deepest_penetration.to_string(),
        );
        differ("largest force".into(), logged.largest_force.to_string(), replayed.largest_force.to_string());
        differ("stops of the arm".into(), logged.stops.to_string(), replayed.stops.to_string());
        differ("final state of the physics".into(), logged.state.clone(), replayed.state.clone());
    }
    let fault = |result: &EpisodeResult| match &result.fault {
        Some(fault) => format!("{fault:?}"),
        None => "none".to_string(),
    };
    differ("fault".into(), fault(logged), fault(replayed));
    if let Some(error) = stopped {
        differ("reason of the end".into(), logged.ended.reason.clone(), error.to_string());
        let kind = |kind: Option<EndKind>| format!("{kind:?}");
        differ("kind of the end".into(), kind(logged.ended.kind), kind(Some(kind_of(error))));
    } else if logged.ended.kind.is_some_and(|kind| kind == EndKind::Simulation) {
        differ("kind of the end".into(), "Simulation".into(), "no fault of the simulation".into());
    }
}
