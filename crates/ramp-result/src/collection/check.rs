//! Consistency checks of an episode's result, before anything else uses it.

use ramp_kit::source::shorten;

use crate::episode::{EpisodeResult, PartResult, RejectReason, RejectedPeg, RobotTime, TAKE_APART};
use crate::words::{self, MOST_PARTS, MOST_PEGS};

/// The longest time that an episode can have, s: more than any protocol asks for, and what a picture can
/// show.
const LONGEST: f64 = 1e7;
/// Tolerance between times that should agree, s: rounding by the tool that wrote them.
const SLACK: f64 = 1e-3;
/// The largest depth of two parts in each other that is believed, m: more than a part is long.
const DEEPEST_TOLD: f64 = 10.0;

/// Checks that an episode can have ended like this.
pub(super) fn check(result: &EpisodeResult) -> Result<(), String> {
    words(result)?;
    if result.real.is_some() != result.physics.is_none() {
        return Err("a run of a real robot has no physics of the twin, and every other has one".to_string());
    }
    let time = &result.time;
    let parts = [
        ("time.planning", time.planning),
        ("time.compute", time.compute),
        ("time.robot", time.robot),
        ("time.total", time.total),
    ];
    let compared = result.robot_time.iter().flat_map(|RobotTime { bound, reference }| {
        [("robot_time.bound", *bound), ("robot_time.reference", *reference)]
    });
    let processor = time.agent_cpu.map(|cpu| ("time.agent_cpu", cpu));
    for (name, value) in parts.into_iter().chain(processor).chain(compared) {
        if !(0.0..=LONGEST).contains(&value) {
            return Err(format!("`{name}` is {value} s, expected 0 to {LONGEST}"));
        }
    }
    if let Some(share) = time.waiting.filter(|share| !(0.0..=1.0).contains(share)) {
        return Err(format!("`time.waiting` is {share}, expected 0 to 1"));
    }
    let sum = time.planning + time.compute + time.robot;
    if (sum - time.total).abs() > SLACK {
        return Err(format!(
            "`time.total` is {} s, and planning, compute and robot time are {sum} s together",
            time.total
        ));
    }
    let counted: Vec<_> = result.pegs.iter().flatten().collect();
    for rejected in &result.rejected {
        if counted.iter().any(|peg| peg.connection == rejected.connection) {
            let name = shorten(&rejected.connection);
            return Err(format!("the peg of {name} counts and is rejected"));
        }
        if let RejectReason::Penetration { depth, .. } = rejected.reason
            && !(0.0..=DEEPEST_TOLD).contains(&depth)
        {
            return Err(format!("a penetration is {depth} m deep, expected 0 to {DEEPEST_TOLD}"));
        }
    }
    for (index, peg) in counted.iter().enumerate() {
        let name = shorten(&peg.connection);
        if !(0.0..=time.robot + SLACK).contains(&peg.t_robot) {
            return Err(format!(
                "{name} is pinned since {} s of robot time, and all of it is {} s",
                peg.t_robot, time.robot
            ));
        }
        if !(peg.t_robot - SLACK..=time.total + SLACK).contains(&peg.t_total) {
            return Err(format!(
                "{name} is pinned since {} s in total, which is not between its robot time, {} s, and the end, {} s",
                peg.t_total, peg.t_robot, time.total
            ));
        }
        for other in &counted[..index] {
            if other.connection == peg.connection {
                return Err(format!("{name} counts twice"));
            }
            // The scorer of a real run may not have noted the peg.
            if other.peg == peg.peg && !peg.peg.is_empty() {
                return Err(format!("the peg {} counts twice", shorten(&peg.peg)));
            }
        }
    }
    back(result)?;
    if (result.share() - result.completion).abs() > 1e-9 {
        return Err(format!(
            "`completion` is {}, and {} of {} {} count",
            result.completion,
            result.counted(),
            result.wanted(),
            if result.parts.is_empty() { "pegs" } else { "parts" },
        ));
    }
    words::events(&result.events, LONGEST)
}

/// Checks the parts of a frame that was to be taken apart.
fn back(result: &EpisodeResult) -> Result<(), String> {
    let EpisodeResult { task, pegs, parts, time, .. } = result;
    match task.as_deref() {
        None if parts.is_empty() => return Ok(()),
        Some(TAKE_APART) if pegs.is_empty() && !parts.is_empty() => {}
        _ => return Err(format!("`task` is not `{TAKE_APART}` with `parts` and without `pegs`")),
    }
    for (index, PartResult { part, t_robot, t_total }) in parts.iter().enumerate() {
        let name = shorten(part);
        if parts[..index].iter().any(|other| other.part == *part) {
            return Err(format!("the part {name} is listed twice"));
        }
        let fits = match (t_robot, t_total) {
            (None, None) => true,
            (Some(robot), Some(total)) => {
                (0.0..=time.robot + SLACK).contains(robot)
                    && (robot - SLACK..=time.total + SLACK).contains(total)
            }
            _ => false,
        };
        if !fits {
            return Err(format!(
                "{name} is back since {t_robot:?} s of robot time and {t_total:?} s in total"
            ));
        }
    }
    Ok(())
}

/// Checks every text that is shown to a person or becomes part of a file name.
fn words(result: &EpisodeResult) -> Result<(), String> {
    let EpisodeResult { goal, class, track, real, agent, software, host, pegs, fault, ended, log, .. } =
        result;
    words::name("the goal", goal)?;
    words::class_and_track(class.as_deref(), track)?;
    words::agent(agent)?;
    result.arm.as_ref().map_or(Ok(()), |arm| words::name("the arm", arm))?;
    result.world.as_ref().map_or(Ok(()), words::world)?;
    result.start.as_ref().map_or(Ok(()), words::start)?;
    result.state.as_ref().map_or(Ok(()), words::state)?;
    words::software(software)?;
    words::host(host)?;
    if let Some(real) = real {
        words::title("the robot", &real.robot)?;
        words::title("the scorer", &real.scorer)?;
        words::title("the source", &real.source)?;
    }
    words::few("pegs", pegs, MOST_PEGS)?;
    for peg in pegs.iter().flatten() {
        words::name("a connection", &peg.connection)?;
        for joint in &peg.joints {
            words::name("a joint", joint)?;
        }
        // The scorer of a real run may not have noted the peg.
        if !peg.peg.is_empty() {
            words::name("a peg", &peg.peg)?;
        }
    }
    words::few("parts", &result.parts, MOST_PARTS)?;
    result.parts.iter().try_for_each(|it| words::name("a part", &it.part))?;
    words::few("rejected pegs", &result.rejected, MOST_PEGS)?;
    for RejectedPeg { connection, peg, reason } in &result.rejected {
        words::name("the connection of a rejected peg", connection)?;
        words::name("a rejected peg", peg)?;
        if let RejectReason::Penetration { parts, .. } = reason {
            parts.iter().try_for_each(|part| words::name("a part of a penetration", part))?;
        }
    }
    if let Some(physics) = &result.physics {
        words::hash("the state of the physics", &physics.state, 16)?;
    }
    if let Some(fault) = fault {
        words::name("the kind of the fault", &fault.kind)?;
        fault.part.as_ref().map_or(Ok(()), |part| words::name("the part of the fault", part))?;
        words::sentence("the text of the fault", &fault.text)?;
    }
    words::sentence("why it ended", &ended.reason)?;
    log.as_ref().map_or(Ok(()), |log| words::hash("the hash of the log", log, 64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collection::LARGEST;
    use ramp_robot::{Action, Argument, Event, EventKind, MOST_EVENT, MOST_EVENTS};

    use crate::testing::episode;

    #[test]
    fn the_longest_result_that_an_agent_can_make_is_read_and_a_longer_one_is_not() {
        // As many events as an agent may report, each as long as it may be: one long text, or many short
        // ones, in letters of four bytes.
        let long = EventKind::Note { text: "\u{1f980}".repeat(MOST_EVENT - 25) };
        let mut short = Action::new("a");
        for index in 'a'..='h' {
            let many = vec![Argument::Text("\u{1f980}".to_string()); 4];
            short.arguments.insert(index.to_string(), Argument::List(many));
        }
        let short = EventKind::ActionBegun(short);
        for kind in [long, short] {
            assert_eq!(kind.check(MOST_EVENT), Ok(()));
            let mut result = episode("easy-1", 1, &[20.0], 3);
            result.events = vec![Event::new(1.0, kind); MOST_EVENTS];
            assert_eq!(check(&result), Ok(()));
            assert!(result.to_json().len() < LARGEST, "{}", result.to_json().len());
        }
        let event = Event::new(1.0, EventKind::Clipped {});
        let mut result = episode("easy-1", 1, &[20.0], 3);
        result.events = vec![event; MOST_EVENTS + 1];
        assert!(check(&result).is_err_and(|why| why.contains("10001 events, expected at most 10000")));
    }

    #[test]
    fn hashes_are_hashes() {
        let mut result = episode("easy-1", 1, &[20.0], 3);
        result.log = Some("=1+1".into());
        assert!(check(&result).is_err_and(|why| why.contains("the hash of the log is `=1+1`")));
    }
}
