//! Draws a beam out of the assembly, back along its insertion path.

use nalgebra::{Translation3, Vector3};
use ramp_planner::{End, Impossible};
use ramp_robot::Retry;

use super::contract::{ActionKind, Call, Effect, Need, Skill};
use crate::Pose;
use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::grasp::Grasp;
use crate::parameters::Parameters;
use crate::parameters::skills::TakeOutParameters;
use crate::primitive::grip::rehearse_grasps;
use crate::rehearsal::outline::{Motion, Outline};
use crate::rehearsal::scene::Scene;

/// Grasps a beam of the assembly, lifts it level and draws it out to where its insertion began.
#[derive(Clone)]
pub struct TakeOut {
    parameters: TakeOutParameters,
}

impl Skill for TakeOut {
    fn name(&self) -> &str {
        "take_out"
    }

    fn serves(&self) -> &[ActionKind] {
        &[ActionKind::TakeOut]
    }

    fn needs(&self) -> &[Need] {
        &[Need::HandRaised, Need::HandEmpty, Need::BeamStands, Need::InsertionPath]
    }

    fn parameters(&self) -> &[&'static str] {
        &["take_out", "search"]
    }

    fn expects(&self) -> &[Effect] {
        &[Effect::BeamOut, Effect::HoldsPart]
    }

    fn rehearse(&self, scene: &Scene, call: &Call) -> Outline {
        let (Some(part), Ok(beam)) = (call.part(), call.beam(scene.assembly)) else {
            return Outline::nothing();
        };
        let way = scene.paths.get(&beam).map_or(0.0, |path| path.distance + path.depth);
        rehearse_grasps(scene, part, scene.grasps(part, call.link())).then(&Motion::Contact(way))
    }

    fn blame(&self, call: &Call) -> Option<Impossible> {
        call.cannot_grasp(End::Place)
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let beam = call.beam(cell.assembly)?;
        let link = call.link().ok_or_else(|| call.no_skill())?;
        cell.grasp_in_assembly(beam, link)?;
        let drawn = self.draw_out(cell, beam);
        if let Err(SkillError::Fault(Fault::Jammed { .. } | Fault::Overload { .. })) = &drawn {
            // It stays where it is, and the next try goes on from there.
            cell.release()?;
        }
        drawn
    }
}

impl TakeOut {
    /// With these numbers.
    pub fn new(parameters: &Parameters) -> TakeOut {
        TakeOut { parameters: parameters.take_out.clone() }
    }

    /// Draws the beam in the hand out. One that catches on an edge, or of which one end stays behind in a
    /// joint, searches compliantly for the way, as on its way in.
    fn draw_out(&self, cell: &mut Workcell, beam: usize) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        let goal = cell.belief.target(beam)?;
        let out = -cell.belief.insertion_direction(beam, &goal)?;
        let path = cell.belief.path(beam)?;
        let (distance, met) = (path.distance, cell.belief.meeting(beam));
        let start = Translation3::from(out * (distance + self.parameters.beyond)) * goal;
        cell.level_on_path(&name, &goal, &out, self.parameters.lift_limit, self.parameters.speed)?;
        for attempt in 0..self.parameters.tries {
            let target = cell.hand.corrected(&cell.belief.parts.pose(&name)?, &start);
            let caught = cell.hand.drive(&target, self.parameters.speed, |hand| {
                -hand.force().dot(&out) > self.parameters.limit
            })?;
            cell.glance()?;
            let mut short = cell.belief.remaining(&name, &start, &out)?;
            if caught || short > self.parameters.beyond {
                cell.compliant_search(&name, &start, &out, &cell.compliance(false))?;
                short = cell.belief.remaining(&name, &start, &out)?;
            }
            for (other, _) in met.iter().filter(|(other, _)| *other != name) {
                cell.belief.parts.bumped(other, (self.parameters.bump, self.parameters.bump_turn));
            }
            if short < self.parameters.beyond {
                cell.hand.pushed = caught;
                cell.return_to_sheet(&name);
                return Ok(());
            }
            if attempt + 1 == self.parameters.tries {
                let force = -cell.hand.force().dot(&out);
                return Err(Fault::Jammed { part: name, remaining: short, force }.into());
            }
            cell.record(Retry::new("take_out", &name).attempt(attempt + 2).off(short));
        }
        Ok(())
    }
}

impl Workcell<'_, '_> {
    /// Grips a beam where it stands in the assembly, by this link, and by another one if the hand cannot.
    ///
    /// # Errors
    /// As [`Workcell::grasp`].
    pub fn grasp_in_assembly(&mut self, beam: usize, link: &str) -> Result<(), SkillError> {
        let placed = &self.assembly.beams[beam].beam;
        self.see_to_grip(&placed.name)?;
        self.belief.reckon_heights(beam);
        let others = placed.links.iter().map(|link| link.name.as_str()).filter(|other| *other != link);
        let mut last = None;
        for link in std::iter::once(link).chain(others) {
            let gripped = self.choose_grasp(&placed.name, Some(link)).and_then(|grasp| {
                self.grasp(&placed.name, &grasp)?;
                self.centre_wedged_ribs(&placed.name, &grasp)
            });
            match gripped {
                Err(SkillError::Fault(Fault::NoGrasp { .. }) | SkillError::Motion(_)) => {
                    last = Some(gripped);
                    self.retreat()?;
                }
                done => return done,
            }
        }
        last.unwrap_or(Err(Fault::NoGrasp { part: placed.name.clone() }.into()))
    }

    /// Closes again on a beam whose slots the ribs have met at their edges: from such a grasp the fingers
    /// would not open when the beam is put down.
    fn centre_wedged_ribs(&mut self, name: &str, grasp: &Grasp) -> Result<(), SkillError> {
        let short = self.hand.seen.width - grasp.width;
        if short < self.parameters.take_out.wedged {
            return Ok(());
        }
        let because = format!("the ribs stand {:.1} mm out of the slots of {name}", short * 1e3);
        self.record(Retry::new("grasp", name).because(because));
        self.hand.held = None;
        self.belief.parts.released(name);
        self.centre_ribs(true, 0.0)?;
        let here = Grasp { x_wt: self.hand.seen.x_wt, ..*grasp };
        self.close_on(name, &here)
    }

    /// Brings a beam of the assembly that is in the hand level and into line with its place, as far along its
    /// insertion path as it is: its free end may lie on the table.
    ///
    /// # Errors
    /// The fault that stopped the motion, or the robot's error.
    pub fn level_on_path(
        &mut self,
        name: &str,
        goal: &Pose,
        along: &Vector3<f64>,
        limit: f64,
        speed: f64,
    ) -> Result<(), SkillError> {
        self.hand.zero()?;
        self.glance()?;
        let x_wb = self.belief.parts.pose(name)?;
        let far = (x_wb.translation.vector - goal.translation.vector).dot(along);
        let level = Translation3::from(along * far) * goal;
        let target = self.hand.corrected(&x_wb, &level);
        self.hand.drive(&target, speed, |hand| hand.force().norm() > limit)?;
        self.hand.wait(self.parameters.hand.rest)?;
        self.hand.zero()?;
        self.glance()
    }
}
