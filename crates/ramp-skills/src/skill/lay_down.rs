//! Lays the held beam down at its place.

use nalgebra::Translation3;

use super::contract::{ActionKind, Call, Effect, Need, Skill};
use crate::cell::Workcell;
use crate::fault::SkillError;

/// Force on the table at which a beam lies on it, N.
const TABLE_LIMIT: f64 = 8.0;
/// How high over its way a beam is brought to where its insertion begins, m.
const CLEAR: f64 = 4.0e-3;
/// Speed of an insertion, m/s.
const SPEED: f64 = 0.03;

/// Lays the held beam, which is over its place, on the table.
#[derive(Clone, Default)]
pub struct LayDown;

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

    fn expects(&self) -> &[Effect] {
        &[Effect::BeamStands, Effect::HandEmpty]
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let beam = call.beam(cell)?;
        self.lay_down(cell, beam)
    }

    fn let_go(&self, cell: &mut Workcell, _: &Call) -> Result<(), SkillError> {
        cell.release()
    }
}

impl LayDown {
    /// Lays the held beam, which is over its place, on the table.
    ///
    /// # Errors
    /// [`Fault::NotHeld`], or what stopped the motion.
    fn lay_down(&self, cell: &mut Workcell, beam: usize) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        cell.hand.relax();
        cell.check_grip(&name)?;
        let goal = cell.target(beam)?;
        cell.bring_to(&name, &(Translation3::new(0.0, 0.0, CLEAR) * goal))?;
        cell.hand.zero()?;
        let down = cell.hand.corrected(&cell.belief.pose(&name)?, &goal);
        cell.hand.drive(&down, SPEED, |hand| -hand.force().z > TABLE_LIMIT)?;
        Ok(())
    }
}
