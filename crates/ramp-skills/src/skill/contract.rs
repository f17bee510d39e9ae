//! What a skill is: the fine actions that it serves, what must hold before, what it does, and what holds after.

use std::fmt;

use ramp_planner::{CoarseStep, FineAction, Item, Place, Target};

use crate::cell::Workcell;
use crate::fault::{Fault, SkillError};

/// A kind of fine action ([`FineAction`] without its arguments): the key of a table of skills.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ActionKind {
    /// [`FineAction::Move`].
    Move,
    /// [`FineAction::PickUp`].
    PickUp,
    /// [`FineAction::PutDown`].
    PutDown,
    /// [`FineAction::AssembleSquare`].
    AssembleSquare,
    /// [`FineAction::AssembleAngled`].
    AssembleAngled,
    /// [`FineAction::AssembleThrough`].
    AssembleThrough,
    /// [`FineAction::AssembleDeep`].
    AssembleDeep,
    /// [`FineAction::AssembleCap`].
    AssembleCap,
    /// [`FineAction::LayDown`].
    LayDown,
    /// [`FineAction::Slide`].
    Slide,
    /// [`FineAction::Regrasp`].
    Regrasp,
    /// [`FineAction::Fasten`].
    Fasten,
    /// [`FineAction::Push`].
    Push,
}

impl ActionKind {
    /// The kind of an action.
    pub fn of(action: &FineAction) -> ActionKind {
        match action {
            FineAction::Move { .. } => ActionKind::Move,
            FineAction::PickUp { .. } => ActionKind::PickUp,
            FineAction::PutDown { .. } => ActionKind::PutDown,
            FineAction::AssembleSquare { .. } => ActionKind::AssembleSquare,
            FineAction::AssembleAngled { .. } => ActionKind::AssembleAngled,
            FineAction::AssembleThrough { .. } => ActionKind::AssembleThrough,
            FineAction::AssembleDeep { .. } => ActionKind::AssembleDeep,
            FineAction::AssembleCap { .. } => ActionKind::AssembleCap,
            FineAction::LayDown { .. } => ActionKind::LayDown,
            FineAction::Slide { .. } => ActionKind::Slide,
            FineAction::Regrasp { .. } => ActionKind::Regrasp,
            FineAction::Fasten { .. } => ActionKind::Fasten,
            FineAction::Push { .. } => ActionKind::Push,
        }
    }

    /// Its name, as in a plan's JSON.
    pub fn name(self) -> &'static str {
        match self {
            ActionKind::Move => "move",
            ActionKind::PickUp => "pick_up",
            ActionKind::PutDown => "put_down",
            ActionKind::AssembleSquare => "assemble_square",
            ActionKind::AssembleAngled => "assemble_angled",
            ActionKind::AssembleThrough => "assemble_through",
            ActionKind::AssembleDeep => "assemble_deep",
            ActionKind::AssembleCap => "assemble_cap",
            ActionKind::LayDown => "lay_down",
            ActionKind::Slide => "slide",
            ActionKind::Regrasp => "regrasp",
            ActionKind::Fasten => "fasten",
            ActionKind::Push => "push",
        }
    }
}

/// What a skill is asked to do: a fine action, and where in the plan it stands.
#[derive(Clone, Copy, Debug)]
pub struct Call<'p> {
    /// The action.
    pub action: &'p FineAction,
    /// The plan from the action's own coarse step on; empty outside a plan.
    pub rest: &'p [CoarseStep],
}

impl<'p> Call<'p> {
    /// A call outside a plan.
    pub fn alone(action: &'p FineAction) -> Call<'p> {
        Call { action, rest: &[] }
    }

    /// Its kind.
    pub fn kind(&self) -> ActionKind {
        ActionKind::of(self.action)
    }

    /// The part that the hand works with: the one that the action names first; for [`FineAction::Fasten`] the peg.
    pub fn part(&self) -> Option<&'p str> {
        match self.action {
            FineAction::Move { to: Place::Input(item) }
            | FineAction::PickUp { item, .. }
            | FineAction::PutDown { item } => Some(item.name()),
            FineAction::Move {
                to: Place::Approach(Target::Beam(beam)) | Place::Target(Target::Beam(beam)),
            }
            | FineAction::AssembleSquare { beam, .. }
            | FineAction::AssembleAngled { beam, .. }
            | FineAction::AssembleThrough { beam, .. }
            | FineAction::AssembleDeep { beam, .. }
            | FineAction::AssembleCap { beam, .. }
            | FineAction::LayDown { beam }
            | FineAction::Slide { beam, .. }
            | FineAction::Regrasp { beam, .. }
            | FineAction::Push { beam, .. } => Some(beam),
            FineAction::Fasten { peg, .. } => Some(peg),
            FineAction::Move { .. } => None,
        }
    }

    /// The beam of the assembly that the action names, by index.
    ///
    /// # Errors
    /// [`Fault::NoSkill`] when the goal has no such beam, or the action names none.
    pub fn beam(&self, cell: &Workcell) -> Result<usize, Fault> {
        self.part().and_then(|part| cell.assembly.beam_index(part)).ok_or_else(|| self.no_skill())
    }

    /// The connection of the goal that the action names, by index.
    ///
    /// # Errors
    /// [`Fault::NoSkill`] when the goal has no such connection, or the action names none.
    pub fn connection(&self, cell: &Workcell) -> Result<usize, Fault> {
        let name = match self.action {
            FineAction::Fasten { connection, .. }
            | FineAction::Move { to: Place::Approach(Target::Connection(connection)) } => Some(connection),
            _ => None,
        };
        name.and_then(|name| cell.assembly.connection_index(name)).ok_or_else(|| self.no_skill())
    }

    /// The link by which the plan has the hand hold the beam: in this action, or for [`Place::Input`] when it picks
    /// the item up next.
    pub fn link(&self) -> Option<&'p str> {
        let grasped = |item: &Item, action: &'p FineAction| match action {
            FineAction::PickUp { item: other, grasp: ramp_planner::Grasp::Link(link) } if other == item => {
                Some(link.as_str())
            }
            _ => None,
        };
        match self.action {
            FineAction::Slide { link, .. }
            | FineAction::Regrasp { link, .. }
            | FineAction::Push { link, .. } => Some(link),
            FineAction::PickUp { item, .. } => grasped(item, self.action),
            FineAction::Move { to: Place::Input(item) } => {
                self.rest.iter().flat_map(|step| &step.fine).find_map(|action| grasped(item, action))
            }
            _ => None,
        }
    }

    /// The fault that nothing here can do the action.
    pub fn no_skill(&self) -> Fault {
        Fault::NoSkill { action: self.action.to_string() }
    }
}

/// What must hold before a skill runs.
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
        let beam = || call.beam(cell).ok();
        match self {
            Need::HandRaised => true,
            Need::HandEmpty => cell.hand.held.is_none(),
            Need::HoldsPart => holds_part(cell, call),
            Need::InsertionPath => beam().is_some_and(|beam| cell.paths.contains_key(&beam)),
            Need::BeamStands => beam().is_some_and(|beam| cell.standing.contains(&beam)),
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

/// What holds after a skill, as the agent then believes.
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
    /// The ends of the beam are where the next part expects them. Sight tells; the belief changes nothing.
    BeamAligned,
    /// The peg pins its connection.
    PegSeated,
}

impl Effect {
    /// Writes down what stands and what is pinned, once the skill has run and before it lets go.
    ///
    /// # Errors
    /// [`Fault::NoSkill`] when the goal does not have what the action names.
    pub fn apply(self, cell: &mut Workcell, call: &Call) -> Result<(), Fault> {
        match self {
            Effect::BeamStands => {
                let beam = call.beam(cell)?;
                if !cell.standing.contains(&beam) {
                    cell.standing.push(beam);
                }
                let deep = cell.paths.get(&beam).is_some_and(|path| path.depth > 0.0);
                if deep && !cell.deep.contains(&beam) {
                    cell.deep.push(beam);
                }
            }
            Effect::BeamAtPlace => {
                let beam = call.beam(cell)?;
                cell.deep.retain(|other| *other != beam);
            }
            Effect::PegSeated => {
                let connection = call.connection(cell)?;
                let peg = call.part().ok_or_else(|| call.no_skill())?;
                cell.pinned.push((connection, peg.to_string()));
            }
            Effect::HoldsPart | Effect::HandEmpty | Effect::BeamAligned => {}
        }
        Ok(())
    }

    /// Takes over what follows once the hand has let go, and compares with the hand.
    ///
    /// # Errors
    /// [`Fault::Unmet`] when the hand holds something else than the effect says.
    pub fn confirm(self, cell: &mut Workcell, call: &Call) -> Result<(), Fault> {
        let met = match self {
            Effect::BeamStands | Effect::BeamAtPlace => {
                let beam = call.beam(cell)?;
                cell.reckon_heights(beam);
                true
            }
            Effect::HoldsPart => holds_part(cell, call),
            Effect::HandEmpty => cell.hand.held.is_none(),
            Effect::BeamAligned | Effect::PegSeated => true,
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
        })
    }
}

fn holds_part(cell: &Workcell, call: &Call) -> bool {
    cell.hand.held.as_ref().is_some_and(|held| Some(held.part.as_str()) == call.part())
}

/// Carries out fine actions of some kinds. A table ([`crate::SkillTable`]) has one for each kind.
///
/// The executor calls [`Skill::ready`], [`Skill::run`], applies what the skill [`expects`](Skill::expects), and then
/// calls [`Skill::let_go`].
pub trait Skill: Send + Sync {
    /// Its name, as in the result of a run in which it replaces one of the baseline's.
    fn name(&self) -> &str;

    /// The kinds of actions that it carries out.
    fn serves(&self) -> &[ActionKind];

    /// What must hold before.
    fn needs(&self) -> &[Need] {
        &[]
    }

    /// What holds after, as the agent then believes.
    fn expects(&self) -> &[Effect];

    /// The tables of the parameter file that have its numbers: its own first, then those that it shares.
    fn parameters(&self) -> &[&'static str] {
        &[]
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
    /// What stopped the motion, or the robot's error.
    fn let_go(&self, _cell: &mut Workcell, _call: &Call) -> Result<(), SkillError> {
        Ok(())
    }
}
