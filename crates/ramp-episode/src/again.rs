//! The calls of a log, made once more: each must be answered as it was, and the physics must be the same ten
//! times a second.

use std::iter::Peekable;

use ramp_log::calls::{CallsError, Decoder, Entry};
use ramp_log::write::{STATE_EVERY, periods};
use ramp_robot::{Robot, RobotError};

use crate::answer;
use crate::conduct::Conduct;
use crate::difference::Difference;
use crate::judged::Judged;

/// The most entries in a row that let no robot time pass: more than any agent has use for.
const MOST_IDLE: u32 = 1_000_000;

/// Reasons for which calls cannot be repeated.
#[derive(Debug, thiserror::Error)]
pub(crate) enum AgainError {
    #[error(transparent)]
    Calls(#[from] CallsError),
    #[error("more than {MOST_IDLE} calls in a row without robot time")]
    Idle,
}

/// The result of the calls.
pub(crate) struct Again {
    /// The agent's requests.
    pub(crate) conduct: Conduct,
    /// The fatal error of the robot.
    pub(crate) stopped: Option<RobotError>,
    /// The first answer or state that differs: once one does, all that follow do.
    pub(crate) difference: Option<Difference>,
    /// Control periods at the last look at the state.
    period: u64,
}

/// Makes the calls of a log.
///
/// # Errors
/// If the calls are invalid, or never let time pass.
pub(crate) fn call_again(judged: &mut Judged, calls: Decoder) -> Result<Again, AgainError> {
    let mut again = Again { conduct: Conduct::default(), stopped: None, difference: None, period: 0 };
    let mut entries = calls.peekable();
    let mut idle = 0;
    let mut ended = false;
    while let Some(entry) = entries.next() {
        let time = judged.twin.time();
        let outcome = match entry? {
            Entry::Step(command, periods) => {
                let mut outcome = Ok(());
                for left in (0..periods).rev() {
                    outcome = match judged.step(&command) {
                        // The agent was told, and went on.
                        Err(error) if !error.is_final() => Ok(()),
                        other => other.map(|_| ()),
                    };
                    if outcome.is_ok() && left == 0 {
                        again.state(judged, &mut entries);
                    } else if outcome.is_ok() && again.is_due(judged) {
                        again.differ(judged, "state of the physics", "missing".into(), "due".into());
                    }
                    if outcome.is_err() {
                        if left > 0 {
                            again.goes_on(judged);
                        }
                        break;
                    }
                }
                outcome
            }
            Entry::ReadParts => {
                let parts = judged.read_parts();
                again.conduct.read(judged.twin.time(), &parts);
                again.answer(judged, &mut entries, parts.map(|parts| answer::of_readings(&parts)))
            }
            Entry::Look(camera, width) => {
                let image = judged.look_sized(camera, width);
                again.conduct.looked(judged.twin.time(), &image);
                again.answer(judged, &mut entries, image.map(|image| answer::of_image(&image)))
            }
            Entry::Expose => {
                let opened = judged.expose();
                again.conduct.exposed(judged.twin.time(), &opened);
                match opened {
                    Ok(()) => Ok(()),
                    Err(error) => again.answer(judged, &mut entries, Err(error)),
                }
            }
            Entry::State(logged) if entries.peek().is_none() => {
                ended = true;
                again.compare_state(judged, logged);
                Ok(())
            }
            Entry::State(_) => {
                again.differ(judged, "state of the physics", "present".into(), "not due".into());
                Ok(())
            }
            Entry::Answered(_) | Entry::Refused => {
                again.differ(judged, "answer to the agent", "present".into(), "no request".into());
                Ok(())
            }
        };
        if let Err(error) = outcome {
            again.stopped = Some(error);
            ended = matches!(entries.next(), Some(Ok(Entry::State(_))));
            if entries.next().is_some() {
                again.goes_on(judged);
            }
            break;
        }
        idle = if judged.twin.time() > time { 0 } else { idle + 1 };
        if idle > MOST_IDLE {
            return Err(AgainError::Idle);
        }
    }
    if !ended {
        again.differ(judged, "final state of the physics", "missing".into(), "due".into());
    }
    Ok(again)
}

impl Again {
    /// Notes what differs, if it is the first.
    fn differ(&mut self, judged: &Judged, what: &str, logged: String, replayed: String) {
        self.difference.get_or_insert_with(|| Difference {
            time: judged.twin.time(),
            what: what.to_string(),
            logged,
            replayed,
        });
    }

    /// The log has more calls than the robot would have taken.
    fn goes_on(&mut self, judged: &Judged) {
        self.differ(judged, "end of the calls", "more calls".into(), "the robot has stopped".into());
    }

    /// True if a log has the hash of the state at this point.
    fn is_due(&mut self, judged: &Judged) -> bool {
        let period = periods(judged.twin.time());
        let due = period / STATE_EVERY > self.period / STATE_EVERY;
        self.period = period;
        due
    }

    /// The hash of the state, where one is due.
    fn state(&mut self, judged: &Judged, entries: &mut Peekable<Decoder>) {
        if self.is_due(judged) {
            match entries.next_if(|entry| matches!(entry, Ok(Entry::State(_)))) {
                Some(Ok(Entry::State(logged))) => self.compare_state(judged, logged),
                _ => self.differ(judged, "state of the physics", "missing".into(), "due".into()),
            }
        }
    }

    fn compare_state(&mut self, judged: &Judged, logged: u64) {
        let hash = judged.twin.state_hash();
        if hash != logged {
            self.differ(judged, "state of the physics", format!("{logged:016x}"), format!("{hash:016x}"));
        }
    }

    /// The answer to a request must be the one in the log.
    fn answer(
        &mut self,
        judged: &Judged,
        entries: &mut Peekable<Decoder>,
        given: Result<u64, RobotError>,
    ) -> Result<(), RobotError> {
        let replayed = match given {
            Ok(hash) => Entry::Answered(hash),
            Err(error) if error.is_final() => return Err(error),
            Err(_) => Entry::Refused,
        };
        let is_answer =
            |entry: &Result<Entry, CallsError>| matches!(entry, Ok(Entry::Answered(_) | Entry::Refused));
        let logged = entries.next_if(is_answer).and_then(Result::ok);
        if logged.as_ref() != Some(&replayed) {
            self.differ(judged, "answer to the agent", say(logged.as_ref()), say(Some(&replayed)));
        }
        self.state(judged, entries);
        Ok(())
    }
}

/// An answer in words.
fn say(answer: Option<&Entry>) -> String {
    match answer {
        Some(Entry::Answered(hash)) => format!("{hash:016x}"),
        Some(Entry::Refused) => "refused".to_string(),
        _ => "missing".to_string(),
    }
}
