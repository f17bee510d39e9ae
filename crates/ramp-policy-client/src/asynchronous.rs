//! A policy whose robot goes on while the server computes: the last chunk plays on, and the robot holds still
//! after its end.
//!
//! A thread carries the messages and notes when an answer came. From a question to its answer, the robot's
//! time follows the clock: the robot does not run ahead of it, and an answer counts once as much robot time
//! has passed as the server took, however fast the physics are.

use std::net::Shutdown;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::{self, Scope};
use std::time::{Duration, Instant};

use crate::chunk::Chunk;
use crate::connection::{Connection, Heard};
use crate::error::PolicyError;
use crate::motion::{Finish, Player};
use crate::observation::observe;
use crate::rollout::{Rollout, Stopped, deadline, understand};
use crate::wire;

/// Lets the policy drive the robot, which waits for the first answer alone. `overlapped` grows by the time,
/// s, for which the robot, ahead of the clock, waited for it.
pub(crate) fn run(
    mut rollout: Rollout,
    player: &mut Player,
    overlapped: &mut f64,
) -> Result<Finish, Stopped> {
    let first = rollout.infer(player.robot)?;
    let stream = rollout.connection.stream().map_err(|error| PolicyError::Broken(error.to_string()))?;
    thread::scope(|scope| {
        let Rollout { metadata, connection, patience, told } = rollout;
        let mut courier = Courier::start(scope, connection);
        let go_on = || {
            let mut chunk = first;
            let mut next = 0;
            loop {
                while next < chunk.actions.len().min(metadata.horizon) {
                    if let Some(finish) = player.play(&chunk.actions[next])? {
                        return Ok(finish);
                    }
                    next += 1;
                }
                if chunk.done {
                    return Ok(Finish::Said);
                }
                let observed = player.time();
                let seen = match observe(player.robot, metadata, &told) {
                    // The arm stopped while it waited for an image.
                    Err(error) if error.is_recovered() => {
                        player.begin_anew();
                        continue;
                    }
                    seen => seen?,
                };
                let asked = player.time();
                courier.ask(wire::to_bytes(&seen), deadline(patience));
                let heard = loop {
                    let finish = match chunk.actions.get(next) {
                        Some(action) => player.play(action)?,
                        None => match chunk.actions.last() {
                            Some(last) => player.play(&player.rest(last))?,
                            None => None,
                        },
                    };
                    if let Some(finish) = finish {
                        return Ok(finish);
                    }
                    next += 1;
                    let passed = Duration::from_secs_f64((player.time() - asked).max(0.0));
                    if let Some(heard) = courier.answer(passed, overlapped)? {
                        break heard;
                    }
                };
                chunk = understand(heard, metadata)?;
                next = already_past(&chunk, (player.time() - observed) * metadata.rate);
            }
        };
        let outcome = go_on();
        // Ends a thread that is still waiting for the server.
        let _ = stream.shutdown(Shutdown::Both);
        outcome
    })
}

/// The first action of a chunk that is not over `passed` actions after its observation; the last one, if all
/// are.
fn already_past(chunk: &Chunk, passed: f64) -> usize {
    ((passed + 1e-6) as usize).min(chunk.actions.len().saturating_sub(1))
}

/// A message, and until when it has to be answered.
type Question = (Vec<u8>, Instant);

/// An answer, and when it came.
type Answer = (Result<Heard, PolicyError>, Instant);

/// A thread that carries messages to a server and back.
struct Courier {
    questions: Sender<Question>,
    answers: Receiver<Answer>,
    asked: Instant,
    /// The answer that came and does not yet count, and the time that the server took.
    early: Option<(Result<Heard, PolicyError>, Duration)>,
}

impl Courier {
    fn start<'scope>(scope: &'scope Scope<'scope, '_>, mut connection: Connection) -> Courier {
        let (questions, asked) = channel::<Question>();
        let (told, answers) = channel::<Answer>();
        scope.spawn(move || {
            for (bytes, end) in asked {
                let heard = connection.send(bytes, end).and_then(|()| connection.hear(end));
                if told.send((heard, Instant::now())).is_err() {
                    break;
                }
            }
            connection.close();
        });
        Courier { questions, answers, asked: Instant::now(), early: None }
    }

    fn ask(&mut self, bytes: Vec<u8>, end: Instant) {
        self.asked = Instant::now();
        // A thread that has ended is noticed where its answer is missing.
        let _ = self.questions.send((bytes, end));
    }

    /// The answer, if the server took no longer than the robot's time since the question, `passed`. Waits as
    /// long as the robot is ahead of the clock, and adds that time to `waited`, s.
    fn answer(&mut self, passed: Duration, waited: &mut f64) -> Result<Option<Heard>, PolicyError> {
        if self.early.is_none() {
            let begin = Instant::now();
            let left = (self.asked + passed).saturating_duration_since(begin);
            let heard = self.answers.recv_timeout(left);
            *waited += begin.elapsed().as_secs_f64();
            self.early = match heard {
                Ok((heard, when)) => Some((heard, when.saturating_duration_since(self.asked))),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return Err(PolicyError::Gone),
            };
        }
        match self.early.take_if(|(_, took)| *took <= passed) {
            Some((heard, _)) => heard.map(Some),
            None => Ok(None),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chunk::Action;

    #[test]
    fn actions_of_the_past_are_left_out_but_never_all() {
        let action = Action { arm: vec![0.0; 7], closed: false };
        let chunk = Chunk { actions: vec![action; 4], done: false };
        let first = [0.0, 0.9, 1.0, 3.2, 80.0].map(|passed| already_past(&chunk, passed));
        assert_eq!(first, [0, 0, 1, 3, 3]);
    }

    #[test]
    fn an_answer_counts_once_the_robot_has_been_on_its_way_for_as_long() {
        let (questions, _) = channel();
        let (told, answers) = channel();
        let asked = Instant::now();
        let mut courier = Courier { questions, answers, asked, early: None };
        let mut waited = 0.0;
        let heard = Ok(Heard::Words("late".to_string()));
        told.send((heard, asked + Duration::from_millis(70))).unwrap();
        assert!(courier.answer(Duration::from_millis(66), &mut waited).unwrap().is_none());
        assert!(courier.answer(Duration::from_millis(133), &mut waited).unwrap().is_some());
        // Nobody answers: the robot waits for the clock, and that is not counted twice.
        assert!(courier.answer(Duration::from_millis(20), &mut waited).unwrap().is_none());
        assert!(waited <= asked.elapsed().as_secs_f64());
        drop(told);
        assert!(matches!(courier.answer(Duration::ZERO, &mut waited), Err(PolicyError::Gone)));
    }
}
