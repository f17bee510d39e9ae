//! Simulates plans and judges each action, at both resolutions.

use super::table::Replayer;
use super::terms::Check;
use crate::error::Refused;
use crate::facts;
use crate::plan::{CoarseAction, CoarseStep, Item};
use ramp_action_language::{Model, Refusal, State as Fluents, Term};
use std::collections::BTreeSet;

impl Replayer<'_> {
    /// Simulates a whole plan and checks that it reaches the goal.
    ///
    /// # Errors
    /// At the first impossible step, or the first with another effect than stated.
    pub fn run(&mut self, steps: &[CoarseStep]) -> Result<(), Refused> {
        self.expect_regrasps(steps.iter().map(|step| &step.coarse))?;
        for index in 0..steps.len() {
            self.step(&steps[index..], true).map_err(|why| Refused {
                step: index + 1,
                action: steps[index].coarse.to_string(),
                why,
            })?;
        }
        self.end(steps.len())
    }

    /// The same for coarse actions alone.
    ///
    /// # Errors
    /// As [`Replayer::run`].
    pub fn run_coarse(&mut self, actions: &[CoarseAction]) -> Result<(), Refused> {
        self.carry_out(actions)?;
        self.end(actions.len())
    }

    /// Simulates coarse actions that need not reach the goal: the beginning of a plan, up to an
    /// empty hand.
    ///
    /// # Errors
    /// At the first impossible action.
    pub fn carry_out(&mut self, actions: &[CoarseAction]) -> Result<(), Refused> {
        let steps: Vec<CoarseStep> =
            actions.iter().map(|coarse| CoarseStep { coarse: coarse.clone(), fine: Vec::new() }).collect();
        self.expect_regrasps(actions.iter())?;
        for index in 0..steps.len() {
            self.step(&steps[index..], false).map_err(|why| Refused {
                step: index + 1,
                action: steps[index].coarse.to_string(),
                why,
            })?;
        }
        Ok(())
    }

    /// A plan may regrasp any beam; the rules then check the consequences.
    fn expect_regrasps<'s>(
        &mut self,
        actions: impl Iterator<Item = &'s CoarseAction>,
    ) -> Result<(), Refused> {
        let beams: Vec<usize> = actions
            .filter_map(|action| match action {
                CoarseAction::Regrasp { beam } => self.planner.assembly.beam_index(beam),
                _ => None,
            })
            .collect();
        if self.planner.regrasp(&beams) {
            self.state = self.planner.fluents(&self.start).map_err(|error| Refused {
                step: 1,
                action: "the start".to_string(),
                why: error.to_string(),
            })?;
        }
        Ok(())
    }

    fn end(&self, steps: usize) -> Result<(), Refused> {
        let missing = self.planner.model.missing(&self.state);
        match missing.first() {
            None => Ok(()),
            Some((fluent, wanted)) => Err(Refused {
                step: steps + 1,
                action: "the end".to_string(),
                why: format!("{}{fluent} should hold", if *wanted { "" } else { "-" }),
            }),
        }
    }

    /// Simulates the first of some steps; the others determine for which connection a peg is
    /// fetched.
    pub(crate) fn step(&mut self, steps: &[CoarseStep], fine: bool) -> Check<()> {
        let Some(step) = steps.first() else { return Ok(()) };
        let rest = || steps[1..].iter().map(|step| &step.coarse);
        let action = self.coarse_term(&step.coarse, rest())?;
        self.geometry(&step.coarse)?;
        let before = self.state.clone();
        let after = self.planner.model.after(&before, &action).map_err(|refusal| words(&refusal))?;
        if fine {
            self.fine(step, &before, &after, rest())?;
        }
        match &step.coarse {
            CoarseAction::PickUp { item } => {
                if let Item::Peg(peg) = item {
                    let in_use =
                        self.pegs.iter().flatten().any(|used| used == peg) || self.lost.contains(peg);
                    if in_use || !self.planner.pegs.contains(peg) {
                        return Err(format!("{peg} is not available"));
                    }
                }
                self.hand = Some(item.clone());
            }
            CoarseAction::Fasten { connection, peg } => {
                if self.hand != Some(Item::Peg(peg.clone())) {
                    return Err(format!("{peg} is not in the hand"));
                }
                if let Some(index) = self.planner.assembly.connection_index(connection) {
                    self.pegs[index] = Some(peg.clone());
                }
                self.hand = None;
            }
            _ => {}
        }
        let full = self.planner.model.holds(&after, &Term::new("full", []));
        if !full {
            self.hand = None;
        }
        self.state = after;
        Ok(())
    }

    /// Checks that the placed beam has an insertion path.
    fn geometry(&self, action: &CoarseAction) -> Check<()> {
        let (beam, laid) = match action {
            CoarseAction::Assemble { beam } | CoarseAction::AssembleDeep { beam } => (beam, false),
            CoarseAction::LayDown { beam } => (beam, true),
            _ => return Ok(()),
        };
        let index =
            self.planner.assembly.beam_index(beam).ok_or_else(|| format!("there is no beam {beam}"))?;
        let (stands, _) = self.planner.standing(&self.state);
        match self.planner.geometry.way(index, &stands, laid) {
            Some(_) => Ok(()),
            None => Err(format!("no insertion path leads {beam} to its place")),
        }
    }

    fn fine<'s>(
        &mut self,
        step: &CoarseStep,
        before: &Fluents,
        after: &Fluents,
        rest: impl Iterator<Item = &'s CoarseAction> + Clone,
    ) -> Check<()> {
        let (planner, assembly) = (&self.planner, self.planner.assembly);
        let (stands, deep) = planner.standing(before);
        let pinned: Vec<bool> = self.pegs.iter().map(Option::is_some).collect();
        // All beams that the step can affect: those that it names, and those that they meet.
        let mut beams: BTreeSet<usize> = BTreeSet::new();
        let names = self.coarse_term(&step.coarse, rest.clone())?;
        beams.extend(names.texts().iter().filter_map(|text| assembly.beam_index(text)));
        let near: Vec<usize> =
            beams.iter().flat_map(|&beam| facts::partners(assembly, beam)).map(|(_, other)| other).collect();
        beams.extend(near);
        let beams: Vec<usize> = beams.into_iter().collect();
        let mut all = planner.facts.all.clone();
        all.extend(facts::fine(assembly, &planner.geometry, &beams, &|_| true, &stands, &pinned));
        let model = Model::new(planner.domains.fine(), &all);
        let mut told = planner.model.inertial(before);
        told.extend(self.own.iter().cloned());
        let not: Vec<Term> = Vec::new();
        let mut fluents = model.initial(&told, &not).map_err(|refusal| words(&refusal))?;
        for action in &step.fine {
            let term = self.fine_term(action, &stands, &deep, &step.coarse, rest.clone())?;
            fluents =
                model.after(&fluents, &term).map_err(|refusal| format!("{action}: {}", words(&refusal)))?;
        }
        // The effect of the fine actions must equal that of the coarse action.
        let reached = model.bridged(&fluents);
        let old: BTreeSet<Term> = planner.model.inertial(before).into_iter().collect();
        let new: BTreeSet<Term> = planner.model.inertial(after).into_iter().collect();
        for fluent in new.difference(&old) {
            let known = fluent.parts().is_some_and(|(name, _)| {
                planner.domains.fine().kind(name).is_some() || planner.domains.fine().bridges(name)
            });
            if known && !reached.contains(fluent) {
                return Err(format!("the fine actions do not make {fluent} true"));
            }
        }
        for fluent in &reached {
            let coarse =
                fluent.parts().is_some_and(|(name, _)| planner.domains.coarse().kind(name).is_some());
            // Only the coarse domain tracks an alignment that is lost as a side effect.
            let aligned = matches!(fluent.parts(), Some(("aligned", _)));
            if coarse && !aligned && !new.contains(fluent) {
                return Err(format!("the fine actions make {fluent} true, the coarse one does not"));
            }
        }
        let coarse = planner.domains.coarse();
        let own = model.inertial(&fluents);
        self.own = own
            .into_iter()
            .filter(|f| f.parts().is_some_and(|(name, _)| coarse.kind(name).is_none()))
            .collect();
        Ok(())
    }
}

/// A refusal as a sentence.
fn words(refusal: &Refusal) -> String {
    match refusal {
        Refusal::Unknown(name) => format!("there is no action {name}"),
        Refusal::Impossible(reason) => format!("impossible by line {}: {}", reason.line, reason.law),
        Refusal::Contradiction(fluent) => format!("{fluent} would be both true and false"),
    }
}
