//! Pulls a peg out of its connection.

use ramp_planner::Impossible;
use ramp_robot::Retry;

use super::contract::{ActionKind, Call, Effect, Need, Skill};
use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::parameters::Parameters;
use crate::parameters::skills::PullOutParameters;
use crate::primitive::grip::rehearse_grasps;
use crate::rehearsal::outline::Outline;
use crate::rehearsal::scene::Scene;

/// Grasps a seated peg by its head, and pulls it up out of both holes.
#[derive(Clone)]
pub struct PullOut {
    parameters: PullOutParameters,
}

impl Skill for PullOut {
    fn name(&self) -> &str {
        "pull_out"
    }

    fn serves(&self) -> &[ActionKind] {
        &[ActionKind::PullOut]
    }

    fn needs(&self) -> &[Need] {
        &[Need::HandRaised, Need::HandEmpty]
    }

    fn parameters(&self) -> &[&'static str] {
        &["pull_out"]
    }

    fn expects(&self) -> &[Effect] {
        &[Effect::PegOut, Effect::HoldsPart]
    }

    fn rehearse(&self, scene: &Scene, call: &Call) -> Outline {
        let Some(part) = call.part() else { return Outline::nothing() };
        rehearse_grasps(scene, part, scene.grasps(part, None))
    }

    fn blame(&self, call: &Call) -> Option<Impossible> {
        let connection = call.action.connection()?.to_string();
        Some(Impossible::Fasten { connection })
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let peg = call.part().ok_or_else(|| call.no_skill())?;
        let mut last = None;
        for attempt in 0..self.parameters.tries {
            if attempt > 0 {
                cell.record(Retry::new("pull_out", peg).attempt(attempt + 1));
                cell.retreat()?;
            }
            match self.pull(cell, peg) {
                Err(SkillError::Fault(fault @ Fault::NotHeld { .. })) => last = Some(fault),
                Err(error) => return Err(error),
                Ok(()) => {
                    let connection = call.connection(cell.assembly)?;
                    let connection = &cell.assembly.connections[connection];
                    for joint in [connection.female, connection.male] {
                        let (beam, _) = cell.belief.hole(joint);
                        cell.belief.parts.bumped(&beam, (self.parameters.bump, self.parameters.bump_turn));
                    }
                    return Ok(());
                }
            }
        }
        Err(last.unwrap_or_else(|| call.no_skill()).into())
    }
}

impl PullOut {
    /// With these numbers.
    pub fn new(parameters: &Parameters) -> PullOut {
        PullOut { parameters: parameters.pull_out.clone() }
    }

    /// One try.
    fn pull(&self, cell: &mut Workcell, peg: &str) -> Result<(), SkillError> {
        cell.see_to_grip(peg)?;
        let grasp = cell.choose_grasp(peg, None)?;
        cell.grasp(peg, &grasp)?;
        let mut up = cell.hand.setpoint;
        up.translation.z += self.parameters.height;
        cell.hand.go(&up, self.parameters.speed)?;
        cell.check_grip(peg)?;
        cell.return_to_sheet(peg);
        Ok(())
    }
}
