//! Inserts a male of the held beam into the assembly.

use nalgebra::Translation3;
use ramp_robot::Cause;

use super::contract::{ActionKind, Call, Effect, Need, Skill};
use super::insertion::Insertion;
use crate::Pose;
use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::primitive::search::{Compliance, HOME};

/// Force against the motion at which a square insertion stops, N.
const SQUARE_LIMIT: f64 = 12.0;
/// Force against the motion at which a beam stops that goes through a sleeve that little holds, N.
const LOOSE_LIMIT: f64 = 0.6;
/// How well the joints that are to meet must be known before an insertion, m.
const KNOWN: f64 = 0.15e-3;
/// Standing still for so long while it is felt in, a beam has met more than an edge, s.
const STUCK: f64 = 2.5;
/// How often an insertion that jams is tried again.
const TRIES: usize = 4;
/// How high a beam that stands on the table slides over it, m.
const SLIDE_HEIGHT: f64 = 0.1e-3;

/// Inserts a male of the held beam into the assembly, along the beam's insertion path: square, at an angle, through
/// sleeves, or deeper than its place.
#[derive(Clone, Default)]
pub struct Assemble {
    insertion: Insertion,
}

impl Skill for Assemble {
    fn name(&self) -> &str {
        "assemble"
    }

    fn serves(&self) -> &[ActionKind] {
        &[
            ActionKind::AssembleSquare,
            ActionKind::AssembleAngled,
            ActionKind::AssembleThrough,
            ActionKind::AssembleDeep,
        ]
    }

    fn needs(&self) -> &[Need] {
        &[Need::HoldsPart, Need::InsertionPath]
    }

    fn expects(&self) -> &[Effect] {
        &[Effect::BeamStands, Effect::HandEmpty]
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let beam = call.beam(cell)?;
        self.insertion.tries(cell, beam, |cell, attempt| self.once(cell, beam, attempt))
    }

    fn let_go(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let beam = call.beam(cell)?;
        self.insertion.let_go(cell, beam)
    }
}

impl Assemble {
    fn once(&self, cell: &mut Workcell, beam: usize, attempt: usize) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        let stands = cell.assembly.beams[beam].beam.stands_at_assembled_height();
        let height = if stands { SLIDE_HEIGHT } else { 0.0 };
        let mut aim = self.insertion.begin(cell, beam, height, attempt)?;
        let loose = !aim.loose.is_empty();
        let limit = if loose { LOOSE_LIMIT } else { SQUARE_LIMIT };
        cell.glance()?;
        let mut target = cell.hand.corrected(&cell.belief.pose(&name)?, &aim.goal);
        target.translation.z += height;
        let pushed = self.insertion.push_in(cell, beam, &aim, &target, limit)?;
        if pushed.stopped {
            let direction = aim.direction;
            let mut remaining = cell.remaining(&name, &aim.goal, &direction)?;
            let met =
                format!("{name} meets {:.0} N {:.1} mm before its place", pushed.force, remaining * 1e3);
            let mut stuck = remaining > HOME;
            if remaining > HOME {
                let sleeve = cell.sleeves(beam).next();
                if let Some(sleeve) = sleeve {
                    aim.goal.translation.z += cell.touch_floor(&name, sleeve, &direction)?;
                }
                let stood = cell.compliant_search(&name, &aim.goal, &direction, Compliance::into(loose))?;
                remaining = cell.remaining(&name, &aim.goal, &direction)?;
                // The search gets past edges. What holds a beam for longer is in its way.
                stuck = stood > STUCK || remaining > HOME;
            }
            if stuck {
                cell.diagnose(Cause::Jam, met);
            }
            if remaining > HOME {
                return self.insertion.back_out(cell, beam, &direction, remaining, pushed.force);
            }
        }
        self.seat(cell, beam, &aim.goal, height, limit, loose)
    }

    /// Brings a held beam that is in its joints all the way to `goal`, as sight says: what remains is mostly a fraction
    /// of a millimetre, and otherwise felt in.
    fn seat(
        &self,
        cell: &mut Workcell,
        beam: usize,
        goal: &Pose,
        height: f64,
        limit: f64,
        loose: bool,
    ) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        let direction = cell.insertion_direction(beam, goal)?;
        for _ in 0..TRIES {
            let x_wp = cell.belief.pose(&name)?;
            let fine = cell.hand.corrected(&x_wp, &(Translation3::new(0.0, 0.0, height) * goal));
            cell.hand.drive(&fine, 0.01, |hand| hand.force().norm() > limit)?;
            cell.hand.wait(0.15)?;
            cell.see(&[cell.middle(&name)], KNOWN)?;
            let remaining = cell.remaining(&name, goal, &direction)?;
            if remaining < HOME {
                return Ok(());
            }
            cell.note("retry", format!("insert {name}, {:.1} mm short", remaining * 1e3));
            cell.compliant_search(&name, goal, &direction, Compliance::into(loose))?;
        }
        let (remaining, force) =
            (cell.remaining(&name, goal, &direction)?, cell.hand.force().dot(&direction));
        if remaining < 2.0 * HOME {
            return Ok(());
        }
        Err(Fault::Jammed { part: name, remaining_mm: remaining * 1e3, force }.into())
    }

    /// Grips a beam that stands short of its place on its way in, and takes it there.
    ///
    /// # Errors
    /// [`Fault::Jammed`], or what stopped the motion.
    pub fn reinsert(&self, cell: &mut Workcell, beam: usize, s: f64) -> Result<(), SkillError> {
        let name = cell.assembly.beams[beam].beam.name.clone();
        cell.grasp_standing(beam, s)?;
        let goal = cell.target(beam)?;
        let direction = cell.insertion_direction(beam, &goal)?;
        let loose = !cell.loose_sleeves(beam, 1).is_empty();
        cell.hand.zero()?;
        cell.compliant_search(&name, &goal, &direction, Compliance::into(loose))?;
        let limit = if loose { LOOSE_LIMIT } else { SQUARE_LIMIT };
        let seated = self.seat(cell, beam, &goal, 0.0, limit, loose);
        cell.settle(beam)?;
        cell.release()?;
        cell.reckon_heights(beam);
        seated
    }
}
