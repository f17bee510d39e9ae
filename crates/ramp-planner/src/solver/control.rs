//! clingo's control: created with fixed options, filled with rules, read term by term.

use clingo::{
    Atom, ClingoError, Control, Model, ShowType, SolveHandle, SolveResult, SolverLiteral, Symbol, SymbolType,
};
use ramp_action_language::{Literal, Term, Unrolled};
use ramp_source::SourceFile;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Conflict limits of one call: a few seconds of work, or some minutes for a proof.
const CONFLICT_LIMITS: [u32; 2] = [200_000, 5_000_000];

/// Largest nesting depth of an answer's terms.
const MAX_DEPTH: usize = 16;

/// Serialises calls of clingo: its grounder occasionally crashes when two threads use it, each with
/// a control of its own (clingo 5.6, in `Gringo::Input::Program::rewrite`).
static CLINGO: Mutex<()> = Mutex::new(());

/// Waits for exclusive use of clingo.
pub(crate) fn alone() -> MutexGuard<'static, ()> {
    // It guards no data that a panic could leave half-written.
    CLINGO.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs a search to its end.
pub(crate) fn last_answer<T>(
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

/// The shown terms of an answer.
pub(crate) fn shown(model: &Model) -> Result<Vec<Term>, ClingoError> {
    model.symbols(ShowType::SHOWN)?.into_iter().map(|symbol| term(symbol, MAX_DEPTH)).collect()
}

/// An empty control; `thorough` is for proofs.
pub(crate) fn new_control(thorough: bool) -> Result<Control, ClingoError> {
    let limit = format!("--solve-limit={}", CONFLICT_LIMITS[usize::from(thorough)]);
    // Of clasp's presets, the one that proves the easy goals optimal in the least time.
    let preset = if thorough { "--configuration=jumpy" } else { "--configuration=auto" };
    // The best order consists of many small, mostly independent preferences. Model-guided search,
    // which lowers the total cost step by step, does not end beyond 80 beams; core-guided search
    // needs no time.
    let best = "--opt-strategy=usc";
    // The rule file was checked when it was read; the remaining warnings concern facts that a goal
    // lacks.
    let options = ["--warn=none", "--parallel-mode=1", "--seed=0", preset, best, &limit];
    clingo::control(options.map(str::to_string).to_vec())
}

/// A control with the rules and facts, nothing grounded yet.
pub(crate) fn load(rules: &SourceFile, facts: &[Term]) -> Result<Control, ClingoError> {
    let mut control = new_control(false)?;
    control.add("base", &[], rules.text())?;
    let facts: String = facts.iter().map(|fact| format!("{fact}.\n")).collect();
    control.add("base", &[], &facts)?;
    Ok(control)
}

/// Passes new rules of a ground program to clingo; `atoms` maps its atoms to clingo's.
pub(crate) fn add(
    control: &mut Control,
    atoms: &mut Vec<Atom>,
    unrolled: &mut Unrolled,
) -> Result<(), ClingoError> {
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

/// A literal of the ground program as one of clingo.
pub(crate) fn literal(atoms: &[Atom], literal: Literal) -> SolverLiteral {
    let positive = SolverLiteral::from(atom(atoms, literal));
    if literal < 0 { positive.negate() } else { positive }
}

/// A symbol of clingo as a term; deeper nesting has no meaning on any level.
fn term(symbol: Symbol, depth: usize) -> Result<Term, ClingoError> {
    let Some(depth) = depth.checked_sub(1) else { return Ok(Term::Other("…".to_string())) };
    Ok(match symbol.symbol_type()? {
        SymbolType::Number => Term::Number(symbol.number()?.into()),
        SymbolType::String => Term::from(symbol.string()?),
        SymbolType::Function => {
            let arguments =
                symbol.arguments()?.into_iter().map(|inner| term(inner, depth)).collect::<Result<_, _>>()?;
            Term::Function(symbol.name()?.to_string(), arguments)
        }
        SymbolType::Infimum | SymbolType::Supremum => Term::Other(symbol.to_string()),
    })
}
