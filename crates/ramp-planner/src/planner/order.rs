//! The first level: the order of the beams, by the rules of `order.lp`.

use super::core::Planner;
use crate::answer::{Answers, meaningless};
use crate::error::PlanError;
use crate::facts::beam_name;
use crate::solver::SolveError;
use crate::state::Known;
use ramp_action_language::Term;
use std::collections::BTreeSet;

/// An answer of the first level.
#[derive(Clone, Debug, Default)]
pub(crate) struct Order {
    /// The remaining beams, in the order of placement.
    pub(crate) sequence: Vec<usize>,
    /// Pairs of beams, the first placed before the second.
    pub(crate) before: Vec<(usize, usize)>,
    /// Beams that are pushed back at first.
    pub(crate) deep: Vec<usize>,
}

impl Planner<'_> {
    /// An order that the rules allow and that was not refused.
    pub(crate) fn order(&mut self, known: &Known, refused: &[Order]) -> Result<Order, PlanError> {
        let rules = self.domains.order();
        let name = |beam: usize| beam_name(self.assembly, beam);
        let mut facts = self.facts.all.clone();
        let paths = &self.assembly.paths;
        for beam in (0..self.assembly.beams.len()).filter(|&beam| !known.stands[beam]) {
            for (number, way) in paths.ways(beam).iter().enumerate() {
                facts.extend(paths.blocked_together(beam, number).into_iter().map(|[first, second]| {
                    Term::new("blocked", [name(beam), way.name.into(), name(first), name(second)])
                }));
            }
        }
        for (rank, insertion) in self.assembly.insertions.iter().enumerate() {
            facts.push(Term::new("proven", [name(insertion.beam), rank.into()]));
        }
        for beam in (0..self.assembly.beams.len()).filter(|&beam| known.stands[beam]) {
            facts.push(Term::new("placed", [name(beam)]));
            if known.deep[beam] {
                facts.push(Term::new("is_deep", [name(beam)]));
            }
        }
        for (number, order) in refused.iter().enumerate() {
            facts.push(Term::new("refused", [number.into()]));
            let pairs = order.before.iter();
            facts.extend(pairs.map(|&(a, b)| Term::new("refused", [number.into(), name(a), name(b)])));
            let deep = order.deep.iter();
            facts.extend(deep.map(|&beam| Term::new("refused_deep", [number.into(), name(beam)])));
        }
        let solved = match self.solver.best(rules, &facts) {
            // The goal's own order is proven to work for the beams alone.
            Err(SolveError::Limit { .. }) if refused.is_empty() => return Ok(self.proven(known)),
            other => other.map_err(|error| PlanError::solver(rules, &error))?,
        };
        let answer = solved.ok_or_else(|| PlanError::NoOrder { goal: self.assembly.name.clone() })?;
        let answers = Answers { assembly: self.assembly, pegs: &self.pegs, rules };

        let mut order = Order::default();
        let mut problems = Vec::new();
        for term in &answer {
            match term.parts() {
                Some(("before", [first, second])) => {
                    order.before.push((answers.beam(first)?, answers.beam(second)?));
                }
                Some(("deep", [beam])) => {
                    let beam = answers.beam(beam)?;
                    if !known.stands[beam] {
                        order.deep.push(beam);
                    }
                }
                Some(("laid", [_])) => {}
                Some(("problem", [words])) => problems.push(words),
                _ => return Err(meaningless(rules, term)),
            }
        }
        problems.sort();
        if let Some(words) = problems.first() {
            return Err(self.illegal(words));
        }
        // Repeatedly, the first beam of the proven order that waits for no other.
        let mut waits = vec![0usize; self.assembly.beams.len()];
        let mut after: Vec<Vec<usize>> = vec![Vec::new(); self.assembly.beams.len()];
        for &(first, second) in &order.before {
            if !known.stands[first] {
                waits[second] += 1;
                after[first].push(second);
            }
        }
        let mut rank = vec![usize::MAX; self.assembly.beams.len()];
        for (position, insertion) in self.assembly.insertions.iter().enumerate() {
            rank[insertion.beam] = position;
        }
        let mut ready: BTreeSet<(usize, usize)> = (0..waits.len())
            .filter(|&beam| !known.stands[beam] && waits[beam] == 0)
            .map(|beam| (rank[beam], beam))
            .collect();
        while let Some((_, next)) = ready.pop_first() {
            order.sequence.push(next);
            for &beam in &after[next] {
                waits[beam] -= 1;
                if waits[beam] == 0 {
                    ready.insert((rank[beam], beam));
                }
            }
        }
        if order.sequence.len() < known.stands.iter().filter(|stands| !**stands).count() {
            return Err(PlanError::NoOrder { goal: self.assembly.name.clone() });
        }
        Ok(order)
    }

    /// The goal's own order, for the remaining beams.
    fn proven(&self, known: &Known) -> Order {
        let proven = self.assembly.insertions.iter().map(|insertion| insertion.beam);
        let sequence: Vec<usize> = proven.filter(|&beam| !known.stands[beam]).collect();
        let before = sequence.windows(2).map(|pair| (pair[0], pair[1])).collect();
        Order { sequence, before, deep: Vec::new() }
    }

    /// A problem reported by the rules, as an error.
    fn illegal(&self, words: &Term) -> PlanError {
        let texts = words.texts();
        let is_beam = |text: &&&str| self.assembly.beam_index(text).is_some();
        let mut beams: Vec<String> = texts.iter().filter(is_beam).map(|text| text.to_string()).collect();
        beams.dedup();
        PlanError::Illegal { goal: self.assembly.name.clone(), why: texts.join(" "), beams }
    }
}
