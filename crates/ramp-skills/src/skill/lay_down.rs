//! Lays the held beam down at its place.

use nalgebra::Translation3;
use ramp_planner::{End, Impossible};

use super::contract::{ActionKind, Call, Effect, Need, Skill};
use super::insertion::rehearse_insertion;
use crate::cell::Workcell;
use crate::fault::SkillError;
use crate::parameters::Parameters;
use crate::parameters::skills::LayDownParameters;
use crate::rehearsal::outline::Outline;
use crate::rehearsal::scene::Scene;

/// Lays the held beam, which is over its place, on the table.
#[derive(Clone)]
pub struct LayDown {
    parameters: LayDownParameters,
}

impl Skill for LayDown {
    fn name(&self) -> &str {
        "lay_down"
    }

    fn serves(&self) -> &[ActionKind] {
        &[ActionKind::LayDown]
    }

    fn needs(&self) -> &[Need] {
        &[Need::HoldsPart]
    }

    fn parameters(&self) -> &[&'static str] {
        &["lay_down", "insertion"]
    }

    fn expects(&self) -> &[Effect] {
        &[Effect::BeamStands, Effect::HandEmpty]
    }

    fn rehearse(&self, scene: &Scene, call: &Call) -> Outline {
        rehearse_insertion(scene, call)
    }

    fn blame(&self, call: &Call) -> Option<Impossible> {
        call.cannot_grasp(End::Place)
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let beam = call.beam(cell.assembly)?;
        self.lay_down(cell, beam)
    }

    fn let_go(&self, cell: &mut Workcell, _: &Call) -> Result<(), SkillError> {
        cell.release()
    }
}

impl LayDown {
    /// With these numbers.
    pub fn new(parameters: &Parameters) -> LayDown {
        LayDown { parameters: parameters.lay_down.clone() }
    }

    /// Lays the held beam, which is over its place, on the table.
    ///
    /// # Errors
    /// [`Fault::NotHeld`](crate::Fault::NotHeld), or the fault that stopped the motion.
    fn lay_down(&self, cell: &mut Workcell, beam: usize) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        cell.hand.relax();
        cell.check_grip(&name)?;
        let goal = cell.belief.target(beam)?;
        cell.bring_to(&name, &(Translation3::new(0.0, 0.0, cell.parameters.insertion.clear) * goal))?;
        cell.hand.zero()?;
        let down = cell.hand.corrected(&cell.belief.parts.pose(&name)?, &goal);
        cell.hand.drive(&down, self.parameters.speed, |hand| {
            -hand.force().z > cell.parameters.release.table_limit
        })?;
        Ok(())
    }
}
