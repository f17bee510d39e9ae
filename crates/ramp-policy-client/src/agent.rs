//! A policy that builds a whole goal.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use ramp_assembly::Assembly;
use ramp_external_agent::Patience;
use ramp_robot::arm::ArmModel;
use ramp_robot::{Account, Agent, GripperCommand, Robot, RobotError};

use crate::asynchronous;
use crate::error::PolicyError;
use crate::motion::{Bounds, Finish, Player};
use crate::observation::Told;
use crate::rollout::{Rollout, Stopped};
use crate::server::PolicyServer;

/// Force of each finger that closes, N: as the baseline has it (`grip.force`).
const CLOSING_FORCE: f64 = 60.0;
/// For how long every peg has to count until the policy is stopped, s.
const SETTLED: f64 = 1.0;

/// Tells whether every peg of the goal counts now.
pub type IsComplete<'a> = Box<dyn Fn() -> bool + 'a>;

/// A policy that builds a whole goal.
pub struct PolicyAgent<'a> {
    server: &'a PolicyServer,
    patience: Patience,
    arm: &'a ArmModel,
    prompt: String,
    is_complete: IsComplete<'a>,
    asynchronous: bool,
    overlapped: f64,
    failure: Option<String>,
    late: bool,
}

impl<'a> PolicyAgent<'a> {
    /// A policy for a goal. `is_complete` stands for the person who stops a policy that has done its work and
    /// does not know it: the policy is stopped once all pegs have counted for a second.
    pub fn new(
        server: &'a PolicyServer,
        patience: Patience,
        assembly: &Assembly,
        arm: &'a ArmModel,
        is_complete: IsComplete<'a>,
    ) -> PolicyAgent<'a> {
        PolicyAgent {
            server,
            patience,
            arm,
            prompt: sentence(assembly),
            is_complete,
            asynchronous: false,
            overlapped: 0.0,
            failure: None,
            late: false,
        }
    }

    /// Lets the robot go on while the server computes: the last chunk plays on.
    #[must_use]
    pub fn asynchronous(self, asynchronous: bool) -> PolicyAgent<'a> {
        PolicyAgent { asynchronous, ..self }
    }
}

/// A goal as a sentence.
fn sentence(assembly: &Assembly) -> String {
    let beams: Vec<&str> = assembly.beams.iter().map(|placed| placed.beam.name.as_str()).collect();
    let (name, pegs) = (&assembly.name, assembly.connections.len());
    format!("assemble the beams {} into the frame {name} and fasten it with {pegs} pegs", beams.join(", "))
}

/// A name for the next episode of this process.
pub(crate) fn next_session() -> String {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    format!("{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed))
}

impl Agent for PolicyAgent<'_> {
    fn name(&self) -> (&str, &str) {
        (&self.server.metadata().name, &self.server.metadata().version)
    }

    fn account(&self) -> Account {
        Account { overlapped: self.overlapped, ..Account::default() }
    }

    fn is_asynchronous(&self) -> bool {
        self.asynchronous
    }

    fn file_hash(&self) -> Option<&str> {
        Some(&self.server.metadata().sha256)
    }

    fn failure(&self) -> Option<String> {
        self.failure.clone()
    }

    fn is_late(&self) -> bool {
        self.late
    }

    fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError> {
        let limit = self.server.metadata().time_limit.unwrap_or(f64::INFINITY);
        let bounds = Bounds {
            closed: GripperCommand { width: 0.0, force: CLOSING_FORCE },
            held: None,
            limit,
            settled: &|_| (self.is_complete)(),
            for_seconds: SETTLED,
        };
        let told = Told { prompt: self.prompt.clone(), session: next_session(), poses: None };
        let mut overlapped = 0.0;
        let outcome =
            Rollout::begin(self.server, self.patience, told).map_err(Stopped::from).and_then(|rollout| {
                let mut player = Player::new(robot, self.arm, self.server.metadata(), &bounds);
                match self.asynchronous {
                    true => asynchronous::run(rollout, &mut player, &mut overlapped),
                    false => rollout.run(&mut player),
                }
            });
        drop(bounds);
        self.overlapped = overlapped;
        match outcome {
            Ok(Finish::Said | Finish::Settled) => Ok(()),
            Ok(Finish::OutOfTime) => {
                self.failure = Some(format!("the policy was not done after {limit} s, its `time_limit`"));
                Ok(())
            }
            Err(Stopped::Robot(error)) if error.is_final() => Err(error),
            Err(Stopped::Robot(error)) => {
                self.failure = Some(format!("the policy has no image: {error}"));
                Ok(())
            }
            Err(Stopped::Policy(error)) => {
                let over = self.patience.end.is_some_and(|end| Instant::now() >= end);
                self.late = over && error == PolicyError::Silent;
                self.failure = Some(format!("the policy server {error}"));
                Ok(())
            }
        }
    }
}
