//! Puts a part back where it was picked up.

use super::contract::{ActionKind, Call, Effect, Skill};
use crate::cell::Workcell;
use crate::fault::SkillError;

/// Force on the table or the holder at which a part counts as put down, N.
const PUT_DOWN_LIMIT: f64 = 8.0;

/// Puts the held part back where it was picked up, and lets go of it.
#[derive(Clone, Default)]
pub struct PutDown;

impl Skill for PutDown {
    fn name(&self) -> &str {
        "put_down"
    }

    fn serves(&self) -> &[ActionKind] {
        &[ActionKind::PutDown]
    }

    fn expects(&self) -> &[Effect] {
        &[Effect::HandEmpty]
    }

    fn run(&self, cell: &mut Workcell, _: &Call) -> Result<(), SkillError> {
        self.put_back(cell)
    }
}

impl PutDown {
    /// Puts the held part back where it was picked up, and lets go of it.
    ///
    /// # Errors
    /// [`Fault::NotHeld`] when there is nothing in the hand any more, or what stopped the motion.
    fn put_back(&self, cell: &mut Workcell) -> Result<(), SkillError> {
        let Some(part) = cell.hand.held.as_ref().map(|held| held.part.clone()) else { return Ok(()) };
        cell.retreat()?;
        cell.check_grip(&part)?;
        let Some(held) = cell.hand.held.clone() else { return Ok(()) };
        // A peg's stem is above its holder, a beam above the table.
        let down = cell.carry_above(held.x_wp_origin * held.x_tp.inverse(), |down| down + 0.045)?;
        cell.hand.relax();
        cell.hand.zero()?;
        cell.hand.drive(&down, 0.05, |hand| -hand.force().z > PUT_DOWN_LIMIT)?;
        cell.release()
    }
}
