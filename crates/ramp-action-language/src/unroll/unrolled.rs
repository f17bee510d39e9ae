//! The domain at the last time: upper and lower bound, and an atom for every fluent between them.

use super::candidate::Candidate;
use super::program::{GroundRule, Literal};
use crate::domain::Kind;
use crate::interpreter::{Binding, Ground, Model, Rule, State, Test, View};
use crate::term::Term;
use rustc_hash::FxHashMap as HashMap;
use std::collections::BTreeSet;

/// The literals of a fluent and of its negation. For an inertial fluent they are two atoms, as in
/// the translation, exactly one of which is true; the laws may conclude either.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sides {
    pub(crate) yes: Literal,
    pub(crate) no: Literal,
}

/// A domain up to some time, as a ground program that grows by one step after another.
///
/// [`Unrolled::advance`] adds a step; [`Unrolled::take_rules`] returns the new rules for a solver;
/// [`Unrolled::prospect`] evaluates a goal at the last time.
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
    /// The literals of the undecided fluents.
    pub(crate) sides: HashMap<Ground, Sides>,
    /// The grounds of each defined fluent at the last time, and its literal.
    pub(crate) grounds: HashMap<Ground, (BTreeSet<Vec<Literal>>, Literal)>,
    pub(crate) atoms: Literal,
    pub(crate) rules: Vec<GroundRule>,
    /// By time: the actions that may lead there.
    pub(crate) choices: Vec<Vec<(Term, Literal)>>,
}

impl<'m, 'd> Unrolled<'m, 'd> {
    /// Time 0, with the known state.
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

    /// An atom that is true when one of the bodies is.
    pub fn either(&mut self, bodies: Vec<Vec<Literal>>) -> Literal {
        let head = self.atom();
        let rules = bodies.into_iter().map(|body| GroundRule { choice: false, head: Some(head), body });
        self.rules.extend(rules);
        head
    }

    /// Requires that a literal is true.
    pub fn require(&mut self, literal: Literal) {
        self.forbid(vec![-literal]);
    }

    /// Forbids that all of these are true.
    pub fn forbid(&mut self, body: Vec<Literal>) {
        self.rules.push(GroundRule { choice: false, head: None, body });
    }

    /// The bounds at the last time.
    pub(crate) fn view(&self) -> View<'_> {
        View { may: &self.may, must: &self.must }
    }

    /// A new atom.
    pub(crate) fn atom(&mut self) -> Literal {
        self.atoms += 1;
        self.atoms
    }

    /// Whether a fluent is true in a state.
    pub(crate) fn in_state(&self, fluent: &Ground, state: &State) -> bool {
        self.model.has(fluent.predicate, &fluent.row, state)
    }

    /// The literal of an undecided fluent.
    pub(crate) fn literal(&self, fluent: &Ground, truth: bool) -> Literal {
        // Every undecided fluent has its literals.
        self.sides.get(fluent).map_or(0, |sides| if truth { sides.yes } else { sides.no })
    }

    /// The conditions of a body on undecided fluents.
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
