//! Checks a rule file with clingo without running it: its first message becomes an error at its
//! place.

use super::control::alone;
use super::problem::OrderProblem;
use super::scan::scan;
use clingo::{
    ClingoError, ControlCtx, ExternalError, FunctionHandler, GenericControl, GroundProgramObserver, Logger,
    Propagator, Symbol, Warning,
};
use ramp_source::{Fault, SourceFile};
use std::cell::RefCell;

/// Checks that a rule file is a valid program, without running it. The file is untrusted: clingo
/// gets it only when it cannot make clingo read other files, run programs or exhaust its stack.
pub(crate) fn check(file: &SourceFile) -> Result<(), Fault<OrderProblem>> {
    scan(file.text()).map_err(|(problem, at)| Fault::new(problem, file.place(at)))?;
    let _alone = alone();
    MESSAGES.take();
    // Grounding no part still parses the rules and checks their variables.
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
    // A third number on the same line is the last column of the place.
    let end = numbers.next().filter(|_| numbers.next().is_none()).map_or(at, |last| start + last - 1);
    let why = why.replace("<block>", file.name());
    let why = why.lines().map(str::trim).collect::<Vec<_>>().join(" ");
    Fault::new(OrderProblem::Rule { why }, file.place(at..end.max(at)))
}

thread_local! {
    /// clingo's messages during the current check.
    static MESSAGES: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

/// Collects clingo's messages. Zero-sized, because clingo keeps its address while it moves.
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
