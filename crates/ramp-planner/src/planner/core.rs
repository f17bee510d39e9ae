//! The planner's common state: the goal, its geometry and facts, the coarse model, and solved
//! problems.

use super::fact_index::Facts;
use super::memo::{KnownAnswers, refusal_words};
use super::options::Options;
use super::shape::Sight;
use crate::domains::Domains;
use crate::error::PlanError;
use crate::facts::{self, beam_name};
use crate::geometry::Geometry;
use crate::limits::Watch;
use crate::motion::Motion;
use crate::solver::Solver;
use crate::state;
use ramp_action_language::{Model, Refusal, State as Fluents, Term};
use ramp_assembly::Assembly;
use std::collections::{BTreeSet, HashMap};

/// The planner's common state.
pub(crate) struct Planner<'a> {
    pub(crate) assembly: &'a Assembly,
    /// The names of the pegs.
    pub(crate) pegs: Vec<String>,
    pub(crate) domains: &'a Domains,
    pub(crate) geometry: Geometry<'a>,
    pub(crate) facts: Facts,
    pub(crate) model: Model<'a>,
    /// The beams by name.
    pub(crate) numbers: HashMap<String, usize>,
    /// The names and numbers visible to the laws. Names in laws, and those of paths, are part of
    /// every coarse problem.
    pub(crate) coarse_sight: Sight,
    pub(crate) fine_sight: Sight,
    /// The names of facts used by the fine rules.
    pub(crate) fine_facts: BTreeSet<&'a str>,
    pub(crate) solver: Solver,
    pub(crate) options: Options,
    /// Answers to problems of the same shape.
    pub(crate) coarse_answers: KnownAnswers,
    pub(crate) fine_answers: KnownAnswers,
    /// The first beam without a common grasp for its start and goal pose.
    pub(crate) ungrasped: Option<usize>,
    /// Lives as long as the planner.
    _watch: Option<Watch>,
}

/// A coarse action with the states around it.
#[derive(Clone)]
pub(crate) struct Transition {
    pub(crate) action: Term,
    pub(crate) before: Fluents,
    pub(crate) after: Fluents,
}

impl<'a> Planner<'a> {
    /// A planner for one goal with known motion facts; nothing is solved yet.
    pub(crate) fn new(
        assembly: &'a Assembly,
        domains: &'a Domains,
        options: Options,
        motion: Motion,
    ) -> Planner<'a> {
        let watch = domains.watch(options.optimal);
        let geometry = Geometry::new(assembly, motion);
        let facts = facts::coarse(assembly, &geometry);
        let model = Model::new(domains.coarse(), &facts);
        let facts = Facts::new(facts);
        let ways = (0..assembly.beams.len()).flat_map(|beam| geometry.paths.ways(beam));
        let coarse_sight = Sight::of(domains.coarse(), ways.map(|way| way.name.to_string()));
        let numbers =
            assembly.beams.iter().enumerate().map(|(index, placed)| (placed.beam.name.clone(), index));
        Planner {
            numbers: numbers.collect(),
            coarse_sight,
            fine_sight: Sight::of(domains.fine(), []),
            fine_facts: domains.fine().relevant_facts(),
            assembly,
            pegs: state::peg_names(assembly),
            domains,
            geometry,
            facts,
            model,
            solver: Solver::default(),
            options,
            coarse_answers: KnownAnswers::default(),
            fine_answers: KnownAnswers::default(),
            ungrasped: None,
            _watch: watch,
        }
    }

    /// Allows regrasps of further beams. Returns whether any is new.
    pub(crate) fn regrasp(&mut self, beams: &[usize]) -> bool {
        let mut facts = self.facts.all.clone();
        for &beam in beams {
            let fact = Term::new("awkward", [beam_name(self.assembly, beam)]);
            if !facts.contains(&fact) {
                facts.push(fact);
            }
        }
        if facts.len() == self.facts.all.len() {
            return false;
        }
        self.model = Model::new(self.domains.coarse(), &facts);
        self.facts = Facts::new(facts);
        true
    }

    /// The states along some actions, by the definition of the language.
    pub(crate) fn walk(&self, start: &Fluents, actions: &[Term]) -> Result<Vec<Transition>, PlanError> {
        let mut before = start.clone();
        let mut transitions = Vec::new();
        for action in actions {
            let after = self
                .model
                .after(&before, action)
                .map_err(|refusal| self.refused(refusal, &action.to_string()))?;
            transitions.push(Transition { action: action.clone(), before, after: after.clone() });
            before = after;
        }
        Ok(transitions)
    }

    /// The placed beams of a coarse state, and those of them that are pushed back.
    pub(crate) fn standing(&self, state: &Fluents) -> (Vec<bool>, Vec<bool>) {
        let beams = |fluent: &str| {
            let mut flags = vec![false; self.assembly.beams.len()];
            for term in self.model.true_of(state, fluent) {
                let index = term.texts().first().and_then(|name| self.numbers.get(*name));
                if let Some(flag) = index.and_then(|&index| flags.get_mut(index)) {
                    *flag = true;
                }
            }
            flags
        };
        (beams("in_assembly"), beams("deep"))
    }

    /// An error: no plan for a task of this rule file.
    pub(crate) fn no_plan(&self, file: &str, task: &str, steps: usize) -> PlanError {
        PlanError::NoPlan {
            goal: self.assembly.name.clone(),
            file: file.to_string(),
            task: task.to_string(),
            steps,
        }
    }

    /// An error: the interpreter refuses clingo's plan, or the given state.
    pub(crate) fn refused(&self, refusal: Refusal, what: &str) -> PlanError {
        let file = self.domains.coarse().file().name().to_string();
        PlanError::Refused { file, why: refusal_words(refusal, what) }
    }
}

/// The name of a fluent or an action.
pub(crate) fn name_of(fluent: &Term) -> Option<&str> {
    fluent.parts().map(|(name, _)| name)
}
