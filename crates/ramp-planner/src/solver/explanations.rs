//! The smallest sets of events that are consistent with a program.

use super::control::{add, alone, literal, new_control};
use super::error::SolveError;
use super::search::Solver;
use clingo::{Atom, Control, Model, SolverLiteral};
use ramp_action_language::{Literal, Term, Unrolled};
use std::collections::BTreeMap;

/// Largest number of returned explanations of one size.
const MOST_EXPLANATIONS: usize = 16;

/// An event that may have happened.
pub(crate) struct Happening {
    pub event: Term,
    /// Index of the action in the history before which it happened; for an action without effect,
    /// that action.
    pub before: usize,
    pub literal: Literal,
}

impl Solver {
    /// The smallest sets of events, by index, that may be true together with the program; at most
    /// `most` at once.
    pub(crate) fn explanations(
        &mut self,
        unrolled: &mut Unrolled,
        happenings: &[Happening],
        most: usize,
    ) -> Result<Vec<Vec<usize>>, SolveError> {
        let _alone = alone();
        // `more[n]`: more than n of the events so far are true.
        let mut more: Vec<Literal> = Vec::new();
        for happening in happenings {
            let before = more.clone();
            more = (0..=most)
                .map(|count| {
                    let mut bodies: Vec<Vec<Literal>> =
                        before.get(count).map(|&had| vec![had]).into_iter().collect();
                    match count.checked_sub(1).map(|less| before.get(less)) {
                        None => bodies.push(vec![happening.literal]),
                        Some(Some(&less)) => bodies.push(vec![happening.literal, less]),
                        Some(None) => {}
                    }
                    unrolled.either(bodies)
                })
                .collect();
        }
        // Grouped by the event, whatever its time: explanations differ in their events.
        let mut names: BTreeMap<&Term, Vec<usize>> = BTreeMap::new();
        for (index, happening) in happenings.iter().enumerate() {
            names.entry(&happening.event).or_default().push(index);
        }
        let any: BTreeMap<&Term, Literal> = names
            .iter()
            .map(|(name, all)| {
                let bodies = all.iter().map(|&index| vec![happenings[index].literal]).collect();
                (*name, unrolled.either(bodies))
            })
            .collect();
        let mut atoms: Vec<Atom> = Vec::new();
        let mut control = new_control(false)?;
        let mut found: Vec<Vec<usize>> = Vec::new();
        for count in 0..=most {
            let few: Vec<Literal> = more.get(count).map(|&more| -more).into_iter().collect();
            while found.len() < MOST_EXPLANATIONS {
                let (back, answer) = self.happened(control, &mut atoms, unrolled, happenings, &few)?;
                control = back;
                let Some(mut set) = answer else { break };
                // As late as possible: an earlier event would have been noticed earlier.
                for place in 0..set.len() {
                    let same = &names[&happenings[set[place]].event];
                    for &later in same.iter().rev().take_while(|&&later| later > set[place]) {
                        let mut wanted = few.clone();
                        let others = set.iter().enumerate().filter(|(other, _)| *other != place);
                        wanted.extend(others.map(|(_, &index)| happenings[index].literal));
                        wanted.push(happenings[later].literal);
                        let (back, answer) =
                            self.happened(control, &mut atoms, unrolled, happenings, &wanted)?;
                        control = back;
                        if answer.is_some() {
                            set[place] = later;
                            break;
                        }
                    }
                }
                unrolled.forbid(set.iter().map(|&index| any[&happenings[index].event]).collect());
                let nothing = set.is_empty();
                found.push(set);
                if nothing {
                    return Ok(found);
                }
            }
            if !found.is_empty() {
                break;
            }
        }
        Ok(found)
    }

    /// The true events of an answer.
    fn happened(
        &mut self,
        mut control: Control,
        atoms: &mut Vec<Atom>,
        unrolled: &mut Unrolled,
        happenings: &[Happening],
        wanted: &[Literal],
    ) -> Result<(Control, Option<Vec<usize>>), SolveError> {
        add(&mut control, atoms, unrolled)?;
        let assumed: Vec<SolverLiteral> = wanted.iter().map(|&wanted| literal(atoms, wanted)).collect();
        let read = |model: &Model| {
            let mut set = Vec::new();
            for (index, happening) in happenings.iter().enumerate() {
                if model.is_true(literal(atoms, happening.literal))? {
                    set.push(index);
                }
            }
            Ok(set)
        };
        self.solve(control, 0, &assumed, read)
    }
}
