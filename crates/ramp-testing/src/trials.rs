//! Checks that some machines cannot run. Such a check is reported as skipped with its reason, not as passed.
//!
//! A test binary with `harness = false` lists its checks and hands them to [`run`]. Each skipped check ends
//! in a line `SKIPPED: NAME: REASON` on standard output; `.ci/run` counts these lines.

use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

use libtest_mimic::{Arguments, Completion};

pub use libtest_mimic::Trial;

/// The skipped checks of this process: name and reason.
static SKIPPED: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// A check for every machine. It fails if `run` panics.
#[must_use]
pub fn check(name: &'static str, run: fn()) -> Trial {
    Trial::test(name, move || {
        run();
        Ok(())
    })
}

/// A check that needs something of the machine. It is skipped if `missing` returns the reason why it cannot
/// run here.
#[must_use]
pub fn check_unless(name: &'static str, missing: fn() -> Option<String>, run: fn()) -> Trial {
    Trial::ignorable_test(name, move || {
        let Some(reason) = missing() else {
            run();
            return Ok(Completion::Completed);
        };
        SKIPPED.lock().unwrap_or_else(PoisonError::into_inner).push(format!("{name}: {reason}"));
        Ok(Completion::ignored_with(format!("SKIPPED: {reason}")))
    })
}

/// Runs the checks that the arguments of this process select, then names those that were skipped.
#[must_use]
#[allow(clippy::print_stdout)]
pub fn run(checks: Vec<Trial>) -> ExitCode {
    let conclusion = libtest_mimic::run(&Arguments::from_args(), checks);
    for skipped in SKIPPED.lock().unwrap_or_else(PoisonError::into_inner).iter() {
        println!("SKIPPED: {skipped}");
    }
    conclusion.exit_code()
}
