//! A policy that carries out single actions inside the baseline.

use std::sync::Arc;

use ramp_external_agent::Patience;
use ramp_gym::known::Known;
use ramp_gym::own::{Body, BodyError, Moment};
use ramp_robot::arm::ArmModel;
use ramp_robot::{Observation, Robot};
use ramp_skills::skill::ActionKind;

use crate::agent::next_session;
use crate::motion::{Bounds, Finish, Player};
use crate::observation::Told;
use crate::rollout::{Rollout, Stopped};
use crate::server::PolicyServer;

/// Robot time after which a policy that names no limit is stopped, s.
const LIMIT: f64 = 20.0;
/// Largest height over its place at which a peg is believed to be seated, m. As for the policies in Python.
const SEATED: f64 = 3.0e-4;
/// For how long it is pressed on, s, so that its head comes to rest on the plate. Likewise.
const PRESSED: f64 = 0.3;

/// A policy that carries out single actions inside the baseline.
pub struct PolicySkill {
    server: Arc<PolicyServer>,
    patience: Patience,
    arm: ArmModel,
}

impl PolicySkill {
    /// The policy of this server.
    pub fn new(server: Arc<PolicyServer>, patience: Patience, arm: ArmModel) -> PolicySkill {
        PolicySkill { server, patience, arm }
    }
}

/// Whether the hand has brought a peg to its place.
fn is_seated(kind: ActionKind, known: &Known, seen: &Observation) -> bool {
    let Some(held) = known.held.as_ref().filter(|_| kind == ActionKind::Fasten) else { return false };
    let x_wp = seen.x_wt * held.x_tp;
    x_wp.translation.z - known.x_goal.translation.z < SEATED
}

impl Body for PolicySkill {
    fn run(&self, robot: &mut dyn Robot, moment: &Moment) -> Result<(), BodyError> {
        let Moment { kind, action, known } = moment;
        let limit = self.server.metadata().time_limit.unwrap_or(LIMIT);
        let bounds = Bounds {
            closed: known.gripper,
            held: known.held.clone(),
            limit,
            settled: &|seen| is_seated(*kind, known, seen),
            for_seconds: PRESSED,
        };
        let poses = Some([known.x_wp, known.x_goal]);
        let told = Told { prompt: action.clone(), session: next_session(), poses };
        let outcome =
            Rollout::begin(&self.server, self.patience, told).map_err(Stopped::from).and_then(|rollout| {
                rollout.run(&mut Player::new(robot, &self.arm, self.server.metadata(), &bounds))
            });
        match outcome {
            Ok(Finish::Said | Finish::Settled) => Ok(()),
            Ok(Finish::OutOfTime) => {
                Err(BodyError::GaveUp(format!("the policy was not done after {limit} s")))
            }
            Err(Stopped::Robot(error)) if error.is_final() => Err(error.into()),
            Err(Stopped::Robot(error)) => Err(BodyError::GaveUp(format!("the policy has no image: {error}"))),
            Err(Stopped::Policy(error)) => Err(BodyError::GaveUp(format!("the policy server {error}"))),
        }
    }
}
