//! Puts a part back where it was picked up.

use nalgebra::Translation3;

use super::contract::{ActionKind, Call, Effect, Skill};
use crate::Pose;
use crate::cell::Workcell;
use crate::fault::SkillError;
use crate::parameters::Parameters;
use crate::parameters::skills::PutDownParameters;
use crate::rehearsal::outline::Outline;
use crate::rehearsal::scene::Scene;

/// Puts the held part back where it was picked up, and lets go of it.
#[derive(Clone)]
pub struct PutDown {
    parameters: PutDownParameters,
}

impl Skill for PutDown {
    fn name(&self) -> &str {
        "put_down"
    }

    fn serves(&self) -> &[ActionKind] {
        &[ActionKind::PutDown]
    }

    fn parameters(&self) -> &[&'static str] {
        &["put_down", "peg_search"]
    }

    fn expects(&self) -> &[Effect] {
        &[Effect::HandEmpty]
    }

    /// The place is the one from which the part was taken: the arm that reached it then can reach it again.
    fn rehearse(&self, _: &Scene, _: &Call) -> Outline {
        Outline::nothing()
    }

    fn run(&self, cell: &mut Workcell, _: &Call) -> Result<(), SkillError> {
        self.put_back(cell)
    }
}

impl PutDown {
    /// With these numbers.
    pub fn new(parameters: &Parameters) -> PutDown {
        PutDown { parameters: parameters.put_down.clone() }
    }

    /// Puts the held part back where it was picked up, or at its place on the sheet if it comes from the
    /// assembly, and lets go of it.
    ///
    /// # Errors
    /// [`Fault::NotHeld`](crate::Fault::NotHeld) if the hand is empty, or the fault that stopped the motion.
    fn put_back(&self, cell: &mut Workcell) -> Result<(), SkillError> {
        let Some(part) = cell.hand.held.as_ref().map(|held| held.part.clone()) else { return Ok(()) };
        let is_beam = cell.kit.beam(&part).is_some();
        cell.retreat()?;
        cell.check_grip(&part)?;
        let Some(mut held) = cell.hand.held.clone() else { return Ok(()) };
        // A peg's stem is above its holder, a beam above the table.
        let mut down =
            cell.carry_above(held.x_wp_back * held.x_tp.inverse(), |down| down + self.parameters.above)?;
        if is_beam {
            // By its own weight it has turned a little between the fingers: it is put down level.
            cell.check_grip(&part)?;
            held = cell.hand.held.clone().unwrap_or(held);
            down = held.x_wp_back * held.x_tp.inverse();
        }
        cell.hand.relax();
        cell.hand.zero()?;
        let speed = if is_beam { self.parameters.beam_speed } else { self.parameters.speed };
        let lower = |cell: &mut Workcell, down: &Pose| {
            cell.hand.drive(down, speed, |hand| -hand.force().z > self.parameters.limit)
        };
        if is_beam {
            let mut near = down;
            near.translation.z += self.parameters.near;
            cell.hand
                .drive(&near, self.parameters.down_speed, |hand| -hand.force().z > self.parameters.limit)?;
        }
        lower(cell, &down)?;
        // The head of a peg rests on its holder, so that is as high as the head's underside.
        let holder = held.x_wp_back.translation.z;
        if !is_beam && !cell.is_in(holder) {
            let here = cell.hand.seen.x_wt.translation.vector;
            cell.spiral(holder, &here, self.parameters.search_time, None)?;
            let here =
                Translation3::from(cell.hand.seen.x_wt.translation.vector.xy().push(down.translation.z));
            lower(cell, &Pose::from_parts(here, down.rotation))?;
        }
        cell.release()
    }
}
