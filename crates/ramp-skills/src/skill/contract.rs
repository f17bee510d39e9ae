//! The contract of a skill: its fine actions, preconditions, execution and effects.

use std::fmt;

use ramp_assembly::Assembly;
pub use ramp_planner::ActionKind;
use ramp_planner::{CoarseStep, End, FineAction, Impossible, Place};

use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};
use crate::rehearsal::outline::Outline;
use crate::rehearsal::scene::Scene;

/// A fine action that a skill is asked to carry out, and its place in the plan.
#[derive(Clone, Copy, Debug)]
pub struct Call<'p> {
    /// The action.
    pub action: &'p FineAction,
    /// The plan; empty outside a plan.
    pub plan: &'p [CoarseStep],
    /// The coarse step of the action, an index into `plan`.
    pub step: usize,
}

impl<'p> Call<'p> {
    /// A call outside a plan.
    pub fn alone(action: &'p FineAction) -> Call<'p> {
        Call { action, plan: &[], step: 0 }
    }

    /// Its kind.
    pub fn kind(&self) -> ActionKind {
        self.action.kind()
    }

    /// The part that the hand works with ([`FineAction::part`]).
    pub fn part(&self) -> Option<&'p str> {
        self.action.part()
    }

    /// The beam of the assembly that the action names, by index.
    ///
    /// # Errors
    /// [`Fault::NoSkill`] when the goal has no such beam, or the action names none.
    pub fn beam(&self, assembly: &Assembly) -> Result<usize, Fault> {
        self.part().and_then(|part| assembly.beam_index(part)).ok_or_else(|| self.no_skill())
    }

    /// The connection of the goal that the action names, by index.
    ///
    /// # Errors
    /// [`Fault::NoSkill`] when the goal has no such connection, or the action names none.
    pub fn connection(&self, assembly: &Assembly) -> Result<usize, Fault> {
        let connection = self.action.connection();
        connection.and_then(|name| assembly.connection_index(name)).ok_or_else(|| self.no_skill())
    }

    /// The link by which the hand holds the beam of the action, according to the plan: the one that the
    /// action names, the one of the pick-up that follows for [`Place::Input`], and otherwise the one of the
    /// last grasp before.
    pub fn link(&self) -> Option<&'p str> {
        if let Some(link) = self.action.link() {
            return Some(link);
        }
        let part = self.part()?;
        let grasped = |action: &'p FineAction| match action {
            FineAction::PickUp { .. } | FineAction::Regrasp { .. } if action.part() == Some(part) => {
                action.link()
            }
            _ => None,
        };
        let fine = |steps: &'p [CoarseStep]| steps.iter().flat_map(|step| &step.fine);
        match self.action {
            FineAction::Move { to: Place::Input(_) } => fine(self.plan.get(self.step..)?).find_map(grasped),
            _ => fine(self.plan.get(..=self.step)?).rev().find_map(grasped),
        }
    }

    /// The fact that the hand cannot hold the beam of the action by its link ([`Call::link`]) at one of its
    /// two places.
    pub fn cannot_grasp(&self, at: End) -> Option<Impossible> {
        let (beam, link) = (self.part()?.to_string(), self.link()?.to_string());
        Some(Impossible::Grasp { beam, link, at })
    }

    /// The fault that nothing here can do the action.
    pub fn no_skill(&self) -> Fault {
        Fault::NoSkill { action: self.action.to_string() }
    }
}

/// Preconditions of a skill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// The tip is at travelling height. The executor raises it, so that this always holds.
    HandRaised,
    /// The hand holds nothing.
    HandEmpty,
    /// The hand holds the action's part.
    HoldsPart,
    /// The plan says how the action's beam gets to its place.
    InsertionPath,
    /// The action's beam stands in the assembly.
    BeamStands,
}

impl Need {
    /// Does it hold, as the agent believes?
    pub fn holds(self, cell: &Workcell, call: &Call) -> bool {
        let beam = || call.beam(cell.assembly).ok();
        match self {
            Need::HandRaised => true,
            Need::HandEmpty => cell.hand.held.is_none(),
            Need::HoldsPart => holds_part(cell, call),
            Need::InsertionPath => beam().is_some_and(|beam| cell.belief.paths.contains_key(&beam)),
            Need::BeamStands => beam().is_some_and(|beam| cell.belief.standing.contains(&beam)),
        }
    }
}

impl fmt::Display for Need {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Need::HandRaised => "the hand is at travelling height",
            Need::HandEmpty => "the hand is empty",
            Need::HoldsPart => "the hand holds the part",
            Need::InsertionPath => "the plan gives an insertion path",
            Need::BeamStands => "the beam stands in the assembly",
        })
    }
}

/// Effects of a skill, by the agent's belief.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// The hand holds the action's part.
    HoldsPart,
    /// The hand holds nothing.
    HandEmpty,
    /// The beam stands in the assembly, as deep as its insertion path says.
    BeamStands,
    /// The beam, which stood deeper, stands at its place.
    BeamAtPlace,
    /// The ends of the beam are where the next part expects them. Only a detection can confirm this, so the
    /// belief is not changed.
    BeamAligned,
    /// The peg pins its connection.
    PegSeated,
    /// The beam stands in the assembly no more.
    BeamOut,
    /// The beam, which stood at its place, stands deeper, as its insertion began.
    BeamDeep,
    /// The peg pins its connection no more.
    PegOut,
}

impl Effect {
    /// Records the inserted beams and pinned connections after the skill has run and before it releases the
    /// part.
    ///
    /// # Errors
    /// [`Fault::NoSkill`] if the goal lacks a part that the action names.
    pub fn apply(self, cell: &mut Workcell, call: &Call) -> Result<(), Fault> {
        match self {
            Effect::BeamStands => {
                let beam = call.beam(cell.assembly)?;
                if !cell.belief.standing.contains(&beam) {
                    cell.belief.standing.push(beam);
                }
                let deep = cell.belief.paths.get(&beam).is_some_and(|path| path.depth > 0.0);
                if deep && !cell.belief.deep.contains(&beam) {
                    cell.belief.deep.push(beam);
                }
            }
            Effect::BeamAtPlace => {
                let beam = call.beam(cell.assembly)?;
                cell.belief.deep.retain(|other| *other != beam);
            }
            Effect::PegSeated => {
                let connection = call.connection(cell.assembly)?;
                let peg = call.part().ok_or_else(|| call.no_skill())?;
                cell.belief.pinned.push((connection, peg.to_string()));
            }
            Effect::BeamOut => {
                let beam = call.beam(cell.assembly)?;
                cell.belief.standing.retain(|other| *other != beam);
                cell.belief.deep.retain(|other| *other != beam);
            }
            Effect::BeamDeep => {
                let beam = call.beam(cell.assembly)?;
                if !cell.belief.deep.contains(&beam) {
                    cell.belief.deep.push(beam);
                }
            }
            Effect::PegOut => {
                let peg = call.part().ok_or_else(|| call.no_skill())?;
                cell.belief.pinned.retain(|(_, other)| other != peg);
            }
            Effect::HoldsPart | Effect::HandEmpty | Effect::BeamAligned => {}
        }
        Ok(())
    }

    /// Applies the effects after the release, and compares them with the hand.
    ///
    /// # Errors
    /// [`Fault::Unmet`] when the hand holds something else than the effect says.
    pub fn confirm(self, cell: &mut Workcell, call: &Call) -> Result<(), Fault> {
        let met = match self {
            Effect::BeamStands | Effect::BeamAtPlace | Effect::BeamDeep => {
                let beam = call.beam(cell.assembly)?;
                cell.belief.reckon_heights(beam);
                true
            }
            Effect::HoldsPart => holds_part(cell, call),
            Effect::HandEmpty => cell.hand.held.is_none(),
            Effect::BeamAligned | Effect::PegSeated | Effect::BeamOut | Effect::PegOut => true,
        };
        if met {
            Ok(())
        } else {
            Err(Fault::Unmet { action: call.action.to_string(), effect: self.to_string() })
        }
    }
}

impl fmt::Display for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Effect::HoldsPart => "the hand holds the part",
            Effect::HandEmpty => "the hand is empty",
            Effect::BeamStands => "the beam stands in the assembly",
            Effect::BeamAtPlace => "the beam stands at its place",
            Effect::BeamAligned => "the ends of the beam are where the next part expects them",
            Effect::PegSeated => "the peg pins the connection",
            Effect::BeamOut => "the beam is out of the assembly",
            Effect::BeamDeep => "the beam stands deeper than its place",
            Effect::PegOut => "the peg is out of the connection",
        })
    }
}

fn holds_part(cell: &Workcell, call: &Call) -> bool {
    cell.hand.held.as_ref().is_some_and(|held| Some(held.part.as_str()) == call.part())
}

/// Carries out fine actions of some kinds. A table ([`crate::SkillTable`]) has one for each kind.
///
/// The executor calls [`Skill::ready`], [`Skill::run`], applies what the skill [`expects`](Skill::expects),
/// and then calls [`Skill::let_go`].
pub trait Skill: Send + Sync {
    /// Its name, as in the result of a run in which it replaces one of the baseline's.
    fn name(&self) -> &str;

    /// The kinds of actions that it carries out.
    fn serves(&self) -> &[ActionKind];

    /// Preconditions.
    fn needs(&self) -> &[Need] {
        &[]
    }

    /// Effects, by the agent's belief.
    fn expects(&self) -> &[Effect];

    /// The tables of the parameter file that have its numbers: its own first, then those that it shares.
    fn parameters(&self) -> &[&'static str] {
        &[]
    }

    /// The motions that [`Skill::run`] will ask for, with the alternatives among which it chooses, in the
    /// order in which it prefers them. [`Outline::Unknown`] for a skill that cannot say: its actions then
    /// count as possible, and an event says so.
    fn rehearse(&self, scene: &Scene, call: &Call) -> Outline;

    /// The fact for the planner that follows when the arm cannot carry out the action. `None` where the
    /// failure says nothing by itself: a rehearsal then asks the actions that follow with the same part in
    /// the hand.
    fn blame(&self, _call: &Call) -> Option<Impossible> {
        None
    }

    /// Can it run now?
    ///
    /// # Errors
    /// [`Fault::NotReady`] with the first of its needs that does not hold.
    fn ready(&self, cell: &Workcell, call: &Call) -> Result<(), Fault> {
        match self.needs().iter().find(|need| !need.holds(cell, call)) {
            None => Ok(()),
            Some(need) => Err(Fault::NotReady { action: call.action.to_string(), need: need.to_string() }),
        }
    }

    /// Brings its effect about.
    ///
    /// # Errors
    /// The fault that is left after its own retries, or the robot's error.
    fn run(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError>;

    /// Lets go of the part, for a skill whose effect must be believed before the hand opens.
    ///
    /// # Errors
    /// The fault that stopped the motion, or the robot's error.
    fn let_go(&self, _cell: &mut Workcell, _call: &Call) -> Result<(), SkillError> {
        Ok(())
    }
}
