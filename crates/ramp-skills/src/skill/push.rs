//! Brings a beam that already stands in the assembly to its nominal place.

use ramp_planner::{End, Impossible};
use ramp_robot::Retry;

use super::assemble::Assemble;
use super::contract::{ActionKind, Call, Effect, Need, Skill};
use crate::cell::Workcell;
use crate::cell::alignment::far_end;
use crate::fault::{Fault, SkillError};
use crate::grasp;
use crate::parameters::Parameters;
use crate::parameters::skills::PushParameters;
use crate::primitive::grip::rehearse_grasps;
use crate::rehearsal::outline::Outline;
use crate::rehearsal::scene::Scene;

/// Grasps a beam in the assembly, and moves it to its nominal place.
///
/// A beam that a single peg holds swings by 4° to 5°: its free end must be put where the next beam expects
/// it, since a cap that meets a tip beside its opening jams whatever is done to it afterwards.
#[derive(Clone)]
pub struct Push {
    parameters: PushParameters,
    assemble: Assemble,
}

impl Skill for Push {
    fn name(&self) -> &str {
        "push"
    }

    fn serves(&self) -> &[ActionKind] {
        &[ActionKind::Push]
    }

    fn needs(&self) -> &[Need] {
        &[Need::HandRaised, Need::HandEmpty, Need::BeamStands]
    }

    fn parameters(&self) -> &[&'static str] {
        &["push", "alignment"]
    }

    fn expects(&self) -> &[Effect] {
        &[Effect::BeamAligned, Effect::HandEmpty]
    }

    fn rehearse(&self, scene: &Scene, call: &Call) -> Outline {
        let (Some(part), Ok(beam)) = (call.part(), call.beam(scene.assembly)) else {
            return Outline::nothing();
        };
        let far = far_end(scene.assembly, scene.now.pinned.iter().copied(), beam);
        rehearse_grasps(scene, part, scene.standing_grasps(part, call.link(), far))
    }

    fn blame(&self, call: &Call) -> Option<Impossible> {
        call.cannot_grasp(End::Place)
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let beam = call.beam(cell.assembly)?;
        let link = call.link().ok_or_else(|| call.no_skill())?;
        self.push(cell, beam, link)
    }
}

impl Push {
    /// With these numbers.
    pub fn new(parameters: &Parameters) -> Push {
        Push { parameters: parameters.push.clone(), assemble: Assemble::new(parameters) }
    }

    /// Aligns a standing beam, holding it by `link`, and lets go.
    ///
    /// # Errors
    /// [`Fault::OffPlace`] if it does not stay in place, or what stopped the motion.
    fn push(&self, cell: &mut Workcell, beam: usize, link: &str) -> Result<(), SkillError> {
        let placed = &cell.assembly.beams[beam];
        let name = placed.beam.name.clone();
        let Some(link) = placed.beam.links.iter().find(|candidate| candidate.name == link) else {
            return Err(Fault::NoGrasp { part: name }.into());
        };
        let far = cell.belief.far_end(beam);
        let mut before = f64::INFINITY;
        for attempt in 0..self.parameters.tries {
            cell.see_ends(beam)?;
            if attempt == 0 {
                cell.diagnose_standing();
            }
            let (goal, off) = cell.belief.straightened(beam)?;
            let near_off = cell.belief.near_off(beam, &cell.belief.parts.pose(&name)?, &goal);
            if off < cell.parameters.alignment.good && near_off < cell.parameters.alignment.peggable {
                return Ok(());
            }
            let worst = off.max(near_off);
            if worst < self.parameters.near {
                return Ok(());
            }
            // A sleeve that was dragged far along its beam comes back bit by bit.
            let no_nearer = worst > self.parameters.no_nearer * before;
            if no_nearer && before - worst < self.parameters.gained {
                // Friction takes it back each time, and the next part tolerates this much; or the beam is
                // caught on something.
                if worst < cell.parameters.alignment.peggable {
                    return Ok(());
                }
                break;
            }
            before = worst;
            if attempt > 0 {
                let off = if off < cell.parameters.alignment.good { near_off } else { off };
                cell.record(Retry::new("push", &name).attempt(attempt + 1).off(off));
            }
            let s = grasp::point_on(link, far, &cell.parameters.grip);
            if cell.belief.anchor(beam).is_none() && cell.belief.short(beam)? > self.parameters.short_of {
                self.assemble.reinsert(cell, beam, s)?;
                continue;
            }
            cell.grasp_standing(beam, s)?;
            // It stands on the table and in its joint: the hand does not carry it.
            if let Some(held) = &mut cell.hand.held {
                held.mass = 0.0;
            }
            cell.hand.zero()?;
            for motion in 0..self.parameters.motions {
                cell.glance()?;
                let x_wb = cell.belief.parts.pose(&name)?;
                let there = cell.belief.off(beam, &x_wb, &goal) < 0.5 * cell.parameters.alignment.good;
                if motion > 1
                    && there
                    && cell.belief.near_off(beam, &x_wb, &goal) < cell.parameters.alignment.peggable
                {
                    break;
                }
                let target = cell.hand.corrected(&x_wb, &goal);
                cell.hand.drive(&target, self.parameters.speed, |hand| {
                    hand.force().norm() > self.parameters.limit
                })?;
                cell.hand.settle()?;
            }
            cell.settle(beam)?;
            cell.release()?;
            cell.belief.drag(beam, (self.parameters.dragged, self.parameters.dragged_turn));
        }
        cell.see_ends(beam)?;
        let (_, off) = cell.belief.straightened(beam)?;
        // The next part, a peg or the chamfers of a cap, tolerates this much.
        if off < cell.parameters.alignment.peggable {
            return Ok(());
        }
        Err(Fault::OffPlace { part: name, offset: off }.into())
    }
}
