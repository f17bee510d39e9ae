//! The third level: the fine actions under each coarse one.

use super::core::{Planner, Transition, name_of};
use super::memo::Found;
use super::shape::Shape;
use crate::answer::Answers;
use crate::error::PlanError;
use crate::facts;
use crate::pegs::Pegs;
use crate::plan::CoarseStep;
use crate::state::{Known, area_name};
use ramp_action_language::{FluentKind, Kind, Term};
use std::collections::BTreeSet;

/// Largest number of fine actions per coarse action; the rules never need more than four.
const MOST_FINE_STEPS: usize = 8;

/// The placed beams, those of them that are pushed back, and the pinned connections, by index.
struct Frame {
    stands: Vec<bool>,
    deep: Vec<bool>,
    pinned: Vec<bool>,
}

impl Planner<'_> {
    /// The coarse actions, each with the fine actions under it.
    pub(crate) fn steps(
        &mut self,
        transitions: &[Transition],
        known: &Known,
    ) -> Result<Vec<CoarseStep>, PlanError> {
        let above = Term::new("above", [area_name(known.area)]);
        let mut own = vec![Term::new("hand_at", [above])];
        let mut pegs = Pegs::new(self.assembly, known);
        let mut steps = Vec::new();
        let mut kept: Option<(&Transition, Frame)> = None;
        for transition in transitions {
            // Few of the actions change it.
            let same = |other: &Transition| {
                self.model.agree(&other.before, &transition.before, ["in_assembly", "deep", "pinned"])
            };
            let frame = match kept.take() {
                Some((other, frame)) if same(other) => (other, frame),
                _ => (transition, self.frame(transition)),
            };
            let actions =
                if self.options.fine { self.refine(transition, &frame.1, &mut own)? } else { Vec::new() };
            let answers =
                Answers { assembly: self.assembly, pegs: &self.pegs, rules: self.domains.fine().file() };
            let Frame { stands, deep, .. } = &frame.1;
            let coarse = answers.coarse_action(&transition.action, &mut pegs)?;
            let fine = actions.iter().map(|term| answers.fine_action(term, stands, deep, &mut pegs));
            steps.push(CoarseStep { coarse, fine: fine.collect::<Result<_, _>>()? });
            kept = Some(frame);
        }
        Ok(steps)
    }

    /// Placed beams and pinned connections before a transition.
    fn frame(&self, transition: &Transition) -> Frame {
        let (stands, deep) = self.standing(&transition.before);
        let pins = self.model.true_of(&transition.before, "pinned");
        let pins: BTreeSet<&str> = pins.iter().flat_map(Term::texts).collect();
        let connections = self.assembly.connections.iter();
        let pinned = connections.map(|connection| pins.contains(connection.name.as_str())).collect();
        Frame { stands, deep, pinned }
    }

    /// The fine actions for one coarse action. `own`: the fine fluents without a coarse
    /// counterpart, before and then after it.
    fn refine(
        &mut self,
        transition: &Transition,
        frame: &Frame,
        own: &mut Vec<Term>,
    ) -> Result<Vec<Term>, PlanError> {
        let fine = self.domains.fine();
        let mut names = self.model.relevant(&transition.before, &transition.action, &transition.after);
        for fluent in own.iter().filter(|fluent| matches!(fluent.parts(), Some(("hand_at", _)))) {
            names.extend(fluent.texts().into_iter().map(str::to_string));
        }
        let all = 0..self.assembly.beams.len();
        let zoom = self.options.zoom;
        let beams: Vec<usize> =
            all.filter(|&beam| !zoom || names.contains(&self.assembly.beams[beam].beam.name)).collect();
        let named = transition.action.texts();
        // The grasp of a beam is relevant until the beam is placed.
        let gained = self.model.gained(&transition.before, &transition.after);
        let placed: BTreeSet<&str> = gained
            .iter()
            .filter(|fluent| name_of(fluent) == Some("in_assembly"))
            .flat_map(Term::texts)
            .collect();
        let handled = |beam: usize| {
            let name = self.assembly.beams[beam].beam.name.as_str();
            !zoom || named.contains(&name) && !placed.contains(name)
        };
        let facts =
            facts::fine(self.assembly, &self.geometry, &beams, &handled, &frame.stands, &frame.pinned);
        // Parts of a relevant object are relevant.
        for fact in &facts {
            if let Some(("component", [part, whole])) = fact.parts()
                && whole.texts().iter().all(|text| names.contains(*text))
            {
                names.extend(part.texts().into_iter().map(str::to_string));
            }
        }
        let matters = |term: &Term| !zoom || term.texts().into_iter().all(|text| names.contains(text));
        let names = zoom.then_some(&names);
        let asked = |fact: &&Term| name_of(fact).is_some_and(|name| self.fine_facts.contains(name));
        let mut problem: Vec<Term> = self.facts.about(names).filter(asked).cloned().collect();
        problem.extend(facts.into_iter().filter(matters));
        let before = self.model.inertial_about(&transition.before, names);
        let shared =
            before.iter().filter(|fluent| name_of(fluent).is_some_and(|name| fine.kind(name).is_some()));
        let told = shared.chain(own.iter().filter(|fluent| matters(fluent)));
        problem.extend(told.map(|fluent| Term::new("told", [fluent.clone()])));
        // The coarse fluents that become true and are known to the fine domain.
        for fluent in gained.iter().cloned() {
            let Some(name) = name_of(&fluent) else { continue };
            if fine.kind(name) == Some(Kind::Fluent(FluentKind::Inertial)) {
                problem.push(Term::new("goal", [fluent]));
            } else if fine.bridges(name) {
                problem.push(Term::new("goal", [Term::new("coarse", [fluent])]));
            }
        }
        let shape = Shape::of(&problem, &self.fine_sight);
        let found = self.fine_answers.shortest(&mut self.solver, fine, &shape, MOST_FINE_STEPS)?;
        let Some(Found { actions, mut end }) = found else { return Err(self.no_fine_plan(transition)) };
        // The next action begins at the hand's final place. Omitted fluents persist, unless one
        // with the same name replaces them: the hand has one place.
        end.retain(|fluent| name_of(fluent).is_some_and(|name| self.domains.coarse().kind(name).is_none()));
        end.sort();
        let names: BTreeSet<&str> = end.iter().filter_map(name_of).collect();
        own.retain(|fluent| !matters(fluent) && !name_of(fluent).is_some_and(|name| names.contains(name)));
        drop(names);
        own.extend(end);
        Ok(actions)
    }

    fn no_fine_plan(&mut self, transition: &Transition) -> PlanError {
        let texts = transition.action.texts();
        let beam = texts.iter().find(|text| self.assembly.beam_index(text).is_some());
        if let (Some(("pick_up", _)), Some(beam)) = (transition.action.parts(), beam) {
            self.ungrasped = self.ungrasped.or(self.assembly.beam_index(beam));
        }
        match (transition.action.parts(), beam) {
            (Some(("pick_up", _)), Some(beam)) => PlanError::Illegal {
                goal: self.assembly.name.clone(),
                why: format!(
                    "{beam} has no link that the hand can grasp both at its start and at its goal pose"
                ),
                beams: vec![beam.to_string()],
            },
            (Some(("push" | "slide", _)), Some(beam)) => PlanError::Illegal {
                goal: self.assembly.name.clone(),
                why: format!("{beam} has no link that the hand can push it by"),
                beams: vec![beam.to_string()],
            },
            _ => self.no_plan(
                self.domains.fine().file().name(),
                &transition.action.to_string(),
                MOST_FINE_STEPS,
            ),
        }
    }
}
