//! Slides a beam that stands deeper than its place forward into the joint that now stands in front of it.

use nalgebra::{Point3, Translation3};
use ramp_planner::{End, Impossible};
use ramp_robot::Retry;

use super::contract::{ActionKind, Call, Effect, Need, Skill};
use crate::cell::Workcell;
use crate::cell::target::free_end;
use crate::fault::{Fault, SkillError};
use crate::grasp;
use crate::parameters::Parameters;
use crate::parameters::skills::SlideParameters;
use crate::primitive::grip::rehearse_grasps;
use crate::rehearsal::outline::{Motion, Outline};
use crate::rehearsal::scene::Scene;

/// Slides a beam that stands deeper than its place forward to its place.
///
/// A beam whose ends are all male droops while one female alone holds it, and no other beam can be put over
/// an end that hangs on the table. So it is inserted deeper than its place, the other beam is brought, and
/// then this one is lifted level and slid forward.
#[derive(Clone)]
pub struct Slide {
    parameters: SlideParameters,
}

impl Skill for Slide {
    fn name(&self) -> &str {
        "slide"
    }

    fn serves(&self) -> &[ActionKind] {
        &[ActionKind::Slide]
    }

    fn needs(&self) -> &[Need] {
        &[Need::HandRaised, Need::HandEmpty, Need::BeamStands]
    }

    fn parameters(&self) -> &[&'static str] {
        &["slide"]
    }

    fn expects(&self) -> &[Effect] {
        &[Effect::BeamAtPlace, Effect::HandEmpty]
    }

    fn rehearse(&self, scene: &Scene, call: &Call) -> Outline {
        let (Some(part), Ok(beam)) = (call.part(), call.beam(scene.assembly)) else {
            return Outline::nothing();
        };
        let path = scene.paths.get(&beam);
        let depth = path.map_or(0.0, |path| path.depth);
        let grasps = scene.standing_grasps(part, call.link(), free_end(scene.assembly, path, beam));
        rehearse_grasps(scene, part, grasps).then(&Motion::Contact(depth))
    }

    fn blame(&self, call: &Call) -> Option<Impossible> {
        call.cannot_grasp(End::Place)
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let beam = call.beam(cell.assembly)?;
        let link = call.link().ok_or_else(|| call.no_skill())?;
        self.slide(cell, beam, link)
    }

    fn let_go(&self, cell: &mut Workcell, _: &Call) -> Result<(), SkillError> {
        cell.release()
    }
}

impl Slide {
    /// With these numbers.
    pub fn new(parameters: &Parameters) -> Slide {
        Slide { parameters: parameters.slide.clone() }
    }

    /// Slides a deep beam forward to its place, holding it by `link`.
    ///
    /// # Errors
    /// [`Fault::Jammed`] when it does not get there, or the fault that stopped the motion.
    fn slide(&self, cell: &mut Workcell, beam: usize, link: &str) -> Result<(), SkillError> {
        let placed = &cell.assembly.beams[beam];
        let name = placed.beam.name.clone();
        let link = placed.beam.links.iter().find(|candidate| candidate.name == link);
        let link = link.ok_or_else(|| Fault::NoGrasp { part: name.clone() })?;
        let s = grasp::point_on(link, cell.belief.free_end(beam), &cell.parameters.grip);
        cell.see(&cell.belief.meeting(beam), self.parameters.known)?;
        cell.see_to_grip(&name)?;
        // Its droop is known better from the model than from detections: 0.2° lower, and its end would go
        // under the joint.
        cell.belief.reckon_heights(beam);
        cell.grasp_standing(beam, s)?;
        cell.hand.zero()?;
        // First once more with more force, then aimed aside.
        let [straight, others @ ..] = self.parameters.aside;
        let again = [straight].into_iter().chain(others).map(|aside| (aside, self.parameters.most));
        let mut jam = None;
        for (attempt, (aside, limit)) in
            [(straight, self.parameters.limit)].into_iter().chain(again).enumerate()
        {
            if attempt > 0 {
                let retry = Retry::new("slide", &name).attempt(attempt + 1);
                let because = match aside {
                    0.0 => format!("pushed with {limit:.0} N"),
                    _ => format!("aimed {:.1} mm aside, with {limit:.0} N", aside * 1e3),
                };
                cell.record(retry.because(because));
            }
            let tried = self.slide_once(cell, beam, aside, limit);
            cell.belief.drag(beam, (self.parameters.dragged, self.parameters.dragged_turn));
            jam = tried?;
            if jam.is_none() {
                break;
            }
        }
        if let Some(fault) = jam {
            cell.release()?;
            return Err(fault.into());
        }
        cell.belief.slid_into(beam);
        Ok(())
    }

    /// One try of a beam that is in the hand, its free end aimed `aside` (m) of where its female is, with at
    /// most `limit` (N).
    fn slide_once(
        &self,
        cell: &mut Workcell,
        beam: usize,
        aside: f64,
        limit: f64,
    ) -> Result<Option<Fault>, SkillError> {
        let placed = &cell.assembly.beams[beam];
        let name = placed.beam.name.clone();
        let goal = cell.belief.target(beam)?;
        let out = -cell.belief.insertion_direction(beam, &goal)?;
        let across = nalgebra::Vector3::z().cross(&out);
        let depth = cell.belief.path(beam)?.depth;
        cell.glance()?;
        let x_wb = cell.belief.parts.pose(&name)?;
        let end = Point3::new(cell.belief.free_end(beam), 0.0, 0.0);
        // Level, and in line with its place, as far in as it is.
        let to_go = (goal * end - x_wb * end).dot(&out).min(depth);
        let shift = across * aside - out * to_go;
        let level = Translation3::from(shift) * goal;
        let lifted = cell.hand.corrected(&x_wb, &level);
        cell.hand
            .drive(&lifted, self.parameters.speed, |hand| hand.force().norm() > self.parameters.lift_limit)?;
        cell.hand.wait(cell.parameters.hand.rest)?;
        cell.glance()?;
        let here = cell.hand.corrected(&cell.belief.parts.pose(&name)?, &level);
        cell.hand.go(&here, self.parameters.speed)?;
        let forward = Translation3::from(out * to_go) * here;
        let stopped =
            cell.hand.drive(&forward, self.parameters.speed, |hand| hand.force().dot(&out) > limit)?;
        let force = cell.hand.force().dot(&out);
        cell.hand.wait(self.parameters.rest)?;
        cell.belief.parts.update(&mut cell.hand)?;
        let remaining = (goal * end - cell.belief.parts.pose(&name)? * end).dot(&out);
        if stopped && remaining > self.parameters.seated {
            // Back to where it began.
            let mut back = cell.hand.setpoint;
            back.translation.vector -= out * (to_go - remaining).max(0.0);
            cell.hand.go(&back, self.parameters.speed)?;
            return Ok(Some(Fault::Jammed { part: name, remaining, force }));
        }
        let fine = cell.hand.corrected(&cell.belief.parts.pose(&name)?, &goal);
        cell.hand
            .drive(&fine, self.parameters.seat_speed, |hand| hand.force().norm() > self.parameters.limit)?;
        cell.hand.wait(self.parameters.rest)?;
        cell.see(&[(name.clone(), end)], self.parameters.known)?;
        let remaining = cell.belief.remaining(&name, &goal, &out)?;
        if remaining > self.parameters.seated {
            cell.record(Retry::new("slide", &name).off(remaining));
            cell.compliant_search(&name, &goal, &out, &cell.compliance(false))?;
        }
        Ok(None)
    }
}
