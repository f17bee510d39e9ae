//! Brings a beam that already stands in the assembly to its nominal place.

use super::assemble::Assemble;
use super::contract::{ActionKind, Call, Effect, Need, Skill};
use crate::cell::Workcell;
use crate::cell::alignment::PEGGABLE;
use crate::fault::{Fault, SkillError};
use crate::grasp;

/// A beam this near to its place is left alone, m.
const GOOD: f64 = 0.3e-3;
/// Speed, m/s.
const SPEED: f64 = 0.03;
/// Force at which a push stops, N.
const LIMIT: f64 = 20.0;
/// A beam that stands this far short of its place is inserted further, m.
const SHORT_OF: f64 = 3.0e-3;
/// How far a push may move the beams that are joined with the one that is pushed, m and rad.
const DRAGGED: (f64, f64) = (1.0e-3, 0.3 / 180.0 * std::f64::consts::PI);
/// Tries.
const TRIES: usize = 3;
/// Motions of one push at most: friction on the table stops each of them a little short.
const MOTIONS: usize = 6;

/// Grasps a beam in the assembly, and moves it to its nominal place.
///
/// A beam that a single peg holds swings by 4° to 5°: its free end must be put where the next beam expects it,
/// since a cap that meets a tip beside its opening jams whatever is done to it afterwards.
#[derive(Clone, Default)]
pub struct Push {
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

    fn expects(&self) -> &[Effect] {
        &[Effect::BeamAligned, Effect::HandEmpty]
    }

    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let beam = call.beam(cell)?;
        let link = call.link().ok_or_else(|| call.no_skill())?;
        self.push(cell, beam, link)
    }
}

impl Push {
    /// Aligns a standing beam, holding it by `link`, and lets go.
    ///
    /// # Errors
    /// [`Fault::Misaligned`] when it will not stay, or what stopped the motion.
    fn push(&self, cell: &mut Workcell, beam: usize, link: &str) -> Result<(), SkillError> {
        let placed = &cell.assembly.beams[beam];
        let name = placed.beam.name.clone();
        let Some(link) = placed.beam.links.iter().find(|candidate| candidate.name == link) else {
            return Err(Fault::NoGrasp { part: name }.into());
        };
        let far = cell.far_end(beam);
        for attempt in 0..TRIES {
            cell.see_ends(beam)?;
            if attempt == 0 {
                cell.diagnose_standing();
            }
            let (goal, off) = cell.straightened(beam)?;
            let near_off = cell.near_off(beam, &cell.belief.pose(&name)?, &goal);
            if off < GOOD && near_off < PEGGABLE {
                return Ok(());
            }
            if attempt > 0 {
                let off = if off < GOOD { near_off } else { off };
                cell.note("retry", format!("push {name}, {:.2} mm off", off * 1e3));
            }
            let s = grasp::point_on(link, far);
            if cell.anchor(beam).is_none() && cell.short(beam)? > SHORT_OF {
                self.assemble.reinsert(cell, beam, s)?;
                continue;
            }
            cell.grasp_standing(beam, s)?;
            // It stands on the table and in its joint: the hand does not carry it.
            if let Some(held) = &mut cell.hand.held {
                held.mass = 0.0;
            }
            cell.hand.zero()?;
            for motion in 0..MOTIONS {
                cell.glance()?;
                let x_wb = cell.belief.pose(&name)?;
                let there = cell.off(beam, &x_wb, &goal) < 0.5 * GOOD;
                if motion > 1 && there && cell.near_off(beam, &x_wb, &goal) < PEGGABLE {
                    break;
                }
                let target = cell.hand.corrected(&x_wb, &goal);
                cell.hand.drive(&target, SPEED, |hand| hand.force().norm() > LIMIT)?;
                cell.hand.wait(0.1)?;
            }
            cell.settle(beam)?;
            cell.release()?;
            self.drag(cell, beam);
        }
        cell.see_ends(beam)?;
        let (_, off) = cell.straightened(beam)?;
        // What comes next, a peg or the chamfers of a cap, takes this much.
        if off < PEGGABLE {
            return Ok(());
        }
        Err(Fault::Misaligned { connection: name, offset_mm: off * 1e3 }.into())
    }

    /// A beam was pushed: what it is joined with may have come along.
    fn drag(&self, cell: &mut Workcell, beam: usize) {
        let sides = cell.assembly.connections.iter();
        let joined = sides.filter_map(|connection| Some(cell.assembly.sides(connection, beam)?.1.beam));
        let joined: Vec<usize> = joined.filter(|other| cell.standing.contains(other)).collect();
        for other in joined {
            cell.belief.bumped(&cell.assembly.beams[other].beam.name, DRAGGED);
        }
    }
}
