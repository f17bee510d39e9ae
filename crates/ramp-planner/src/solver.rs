//! clingo, behind three calls: check a rule file, find its best answer, find its shortest plan.
//!
//! Everything is deterministic: one thread, a fixed seed, and limits counted in conflicts instead of seconds.

use crate::domains::OrderProblem;
use crate::term::Term;
use clingo::{
    ClingoError, Control, ControlCtx, ExternalError, FunctionHandler, GenericControl, GroundProgramObserver,
    Logger, Part, Propagator, ShowType, Signature, SolveHandle, SolveMode, SolveResult, SolverLiteral,
    Symbol, SymbolType, TruthValue, Warning,
};
use ramp_kit::source::{Fault, SourceFile};
use std::cell::RefCell;

/// Conflicts after which one call gives up: a few seconds of work.
const CONFLICT_LIMIT: u32 = 200_000;

/// Why a call came to no end.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SolveError {
    /// clingo reports an error.
    #[error("{0}")]
    Clingo(String),
    /// The search reached [`CONFLICT_LIMIT`].
    #[error("the search gave up after {CONFLICT_LIMIT} conflicts")]
    Limit,
}

impl From<ClingoError> for SolveError {
    fn from(error: ClingoError) -> SolveError {
        // The error borrows a buffer that clingo writes to again.
        SolveError::Clingo(error.to_string())
    }
}

/// Runs programs and counts how often.
#[derive(Debug, Default)]
pub(crate) struct Solver {
    /// Calls so far.
    pub(crate) solves: usize,
}

/// The shortest plan of a program.
#[derive(Clone, Debug)]
pub(crate) struct Shortest {
    /// How many steps it has.
    pub(crate) steps: i32,
    /// What the program shows.
    pub(crate) shown: Vec<Term>,
}

impl Solver {
    /// The best answer of the part `base` of the rules with some facts; `None` when there is no answer.
    pub(crate) fn best(
        &mut self,
        rules: &SourceFile,
        facts: &[Term],
    ) -> Result<Option<Vec<Term>>, SolveError> {
        let mut control = load(rules, facts)?;
        control.ground(&[Part::new("base", vec![])?])?;
        Ok(self.solve(control)?.1)
    }

    /// The shortest plan: the parts `base`, `state(0)`, then `step(t)` and `state(t)` for t = 1, 2, … until there is
    /// an answer in which `query(t)` is true; `None` when there is none from `least` to `most` steps. Steps up to t
    /// are `active`. Grounding costs by the call more than by the step, so it is done `chunk` steps at a time.
    pub(crate) fn shortest(
        &mut self,
        rules: &SourceFile,
        facts: &[Term],
        [least, most]: [i32; 2],
        chunk: i32,
    ) -> Result<Option<Shortest>, SolveError> {
        let mut control = load(rules, facts)?;
        let mut grounded = -1;
        for steps in least..=most {
            if grounded < steps {
                let until = (steps + chunk).min(most);
                let mut parts = Vec::new();
                for step in grounded + 1..=until {
                    let time = vec![Symbol::create_number(step)];
                    parts.push(if step == 0 {
                        Part::new("base", vec![])?
                    } else {
                        Part::new("step", time.clone())?
                    });
                    parts.push(Part::new("state", time)?);
                }
                control.ground(&parts)?;
                grounded = until;
            }
            for (time, query) in numbered(&control, "query")? {
                let value = if time == steps { TruthValue::True } else { TruthValue::False };
                control.assign_external(query, value)?;
            }
            for (time, active) in numbered(&control, "active")? {
                let value = if time <= steps { TruthValue::True } else { TruthValue::False };
                control.assign_external(active, value)?;
            }
            let (back, answer) = self.solve(control)?;
            control = back;
            if let Some(shown) = answer {
                return Ok(Some(Shortest { steps, shown }));
            }
        }
        Ok(None)
    }

    /// Solves once; gives the control back, and the last and so the best answer.
    fn solve(&mut self, control: Control) -> Result<(Control, Option<Vec<Term>>), SolveError> {
        self.solves += 1;
        let mut handle = control.solve(SolveMode::YIELD, &[])?;
        let outcome = last_answer(&mut handle);
        // Closed before anything else, also after a failure: the search works on the control.
        let control = handle.close()?;
        let (result, answer) = outcome?;
        let decided = SolveResult::SATISFIABLE | SolveResult::UNSATISFIABLE;
        if result.contains(SolveResult::INTERRUPTED) || !result.intersects(decided) {
            return Err(SolveError::Limit);
        }
        Ok((control, answer))
    }
}

/// Lets a search run to its end.
fn last_answer(handle: &mut SolveHandle) -> Result<(SolveResult, Option<Vec<Term>>), ClingoError> {
    let mut answer = None;
    loop {
        handle.resume()?;
        match handle.model()? {
            Some(model) => {
                let shown = model.symbols(ShowType::SHOWN)?.into_iter().map(term);
                answer = Some(shown.collect::<Result<_, _>>()?);
            }
            None => return Ok((handle.get()?, answer)),
        }
    }
}

/// A control with the rules and the facts in it, nothing grounded yet.
fn load(rules: &SourceFile, facts: &[Term]) -> Result<Control, ClingoError> {
    let limit = format!("--solve-limit={CONFLICT_LIMIT}");
    // The rule file was checked when it was read; what is left are remarks about facts that a goal lacks.
    let options = ["--warn=none", "--parallel-mode=1", "--seed=0", &limit];
    let mut control = clingo::control(options.map(str::to_string).to_vec())?;
    control.add("base", &[], rules.text())?;
    let facts: String = facts.iter().map(|fact| format!("{fact}.\n")).collect();
    control.add("base", &[], &facts)?;
    Ok(control)
}

/// A symbol of clingo as a term.
fn term(symbol: Symbol) -> Result<Term, ClingoError> {
    Ok(match symbol.symbol_type()? {
        SymbolType::Number => Term::Number(symbol.number()?.into()),
        SymbolType::String => Term::from(symbol.string()?),
        SymbolType::Function => {
            let arguments = symbol.arguments()?.into_iter().map(term).collect::<Result<_, _>>()?;
            Term::Function(symbol.name()?.to_string(), arguments)
        }
        SymbolType::Infimum | SymbolType::Supremum => Term::Other(symbol.to_string()),
    })
}

/// The atoms `name(t)`, with their t.
fn numbered(control: &Control, name: &str) -> Result<Vec<(i32, SolverLiteral)>, ClingoError> {
    let signature = Signature::new(name, 1, true)?;
    let mut found = Vec::new();
    for atom in control.symbolic_atoms()?.iter_with_signature(signature)? {
        if let [time] = atom.symbol()?.arguments()?[..] {
            found.push((time.number()?, atom.literal()?));
        }
    }
    Ok(found)
}

/// Checks that a rule file is a valid program, without running it.
pub(crate) fn check(file: &SourceFile) -> Result<(), Fault<OrderProblem>> {
    MESSAGES.take();
    // Grounding no part at all still parses the rules and checks their variables.
    let outcome = clingo::control_with_context(vec![], Listener).and_then(|control| {
        // A control with a context is never freed; one whose context was replaced is.
        let mut control: GenericControl<Listener> = control.register_control_context(Listener);
        control.add("base", &[], file.text())?;
        control.ground(&[])
    });
    let messages = MESSAGES.take();
    match (messages.first(), outcome) {
        (_, Ok(())) => Ok(()),
        (Some(message), Err(_)) => Err(fault(file, message)),
        (None, Err(ClingoError::NulError(error))) => Err(fault(file, &error.to_string())),
        (None, Err(error)) => Err(fault(file, &error.to_string())),
    }
}

/// A message such as `<block>:12:3-9: error: syntax error, unexpected .` as a fault at its place.
fn fault(file: &SourceFile, message: &str) -> Fault<OrderProblem> {
    let message = message.trim();
    let (place, why) = match message.strip_prefix("<block>:").and_then(|rest| rest.split_once(": ")) {
        Some((place, why)) => (place, why.strip_prefix("error: ").unwrap_or(why)),
        None => ("", message),
    };
    let mut numbers = place.split(['-', ':']).map_while(|number| number.parse::<usize>().ok());
    let line = numbers.next().unwrap_or(1);
    let column = numbers.next().unwrap_or(1);
    let text = file.text();
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let at = start + column.saturating_sub(1);
    // On one line, a third number is the column where the place ends.
    let end = numbers.next().filter(|_| numbers.next().is_none()).map_or(at, |last| start + last - 1);
    let why = why.replace("<block>", file.name());
    let why = why.lines().map(str::trim).collect::<Vec<_>>().join(" ");
    Fault::new(OrderProblem::Rule { why }, file.place(at..end.max(at)))
}

thread_local! {
    /// What clingo said while the rule file at hand was checked.
    static MESSAGES: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

/// Collects clingo's messages; has no size because clingo keeps its address while it moves.
struct Listener;

impl Logger for Listener {
    fn log(&mut self, _code: Warning, message: &str) {
        MESSAGES.with_borrow_mut(|messages| messages.push(message.to_string()));
    }
}

impl Propagator for Listener {}

impl GroundProgramObserver for Listener {}

impl FunctionHandler for Listener {
    fn on_external_function(
        &mut self,
        _location: &clingo::ast::Location,
        _name: &str,
        _arguments: &[Symbol],
    ) -> Result<Vec<Symbol>, ExternalError> {
        Ok(vec![])
    }
}

impl ControlCtx for Listener {
    type L = Listener;
    type P = Listener;
    type O = Listener;
    type F = Listener;

    fn logger(&mut self) -> (&mut Listener, u32) {
        (self, 20)
    }

    fn propagator(&mut self) -> (&mut Listener, bool) {
        (self, false)
    }

    fn observer(&mut self) -> (&mut Listener, bool) {
        (self, false)
    }

    fn function_handler(&mut self) -> &mut Listener {
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(rules: &str, facts: &[Term]) -> Result<Option<Vec<Term>>, SolveError> {
        let file = SourceFile::new("test.lp", rules);
        check(&file).unwrap();
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
    fn a_plan_has_as_few_steps_as_possible() {
        let rules = "
            holds(n(0),0).
            #program state(t). #external query(t). :- query(t), not holds(n(12),t). #show do/2.
            #program step(t). #external active(t).
            { do(add(1..5),t) } = 1 :- active(t). holds(n(X+Y),t) :- holds(n(X),t-1), do(add(Y),t).";
        let file = SourceFile::new("test.lp", rules);
        let mut solver = Solver::default();
        let found = solver.shortest(&file, &[], [0, 8], 1).unwrap().unwrap();
        assert_eq!((found.steps, found.shown.len(), solver.solves), (3, 3, 4));
        assert!(solver.shortest(&file, &[], [0, 2], 4).unwrap().is_none());
    }

    #[test]
    fn a_search_without_an_end_gives_up() {
        // One pigeon more than there are holes.
        let rules = "{ in(P,H) : H = 1..12 } = 1 :- P = 1..13. :- in(P,H), in(Q,H), P < Q.";
        assert!(matches!(shown(rules, &[]), Err(SolveError::Limit)));
    }

    #[test]
    fn nothing_of_a_message_is_lost() {
        let file = SourceFile::new("test.lp", "a.\nb(X) :- c,\n  d.\n");
        let error = format!("{:#}", check(&file).unwrap_err());
        assert_eq!(
            error,
            "test.lp:2:1: unsafe variables in: b(X):-[#inc_base];d;c. test.lp:2:3-4: note: 'X' is unsafe"
        );
    }
}
