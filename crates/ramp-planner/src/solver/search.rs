//! Searches: the best answer of some rules, and the shortest plan of an unrolled domain.

use super::control::{add, alone, last_answer, literal, load, new_control, shown};
use super::error::SolveError;
use clingo::{Atom, ClingoError, Control, Model, Part, SolveMode, SolveResult, SolverLiteral};
use ramp_action_language::{Prospect, Term, Unrolled};
use ramp_source::SourceFile;

/// Runs programs and counts the calls.
#[derive(Debug, Default)]
pub(crate) struct Solver {
    /// Calls so far.
    pub(crate) solves: usize,
    /// Higher limits, for proofs.
    pub(crate) thorough: bool,
}

impl Solver {
    /// The best answer of the part `base` of the rules with some facts; `None` without an answer.
    pub(crate) fn best(
        &mut self,
        rules: &SourceFile,
        facts: &[Term],
    ) -> Result<Option<Vec<Term>>, SolveError> {
        let _alone = alone();
        let mut control = load(rules, facts)?;
        control.ground(&[Part::new("base", vec![])?])?;
        Ok(self.solve(control, 0, &[], shown)?.1)
    }

    /// The shortest plan, of `least` to `most` actions, that makes some fluents true or false;
    /// `None` when there is none.
    pub(crate) fn shortest(
        &mut self,
        unrolled: &mut Unrolled,
        goals: &[(Term, bool)],
        [least, most]: [usize; 2],
    ) -> Result<Option<Vec<Term>>, SolveError> {
        let _alone = alone();
        let mut control: Option<Control> = None;
        let mut atoms: Vec<Atom> = Vec::new();
        for steps in 0..=most {
            if steps > 0 && !unrolled.advance() {
                return Ok(None);
            }
            let mut wanted = Vec::new();
            let mut hopeless = steps < least;
            for (fluent, truth) in goals {
                match unrolled.prospect(fluent, *truth) {
                    Prospect::Certain => {}
                    Prospect::Never => hopeless = true,
                    Prospect::If(literal) => wanted.push(literal),
                }
            }
            if hopeless {
                continue;
            }
            let mut now = match control.take() {
                Some(control) => control,
                None => new_control(self.thorough)?,
            };
            add(&mut now, &mut atoms, unrolled)?;
            let assumed: Vec<SolverLiteral> = wanted.iter().map(|&wanted| literal(&atoms, wanted)).collect();
            let read = |model: &Model| {
                let mut actions = Vec::new();
                for (action, occurs) in unrolled.choices().iter().flatten() {
                    if model.is_true(literal(&atoms, *occurs))? {
                        actions.push(action.clone());
                    }
                }
                Ok(actions)
            };
            let (back, answer) = self.solve(now, steps, &assumed, read)?;
            if answer.is_some() {
                return Ok(answer);
            }
            control = Some(back);
        }
        Ok(None)
    }

    /// Solves once; returns the control, and the last and so the best answer.
    pub(crate) fn solve<T>(
        &mut self,
        control: Control,
        steps: usize,
        assumed: &[SolverLiteral],
        read: impl Fn(&Model) -> Result<T, ClingoError>,
    ) -> Result<(Control, Option<T>), SolveError> {
        self.solves += 1;
        let mut handle = control.solve(SolveMode::YIELD, assumed)?;
        let outcome = last_answer(&mut handle, read);
        // Closed first, also after a failure: the search works on the control.
        let control = handle.close()?;
        let (result, answer) = outcome?;
        let decided = SolveResult::SATISFIABLE | SolveResult::UNSATISFIABLE;
        if result.contains(SolveResult::INTERRUPTED) || !result.intersects(decided) {
            return Err(SolveError::Limit { steps });
        }
        Ok((control, answer))
    }
}

/// The number of steps of the shortest plan of a program in the parts of clingo's incremental mode,
/// grounded by clingo itself.
#[cfg(test)]
pub(crate) fn shortest_by_clingo(program: &str, most: i32) -> Option<usize> {
    let _alone = alone();
    let mut control = new_control(false).unwrap();
    control.add("base", &[], program).unwrap();
    for name in ["step", "check"] {
        control.add(name, &["t"], "").unwrap();
    }
    for steps in 0..=most {
        let time = || vec![clingo::Symbol::create_number(steps)];
        let first = if steps == 0 { Part::new("base", vec![]) } else { Part::new("step", time()) };
        control.ground(&[first.unwrap(), Part::new("check", time()).unwrap()]).unwrap();
        let signature = clingo::Signature::new("query", 1, true).unwrap();
        let atoms = control.symbolic_atoms().unwrap();
        let queries: Vec<(String, SolverLiteral)> = atoms
            .iter_with_signature(signature)
            .unwrap()
            .map(|atom| (atom.symbol().unwrap().to_string(), atom.literal().unwrap()))
            .collect();
        for (query, literal) in queries {
            let now = query == format!("query({steps})");
            let value = if now { clingo::TruthValue::True } else { clingo::TruthValue::False };
            control.assign_external(literal, value).unwrap();
        }
        let (back, answer) = Solver::default().solve(control, 0, &[], shown).unwrap();
        if let Some(shown) = answer {
            assert_eq!(shown.len(), usize::try_from(steps).unwrap());
            return Some(shown.len());
        }
        control = back;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(rules: &str, facts: &[Term]) -> Result<Option<Vec<Term>>, SolveError> {
        let file = SourceFile::new("test.lp", rules);
        crate::solver::check(&file).unwrap();
        Solver::default().best(&file, facts)
    }

    #[test]
    fn the_best_answer_is_the_cheapest() {
        let rules = "{ a(X) : n(X) } = 1. #minimize { X : a(X) }. #show a/1.";
        let numbers: Vec<Term> = [7, 3, 5].map(|number: usize| Term::new("n", [number.into()])).into();
        assert_eq!(shown(rules, &numbers).unwrap(), Some(vec![Term::new("a", [3.into()])]));
        assert_eq!(shown("a. :- a.", &[]).unwrap(), None);
    }

    #[test]
    fn a_search_without_an_end_gives_up() {
        // One more pigeon than holes.
        let rules = "{ in(P,H) : H = 1..12 } = 1 :- P = 1..13. :- in(P,H), in(Q,H), P < Q.";
        assert!(matches!(shown(rules, &[]), Err(SolveError::Limit { .. })));
    }
}
