//! clingo, behind three calls: check a rule file, find its best answer, find its shortest plan.
//!
//! Everything is deterministic: one thread, a fixed seed, and limits counted in conflicts instead of seconds.

use crate::domains::OrderProblem;
use crate::language::ground::{Literal, Prospect, Unrolled};
use crate::term::Term;
use clingo::{
    Atom, ClingoError, Control, ControlCtx, ExternalError, FunctionHandler, GenericControl,
    GroundProgramObserver, Logger, Model, Part, Propagator, ShowType, SolveHandle, SolveMode, SolveResult,
    SolverLiteral, Symbol, SymbolType, Warning,
};
use ramp_kit::source::{Fault, SourceFile};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Conflicts after which one call gives up: a few seconds of work, or, where no effort is spared, some minutes.
const CONFLICT_LIMITS: [u32; 2] = [200_000, 5_000_000];

/// Held while clingo works, one call at a time: its grounder crashes now and then when two threads use it, each with
/// a control of its own (clingo 5.6, in `Gringo::Input::Program::rewrite`).
static CLINGO: Mutex<()> = Mutex::new(());

fn alone() -> MutexGuard<'static, ()> {
    // It guards no data that a panic could leave half-written.
    CLINGO.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Why a call came to no end.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SolveError {
    /// clingo reports an error.
    #[error("{0}")]
    Clingo(String),
    /// The search reached its limit of conflicts.
    #[error("the search gave up")]
    Limit {
        /// Where steps are searched: how many. There is no plan of fewer.
        steps: usize,
    },
}

impl From<ClingoError> for SolveError {
    fn from(error: ClingoError) -> SolveError {
        // The error borrows a buffer that clingo writes to again.
        SolveError::Clingo(error.to_string())
    }
}

/// The most explanations of one size that are told.
const MOST_EXPLANATIONS: usize = 16;

/// Something that may have happened.
pub(crate) struct Happening {
    pub event: Term,
    /// Before which action of the history; for an action without effect, which.
    pub before: usize,
    pub literal: Literal,
}

/// Runs programs and counts how often.
#[derive(Debug, Default)]
pub(crate) struct Solver {
    /// Calls so far.
    pub(crate) solves: usize,
    /// Spare no effort: for proofs.
    pub(crate) thorough: bool,
}

impl Solver {
    /// The best answer of the part `base` of the rules with some facts; `None` when there is no answer.
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

    /// The shortest plan that makes some fluents true or false, by the number of its actions from `least` to `most`;
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

    /// The smallest sets of happenings that may be true together with the program, by index; at most so many at once.
    pub(crate) fn explanations(
        &mut self,
        unrolled: &mut Unrolled,
        happenings: &[Happening],
        most: usize,
    ) -> Result<Vec<Vec<usize>>, SolveError> {
        let _alone = alone();
        // `more[n]`: more than n of the happenings so far are true.
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
        // By what it is, whenever it happens: that is what tells explanations apart.
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
                // As late as possible: what went wrong before would have been noticed before.
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

    /// Which of the happenings are true in an answer.
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

    /// Solves once; gives the control back, and the last and so the best answer.
    fn solve<T>(
        &mut self,
        control: Control,
        steps: usize,
        assumed: &[SolverLiteral],
        read: impl Fn(&Model) -> Result<T, ClingoError>,
    ) -> Result<(Control, Option<T>), SolveError> {
        self.solves += 1;
        let mut handle = control.solve(SolveMode::YIELD, assumed)?;
        let outcome = last_answer(&mut handle, read);
        // Closed before anything else, also after a failure: the search works on the control.
        let control = handle.close()?;
        let (result, answer) = outcome?;
        let decided = SolveResult::SATISFIABLE | SolveResult::UNSATISFIABLE;
        if result.contains(SolveResult::INTERRUPTED) || !result.intersects(decided) {
            return Err(SolveError::Limit { steps });
        }
        Ok((control, answer))
    }
}

/// Lets a search run to its end.
fn last_answer<T>(
    handle: &mut SolveHandle,
    read: impl Fn(&Model) -> Result<T, ClingoError>,
) -> Result<(SolveResult, Option<T>), ClingoError> {
    let mut answer = None;
    loop {
        handle.resume()?;
        match handle.model()? {
            Some(model) => answer = Some(read(model)?),
            None => return Ok((handle.get()?, answer)),
        }
    }
}

fn shown(model: &Model) -> Result<Vec<Term>, ClingoError> {
    model.symbols(ShowType::SHOWN)?.into_iter().map(term).collect()
}

fn new_control(thorough: bool) -> Result<Control, ClingoError> {
    let limit = format!("--solve-limit={}", CONFLICT_LIMITS[usize::from(thorough)]);
    // Of clasp's presets, the one that proves the easy goals optimal in the least time.
    let preset = if thorough { "--configuration=jumpy" } else { "--configuration=auto" };
    // The rule file was checked when it was read; what is left are remarks about facts that a goal lacks.
    let options = ["--warn=none", "--parallel-mode=1", "--seed=0", preset, &limit];
    clingo::control(options.map(str::to_string).to_vec())
}

/// A control with the rules and the facts in it, nothing grounded yet.
fn load(rules: &SourceFile, facts: &[Term]) -> Result<Control, ClingoError> {
    let mut control = new_control(false)?;
    control.add("base", &[], rules.text())?;
    let facts: String = facts.iter().map(|fact| format!("{fact}.\n")).collect();
    control.add("base", &[], &facts)?;
    Ok(control)
}

/// Hands the new rules of a ground program on; `atoms` are clingo's names for its atoms.
fn add(control: &mut Control, atoms: &mut Vec<Atom>, unrolled: &mut Unrolled) -> Result<(), ClingoError> {
    let mut backend = control.backend()?;
    for _ in atoms.len()..usize::try_from(unrolled.atoms()).unwrap_or(0) {
        atoms.push(backend.add_atom(None)?);
    }
    let mut body = Vec::new();
    for rule in unrolled.take_rules() {
        let head = rule.head.map(|head| atom(atoms, head));
        body.clear();
        body.extend(rule.body.iter().map(|&of| literal(atoms, of)));
        backend.rule(rule.choice, head.as_slice(), &body)?;
    }
    Ok(())
}

fn atom(atoms: &[Atom], literal: Literal) -> Atom {
    atoms[literal.unsigned_abs() as usize - 1]
}

fn literal(atoms: &[Atom], literal: Literal) -> SolverLiteral {
    let positive = SolverLiteral::from(atom(atoms, literal));
    if literal < 0 { positive.negate() } else { positive }
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

/// Checks that a rule file is a valid program, without running it.
pub(crate) fn check(file: &SourceFile) -> Result<(), Fault<OrderProblem>> {
    let _alone = alone();
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

/// The number of steps of the shortest plan of a program in the parts of clingo's incremental mode, grounded by
/// clingo itself.
#[cfg(test)]
pub(crate) fn shortest_by_clingo(program: &str, most: i32) -> Option<usize> {
    let _alone = alone();
    let mut control = new_control(false).unwrap();
    control.add("base", &[], program).unwrap();
    for name in ["step", "check"] {
        control.add(name, &["t"], "").unwrap();
    }
    for steps in 0..=most {
        let time = || vec![Symbol::create_number(steps)];
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
    fn a_search_without_an_end_gives_up() {
        // One pigeon more than there are holes.
        let rules = "{ in(P,H) : H = 1..12 } = 1 :- P = 1..13. :- in(P,H), in(Q,H), P < Q.";
        assert!(matches!(shown(rules, &[]), Err(SolveError::Limit { .. })));
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
