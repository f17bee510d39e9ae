//! Slides a beam of the assembly back, deeper than its place, so that another one can be drawn off it.

use nalgebra::Translation3;
use ramp_planner::{End, Impossible};

use super::contract::{ActionKind, Call, Effect, Need, Skill};
use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::parameters::Parameters;
use crate::parameters::skills::SlideBackParameters;
use crate::primitive::grip::rehearse_grasps;
use crate::rehearsal::outline::{Motion, Outline};
use crate::rehearsal::scene::Scene;

/// Grasps a beam of the assembly and slides it back through its open joint, as deep as its insertion began.
#[derive(Clone)]
pub struct SlideBack {
    parameters: SlideBackParameters,
}

impl Skill for SlideBack {
    fn name(&self) -> &str {
        "slide_back"
    }

    fn serves(&self) -> &[ActionKind] {
        &[ActionKind::SlideBack]
    }

    fn needs(&self) -> &[Need] {
        &[Need::HandRaised, Need::HandEmpty, Need::BeamStands, Need::InsertionPath]
    }

    fn parameters(&self) -> &[&'static str] {
        &["slide_back", "search"]
    }

    fn expects(&self) -> &[Effect] {
        &[Effect::BeamDeep, Effect::HandEmpty]
    }

    fn rehearse(&self, scene: &Scene, call: &Call) -> Outline {
        let (Some(part), Ok(beam)) = (call.part(), call.beam(scene.assembly)) else {
            return Outline::nothing();
        };
        let depth = scene.paths.get(&beam).map_or(0.0, |path| path.depth);
        rehearse_grasps(scene, part, scene.grasps(part, call.link())).then(&Motion::Contact(depth))
    }

    fn blame(&self, call: &Call) -> Option<Impossible> {
        call.cannot_grasp(End::Place)
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let beam = call.beam(cell.assembly)?;
        let link = call.link().ok_or_else(|| call.no_skill())?;
        let name = cell.assembly.beams[beam].beam.name.clone();
        cell.grasp_in_assembly(beam, link)?;
        let goal = cell.belief.target(beam)?;
        let direction = cell.belief.insertion_direction(beam, &goal)?;
        let deep = Translation3::from(direction * cell.belief.path(beam)?.depth) * goal;
        cell.level_on_path(&name, &goal, &direction, self.parameters.lift_limit, self.parameters.speed)?;
        let target = cell.hand.corrected(&cell.belief.parts.pose(&name)?, &deep);
        let caught = cell.hand.drive(&target, self.parameters.speed, |hand| {
            hand.force().dot(&direction) > self.parameters.limit
        })?;
        cell.glance()?;
        let mut short = cell.belief.remaining(&name, &deep, &direction)?;
        if caught || short > self.parameters.short {
            cell.compliant_search(&name, &deep, &direction, &cell.compliance(false))?;
            short = cell.belief.remaining(&name, &deep, &direction)?;
        }
        cell.belief.drag(beam, (self.parameters.bump, self.parameters.bump_turn));
        if short < self.parameters.short {
            return Ok(());
        }
        let force = cell.hand.force().dot(&direction);
        cell.release()?;
        Err(Fault::Jammed { part: name, remaining: short, force }.into())
    }

    fn let_go(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        cell.settle(call.beam(cell.assembly)?)?;
        cell.release()
    }
}

impl SlideBack {
    /// With these numbers.
    pub fn new(parameters: &Parameters) -> SlideBack {
        SlideBack { parameters: parameters.slide_back.clone() }
    }
}
