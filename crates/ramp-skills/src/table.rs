//! The table of skills: for each kind of fine action the skill that carries it out.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::cell::Workcell;
use crate::fault::SkillError;
use crate::parameters::Parameters;
use crate::skill::assemble::Assemble;
use crate::skill::cap::Cap;
use crate::skill::fasten::Fasten;
use crate::skill::lay_down::LayDown;
use crate::skill::move_to::MoveTo;
use crate::skill::pick_up::PickUp;
use crate::skill::pull_out::PullOut;
use crate::skill::push::Push;
use crate::skill::put_down::PutDown;
use crate::skill::regrasp::Regrasp;
use crate::skill::slide::Slide;
use crate::skill::slide_back::SlideBack;
use crate::skill::take_out::TakeOut;
use crate::skill::{ActionKind, Call, Need, Skill};

/// For each kind of fine action the skill that carries it out. Cheap to clone.
///
/// A skill of your own replaces those of the baseline for the actions that it serves:
///
/// ```
/// use ramp_skills::skill::{ActionKind, Call, Effect, Need, Skill};
/// use ramp_skills::cell::Workcell;
/// use ramp_skills::rehearsal::{Outline, Scene};
/// use ramp_skills::{SkillError, SkillTable};
///
/// /// Presses each peg in with 5 N, and trusts that it is seated.
/// struct GentlePress;
///
/// impl Skill for GentlePress {
///     fn name(&self) -> &str {
///         "gentle-press"
///     }
///     fn serves(&self) -> &[ActionKind] {
///         &[ActionKind::Fasten]
///     }
///     fn needs(&self) -> &[Need] {
///         &[Need::HoldsPart]
///     }
///     fn expects(&self) -> &[Effect] {
///         &[Effect::PegSeated, Effect::HandEmpty]
///     }
///     fn rehearse(&self, _: &Scene, _: &Call) -> Outline {
///         Outline::Unknown
///     }
///     fn run(&self, cell: &mut Workcell, _: &Call) -> Result<(), SkillError> {
///         cell.hand.zero()?;
///         let mut down = cell.hand.setpoint;
///         down.translation.z -= 0.05;
///         cell.hand.drive(&down, 0.01, |hand| -hand.force().z > 5.0)?;
///         cell.release()
///     }
/// }
///
/// let table = SkillTable::default().with(GentlePress);
/// assert_eq!(table.get(ActionKind::Fasten).map(|skill| skill.name()), Some("gentle-press"));
/// assert_eq!(table.replaced().collect::<Vec<_>>(), ["gentle-press"]);
/// ```
#[derive(Clone)]
pub struct SkillTable {
    skills: BTreeMap<ActionKind, Arc<dyn Skill>>,
    /// The kinds whose skill is not the baseline's.
    replaced: Vec<ActionKind>,
}

/// The skills of the baseline, with these numbers.
pub fn baseline(parameters: &Parameters) -> SkillTable {
    let assemble: Arc<dyn Skill> = Arc::new(Assemble::new(parameters));
    let skill = |kind: ActionKind| -> Arc<dyn Skill> {
        match kind {
            ActionKind::Move => Arc::new(MoveTo::new(parameters)),
            ActionKind::PickUp => Arc::new(PickUp::new(parameters)),
            ActionKind::PutDown => Arc::new(PutDown::new(parameters)),
            ActionKind::AssembleSquare
            | ActionKind::AssembleAngled
            | ActionKind::AssembleThrough
            | ActionKind::AssembleDeep => assemble.clone(),
            ActionKind::AssembleCap => Arc::new(Cap::new(parameters)),
            ActionKind::LayDown => Arc::new(LayDown::new(parameters)),
            ActionKind::Slide => Arc::new(Slide::new(parameters)),
            ActionKind::Regrasp => Arc::new(Regrasp::new(parameters)),
            ActionKind::Fasten => Arc::new(Fasten::new(parameters)),
            ActionKind::Push => Arc::new(Push::new(parameters)),
            ActionKind::TakeOut => Arc::new(TakeOut::new(parameters)),
            ActionKind::PullOut => Arc::new(PullOut::new(parameters)),
            ActionKind::SlideBack => Arc::new(SlideBack::new(parameters)),
        }
    };
    let skills = ActionKind::ALL.iter().map(|kind| (*kind, skill(*kind))).collect();
    SkillTable { skills, replaced: Vec::new() }
}

impl Default for SkillTable {
    fn default() -> SkillTable {
        baseline(&Parameters::baseline())
    }
}

impl SkillTable {
    /// Has `skill` carry out the kinds of actions that it serves, in place of whatever did.
    pub fn replace(&mut self, skill: impl Skill + 'static) {
        let skill: Arc<dyn Skill> = Arc::new(skill);
        self.replaced.extend(skill.serves());
        for kind in skill.serves() {
            self.skills.insert(*kind, skill.clone());
        }
    }

    /// As [`SkillTable::replace`], for a chain of calls.
    #[must_use]
    pub fn with(mut self, skill: impl Skill + 'static) -> SkillTable {
        self.replace(skill);
        self
    }

    /// The skill for a kind of action.
    pub fn get(&self, kind: ActionKind) -> Option<&dyn Skill> {
        self.skills.get(&kind).map(AsRef::as_ref)
    }

    /// All skills, each once, in the order of the first action that it serves.
    pub fn skills(&self) -> impl Iterator<Item = &dyn Skill> {
        let first = |(kind, skill): &(&ActionKind, &Arc<dyn Skill>)| {
            !self.skills.range(..*kind).any(|(_, other)| Arc::ptr_eq(other, skill))
        };
        self.skills.iter().filter(first).map(|(_, skill)| skill.as_ref())
    }

    /// The names of the skills that replace one of the baseline's, each once.
    pub fn replaced(&self) -> impl Iterator<Item = &str> {
        let replaced = |skill: &&dyn Skill| {
            skill.serves().iter().any(|kind| {
                self.replaced.contains(kind) && self.get(*kind).is_some_and(|own| own.name() == skill.name())
            })
        };
        self.skills().filter(replaced).map(Skill::name)
    }

    /// Carries out an action, from wherever the hand is.
    ///
    /// # Errors
    /// As [`SkillTable::perform`].
    pub fn execute(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        if self.get(call.kind()).is_some_and(|skill| skill.needs().contains(&Need::HandRaised)) {
            cell.retreat()?;
        }
        self.perform(cell, call)
    }

    /// Executes an action, with the hand where the skill needs it, and applies the effects that the skill
    /// expects.
    ///
    /// # Errors
    /// [`Fault::NoSkill`](crate::Fault::NoSkill), [`Fault::NotReady`](crate::Fault::NotReady),
    /// [`Fault::Unmet`](crate::Fault::Unmet), and the skill's own fault.
    pub fn perform(&self, cell: &mut Workcell, call: &Call) -> Result<(), SkillError> {
        let skill = self.get(call.kind()).ok_or_else(|| call.no_skill())?;
        skill.ready(cell, call)?;
        skill.run(cell, call)?;
        for effect in skill.expects() {
            effect.apply(cell, call)?;
        }
        skill.let_go(cell, call)?;
        for effect in skill.expects() {
            effect.confirm(cell, call)?;
        }
        Ok(())
    }
}
