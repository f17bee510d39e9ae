//! Errors as exceptions, with the same words; and Ctrl-C while Rust is at work.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use miette::Diagnostic;
use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use ramp_gym::{BenchmarkError, EnvError, ScenarioError};
use ramp_robot::RobotError;

create_exception!(
    ramp,
    InputError,
    PyValueError,
    "Something that was given is wrong: a name, a file, a number, an array's shape."
);
create_exception!(ramp, PlanningError, PyRuntimeError, "There is no plan, or the plan is refused.");
create_exception!(
    ramp,
    RobotStopped,
    PyRuntimeError,
    "The robot has stopped for good: a limit of the arm, a command that it cannot follow, or the end of the episode's time."
);
create_exception!(
    ramp,
    Refused,
    PyRuntimeError,
    "The robot does not do this, and goes on: the track does not give it, or a camera has stopped."
);

create_exception!(
    ramp,
    Recovered,
    PyRuntimeError,
    "The arm stopped by a reflex or for its speed, stood for a while, and is ready again. A new motion begins where it stands."
);

/// Bad input.
pub fn input(error: impl std::fmt::Display) -> PyErr {
    InputError::new_err(error.to_string())
}

/// The robot's reason.
pub fn robot(error: &RobotError) -> PyErr {
    if error.is_final() {
        RobotStopped::new_err(error.to_string())
    } else if error.is_recovered() {
        Recovered::new_err(error.to_string())
    } else {
        Refused::new_err(error.to_string())
    }
}

/// A problem of the benchmark's files, after its file, line and column.
pub fn data(error: impl Into<BenchmarkError>) -> PyErr {
    match error.into() {
        error @ BenchmarkError::Plan { .. } => PlanningError::new_err(error.to_string()),
        BenchmarkError::Data(error) => match error.help() {
            Some(help) => input(format!("{error:#}; {help}")),
            None => input(format!("{error:#}")),
        },
    }
}

/// Why there is no environment.
pub fn scenario(error: ScenarioError) -> PyErr {
    match error {
        ScenarioError::Data(error) => data(error),
        _ => input(error),
    }
}

/// Why an environment cannot go on.
pub fn env(error: EnvError) -> PyErr {
    match error {
        EnvError::Length { .. } | EnvError::Starts { .. } => input(error),
        _ => PyRuntimeError::new_err(error.to_string()),
    }
}

/// Runs something that needs no Python, without holding its lock.
pub fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> PyResult<T> + Send) -> PyResult<T> {
    py.detach(|| caught(work))
}

/// A panic, which is a mistake of this program, becomes an exception that `except Exception` catches.
pub fn caught<T>(work: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let words = panic.downcast_ref::<String>().map(String::as_str);
        let words = words.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("unknown");
        Err(PyRuntimeError::new_err(format!("internal error of ramp: {words}")))
    })
}

/// Between two looks whether Ctrl-C was pressed.
pub const EVERY: Duration = Duration::from_millis(50);

/// Looks now and then whether Ctrl-C was pressed.
pub struct Interrupts {
    last: Instant,
}

impl Interrupts {
    /// From now on.
    pub fn new() -> Interrupts {
        Interrupts { last: Instant::now() }
    }

    /// Does something now and then.
    pub fn due<T>(&mut self, work: impl FnOnce() -> T) -> Option<T> {
        if self.last.elapsed() < EVERY {
            return None;
        }
        self.last = Instant::now();
        Some(work())
    }

    /// `KeyboardInterrupt`, if Ctrl-C was pressed.
    pub fn check(&mut self) -> PyResult<()> {
        self.due(|| Python::attach(|py| py.check_signals())).unwrap_or(Ok(()))
    }
}

/// An exception that something in Python raised while Rust was at work.
#[derive(Clone, Default)]
pub struct Raised(Arc<Mutex<Option<PyErr>>>);

impl Raised {
    /// Keeps the first one.
    pub fn keep(&self, error: PyErr) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    }

    /// Whether there is one.
    pub fn is_there(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// Takes it.
    pub fn take(&self) -> Option<PyErr> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}
