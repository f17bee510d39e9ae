//! A policy at work: observation, chunk of actions, motion, and again, until it is done.

use std::time::Instant;

use ramp_external_agent::Patience;
use ramp_robot::{Robot, RobotError};

use crate::chunk::{self, Chunk};
use crate::connection::{Connection, Heard};
use crate::error::PolicyError;
use crate::metadata::Metadata;
use crate::motion::{Finish, Player};
use crate::observation::{Told, observe};
use crate::server::PolicyServer;
use crate::wire;

/// The reason why it was stopped before.
#[derive(Debug)]
pub(crate) enum Stopped {
    /// The robot stopped it.
    Robot(RobotError),
    /// Its server could not go on.
    Policy(PolicyError),
}

impl From<RobotError> for Stopped {
    fn from(error: RobotError) -> Stopped {
        Stopped::Robot(error)
    }
}

impl From<PolicyError> for Stopped {
    fn from(error: PolicyError) -> Stopped {
        Stopped::Policy(error)
    }
}

/// A policy at work.
pub(crate) struct Rollout<'a> {
    pub(crate) metadata: &'a Metadata,
    pub(crate) connection: Connection,
    pub(crate) patience: Patience,
    pub(crate) told: Told,
}

impl<'a> Rollout<'a> {
    /// Connects, and tells the server that an episode begins.
    pub(crate) fn begin(
        server: &'a PolicyServer,
        patience: Patience,
        told: Told,
    ) -> Result<Rollout<'a>, PolicyError> {
        let connection = server.connect(deadline(patience))?;
        let mut rollout = Rollout { metadata: server.metadata(), connection, patience, told };
        if rollout.metadata.endpoints {
            let mut reset = vec![("endpoint", "reset".into())];
            if rollout.metadata.session {
                reset.push(("session_id", rollout.told.session.as_str().into()));
            }
            // Whatever it answers: it has heard.
            rollout.ask(&wire::map(reset))?;
        }
        Ok(rollout)
    }

    fn ask(&mut self, value: &rmpv::Value) -> Result<Heard, PolicyError> {
        let end = deadline(self.patience);
        self.connection.send(wire::to_bytes(value), end)?;
        self.connection.hear(end)
    }

    /// The actions for what is seen now.
    pub(crate) fn infer(&mut self, robot: &mut dyn Robot) -> Result<Chunk, Stopped> {
        let seen = observe(robot, self.metadata, &self.told)?;
        Ok(understand(self.ask(&seen)?, self.metadata)?)
    }

    /// Lets the policy drive the robot, which waits for each answer.
    pub(crate) fn run(mut self, player: &mut Player) -> Result<Finish, Stopped> {
        let outcome = self.chunks(player);
        self.connection.close();
        outcome
    }

    fn chunks(&mut self, player: &mut Player) -> Result<Finish, Stopped> {
        loop {
            let Chunk { actions, done } = match self.infer(player.robot) {
                // The arm stopped while it waited for an image.
                Err(Stopped::Robot(error)) if error.is_recovered() => {
                    player.begin_anew();
                    continue;
                }
                chunk => chunk?,
            };
            for action in actions.iter().take(self.metadata.horizon) {
                if let Some(finish) = player.play(action)? {
                    return Ok(finish);
                }
            }
            if done {
                return Ok(Finish::Said);
            }
        }
    }
}

/// The chunk in what was heard.
pub(crate) fn understand(heard: Heard, metadata: &Metadata) -> Result<Chunk, PolicyError> {
    match heard {
        Heard::Words(words) => Err(PolicyError::Failed(words)),
        Heard::Bytes(bytes) => chunk::read(&bytes, metadata).map_err(PolicyError::Wrong),
    }
}

/// When the next answer has to be there.
pub(crate) fn deadline(patience: Patience) -> Instant {
    let answer = Instant::now() + patience.answer;
    patience.end.map_or(answer, |end| end.min(answer))
}
