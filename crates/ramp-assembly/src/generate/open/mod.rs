//! Sets of the open class: 60 goals from a seed, 20 of each size.
//!
//! A set is drawn goal by goal. Each place of the set asks for a number of beams and for a form. For each
//! place the seed draws several candidates, which are generated like any other goal. A candidate that is a
//! copy of a known goal or of an earlier one of the set, up to symmetry (`outline`), is dropped. Of the
//! others, the one comes first whose joints and angles the set has used least. The caller decides
//! whether a goal can be planned and built.

mod features;
mod outline;

pub use self::features::Features;

use self::outline::Outline;
use super::dice::Dice;
use super::draft::Draft;
use super::request::{GenerateError, Generated};
use crate::assembly::{Assembly, Class, Size};
use ramp_kit::Kit;
use std::collections::{BTreeMap, BTreeSet};

/// Goals of each size in a set.
pub const OF_EACH_SIZE: usize = 20;
/// Largest number of candidates from which one is chosen for a place.
const CANDIDATES: usize = 6;
/// Drafts among which candidates are found. If none of them will do, as many others follow.
const DRAFTS: usize = 4_000;
/// Number of further rounds of drafts before a form is given up.
const ROUNDS: usize = 4;

/// The demand of a place of a set. The places of a size take them in turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Form {
    /// Every beam along X or Y, and none passes through another.
    Square,
    /// Every beam along X or Y, and at least one passes through another.
    Through,
    /// At least one oblique beam, and none passes through another.
    Oblique,
    /// At least one oblique beam, and at least one that passes through another.
    Both,
}

impl Form {
    const ALL: [Form; 4] = [Form::Square, Form::Through, Form::Oblique, Form::Both];

    /// The forms of goals of so many beams. The kit gives no goals, or very few, of the others.
    fn of_beams(beams: usize) -> &'static [Form] {
        match beams {
            ..=3 => &[Form::Square, Form::Through],
            4 | 5 => &Form::ALL,
            6 => &[Form::Square, Form::Through, Form::Both],
            _ => &[Form::Through],
        }
    }

    /// The form of a goal with these features.
    fn of(features: &Features) -> Form {
        match (features.through > 0, features.oblique > 0) {
            (false, false) => Form::Square,
            (true, false) => Form::Through,
            (false, true) => Form::Oblique,
            (true, true) => Form::Both,
        }
    }
}

/// A goal of a set.
#[derive(Clone, Debug)]
pub struct OpenGoal {
    /// The goal.
    pub goal: Generated,
    /// Its size.
    pub size: Size,
    /// Its features.
    pub features: Features,
}

/// Draws the goals of a set, one after another.
pub struct OpenGoals<'a> {
    kit: &'a Kit,
    base: usize,
    class: Class,
    dice: Dice,
    /// The goals of which none may be a copy.
    taken: Vec<Outline>,
    /// Uses of each joint of the kit and of each angle in the set so far.
    uses: BTreeMap<String, usize>,
    /// Numbers of beams and forms of which the seed gives no other goals.
    given_up: BTreeSet<(usize, Form)>,
    /// Number of goals so far.
    drawn: usize,
}

impl<'a> OpenGoals<'a> {
    /// The set `class` from `seed`, without copies of the `known` goals.
    ///
    /// # Errors
    /// If the kit has no clamped beam.
    pub fn new(
        kit: &'a Kit,
        class: Class,
        seed: u64,
        known: &[Assembly],
    ) -> Result<OpenGoals<'a>, GenerateError> {
        Ok(OpenGoals {
            kit,
            base: super::clamped(kit)?,
            class,
            dice: Dice::new(seed),
            taken: known.iter().map(Outline::of).collect(),
            uses: BTreeMap::new(),
            given_up: BTreeSet::new(),
            drawn: 0,
        })
    }

    /// Number of goals in a set.
    pub const COUNT: usize = Size::ALL.len() * OF_EACH_SIZE;

    /// The next goal that `passes`; `None` after the last one.
    ///
    /// # Errors
    /// If the kit gives none.
    pub fn next_goal(
        &mut self,
        passes: &mut dyn FnMut(&Assembly) -> bool,
    ) -> Result<Option<OpenGoal>, GenerateError> {
        let Some(&size) = Size::ALL.get(self.drawn / OF_EACH_SIZE) else { return Ok(None) };
        let place = self.drawn % OF_EACH_SIZE;
        let beams = size.beams()[place % size.beams().len()];
        let name = format!("{}-{}-{:02}", self.class, size.name(), place + 1);
        let forms = Form::of_beams(beams);
        // A place whose form is given up takes the next one.
        for form in (0..forms.len()).map(|next| forms[(place / 2 + next) % forms.len()]) {
            if let Some(goal) = self.search(beams, form, &name, passes) {
                self.take(&goal.assembly);
                let features = Features::of(&goal.assembly);
                return Ok(Some(OpenGoal { goal, size, features }));
            }
        }
        Err(GenerateError::NoOpenGoal { beams, size: size.name() })
    }

    /// A goal of this form that passes; `None`, for the rest of the set, when none was found.
    fn search(
        &mut self,
        beams: usize,
        form: Form,
        name: &str,
        passes: &mut dyn FnMut(&Assembly) -> bool,
    ) -> Option<Generated> {
        // A kit of fewer beams has no such goal.
        if beams > self.kit.beams.len() || self.given_up.contains(&(beams, form)) {
            return None;
        }
        for _ in 0..ROUNDS {
            let mut candidates = self.candidates(beams, form, name);
            candidates.sort_by_cached_key(|it| self.wear(&it.assembly));
            let found = candidates.into_iter().find(|it| passes(&it.assembly));
            if found.is_some() {
                return found;
            }
        }
        self.given_up.insert((beams, form));
        None
    }

    /// Goals of this form that are no copies.
    fn candidates(&mut self, beams: usize, form: Form, name: &str) -> Vec<Generated> {
        let class = (form == Form::Square).then_some(Class::Easy);
        let mut found = Vec::new();
        for _ in 0..DRAFTS {
            if found.len() == CANDIDATES {
                break;
            }
            let Some(draft) = Draft::grow(self.kit, self.base, beams, class, &mut self.dice) else {
                continue;
            };
            if (form == Form::Square) != (draft.specials() == 0)
                || (!self.kit.pegs.is_empty() && draft.pairs.len() > self.kit.pegs.len())
            {
                continue;
            }
            let Some(goal) = draft.finish(self.kit, name, self.class) else { continue };
            let outline = Outline::of(&goal.assembly);
            let is_copy = self.taken.iter().any(|known| known.is_copy(&outline));
            if !is_copy && Form::of(&Features::of(&goal.assembly)) == form {
                found.push(goal);
            }
        }
        found
    }

    /// Mean use in the set so far of the joints and angles of a goal, in thousandths.
    fn wear(&self, assembly: &Assembly) -> usize {
        let parts = features::parts(assembly);
        let sum: usize = parts.iter().map(|part| self.uses.get(part).copied().unwrap_or(0)).sum();
        1000 * sum / parts.len().max(1)
    }

    /// Adds a goal to the set.
    fn take(&mut self, assembly: &Assembly) {
        self.drawn += 1;
        self.taken.push(Outline::of(assembly));
        for part in features::parts(assembly) {
            *self.uses.entry(part).or_default() += 1;
        }
    }
}
