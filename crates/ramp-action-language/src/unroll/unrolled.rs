//! The domain at the time that is reached: what may be true, what must be, and an atom for all between.

use super::candidate::Candidate;
use super::program::{GroundRule, Literal};
use crate::domain::Kind;
use crate::interpreter::{Binding, Ground, Model, Rule, State, Test, View};
use crate::term::Term;
use rustc_hash::FxHashMap as HashMap;
use std::collections::BTreeSet;

/// The literals of a fluent being true and of it being false. Of an inertial fluent they are two atoms, as in the
/// translation, of which just one is true; the laws may conclude either.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sides {
    pub(crate) yes: Literal,
    pub(crate) no: Literal,
}

/// A domain up to some time, as a ground program that grows by one step after another.
///
/// [`Unrolled::advance`] adds a step; [`Unrolled::take_rules`] hands the new rules to a solver; [`Unrolled::prospect`]
/// says what a goal needs at the time that is reached.
///
/// ```
/// use ramp_action_language::{Domain, Model, Prospect, SourceFile, Term, Unrolled};
///
/// let text = "sort lamp. inertial fluent on(lamp). action press(lamp). press(L) causes on(L) if -on(L).";
/// let domain = Domain::new(&SourceFile::new("lamp.al", text), None)?;
/// let lamp = Term::from("hall");
/// let model = Model::new(&domain, &[Term::new("lamp", [lamp.clone()])]);
/// let mut unrolled = Unrolled::new(&model, model.initial(&[], &[]).unwrap());
/// let on = Term::new("on", [lamp]);
/// assert!(matches!(unrolled.prospect(&on, true), Prospect::Never));
/// assert!(unrolled.advance());
/// assert!(matches!(unrolled.prospect(&on, true), Prospect::If(_)));
/// # Ok::<(), ramp_action_language::LanguageError>(())
/// ```
pub struct Unrolled<'m, 'd> {
    pub(crate) model: &'m Model<'d>,
    pub(crate) candidates: Vec<Candidate>,
    pub(crate) may: State,
    pub(crate) must: State,
    /// Of the fluents that may be true and need not.
    pub(crate) sides: HashMap<Ground, Sides>,
    /// Why a defined fluent is true at the time that is reached, and the literal that says so.
    pub(crate) grounds: HashMap<Ground, (BTreeSet<Vec<Literal>>, Literal)>,
    pub(crate) atoms: Literal,
    pub(crate) rules: Vec<GroundRule>,
    /// By time: what may be done to get there.
    pub(crate) choices: Vec<Vec<(Term, Literal)>>,
}

impl<'m, 'd> Unrolled<'m, 'd> {
    /// Time 0, where the state is known.
    pub fn new(model: &'m Model<'d>, start: State) -> Unrolled<'m, 'd> {
        Unrolled {
            model,
            candidates: Candidate::all(model, false),
            must: start.clone(),
            may: start,
            sides: HashMap::default(),
            grounds: HashMap::default(),
            atoms: 0,
            rules: Vec::new(),
            choices: Vec::new(),
        }
    }

    /// Number of atoms so far.
    pub fn atoms(&self) -> Literal {
        self.atoms
    }

    /// The rules since the last call.
    pub fn take_rules(&mut self) -> Vec<GroundRule> {
        std::mem::take(&mut self.rules)
    }

    /// By time: the actions that may lead there.
    pub fn choices(&self) -> &[Vec<(Term, Literal)>] {
        &self.choices
    }

    /// An atom that is true when one of some bodies is.
    pub fn either(&mut self, bodies: Vec<Vec<Literal>>) -> Literal {
        let head = self.atom();
        let rules = bodies.into_iter().map(|body| GroundRule { choice: false, head: Some(head), body });
        self.rules.extend(rules);
        head
    }

    /// A literal must be true.
    pub fn require(&mut self, literal: Literal) {
        self.forbid(vec![-literal]);
    }

    /// Not all of these are true.
    pub fn forbid(&mut self, body: Vec<Literal>) {
        self.rules.push(GroundRule { choice: false, head: None, body });
    }

    /// What may be true and what must be, at the time that is reached.
    pub(crate) fn view(&self) -> View<'_> {
        View { may: &self.may, must: &self.must }
    }

    /// A new atom.
    pub(crate) fn atom(&mut self) -> Literal {
        self.atoms += 1;
        self.atoms
    }

    /// Is a fluent true in a state?
    pub(crate) fn in_state(&self, fluent: &Ground, state: &State) -> bool {
        self.model.has(fluent.predicate, &fluent.row, state)
    }

    /// The literal of a fluent that is not certain.
    pub(crate) fn literal(&self, fluent: &Ground, truth: bool) -> Literal {
        // Every fluent that may be true and need not has its sides.
        self.sides.get(fluent).map_or(0, |sides| if truth { sides.yes } else { sides.no })
    }

    /// What a body asks of the fluents that are not certain.
    pub(crate) fn conditions(&self, rule: &Rule, binding: &Binding, view: View) -> Vec<(Ground, bool)> {
        let mut conditions = Vec::new();
        for test in &rule.conditions {
            let Test::Literal { positive, predicate, arguments } = test else { continue };
            if self.model.predicates[*predicate].kind == Kind::Static {
                continue;
            }
            let Some(row) = self.model.row(arguments, binding) else { continue };
            let fluent = Ground { predicate: *predicate, row };
            let certain = match positive {
                true => self.in_state(&fluent, view.must),
                false => !self.in_state(&fluent, view.may),
            };
            if !certain {
                conditions.push((fluent, *positive));
            }
        }
        conditions
    }

    /// Conditions as literals.
    pub(crate) fn body(&self, conditions: &[(Ground, bool)]) -> Vec<Literal> {
        let mut body: Vec<Literal> =
            conditions.iter().map(|(fluent, truth)| self.literal(fluent, *truth)).collect();
        body.sort_unstable();
        body.dedup();
        body
    }
}
