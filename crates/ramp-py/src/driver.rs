//! Actions of an environment, for agents and skills that drive a robot: the same numbers, the same motion.

use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::Point3;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use ramp_gym::known::Held;
use ramp_gym::{ActionKind, Driver as Inner};
use ramp_robot::GripperCommand;

use crate::convert::{Numbers, Observation, all, exactly, pose};
use crate::errors::{Interrupts, Recovered, detached, input};
use crate::files::Benchmark;
use crate::gym::action_kind;
use crate::integers;
use crate::robot::Robot;

/// Turns actions into commands, as an environment does.
#[pyclass(frozen, module = "ramp._ramp")]
pub struct Driver {
    inner: Mutex<Inner>,
    numbers: usize,
}

#[pymethods]
impl Driver {
    /// `held` is the pose of what is in the hand in the tip's frame, its mass, and its centre of mass in its
    /// own frame.
    #[new]
    #[pyo3(signature = (benchmark, robot, settings, width, force, gripper, held=None))]
    fn new(
        benchmark: &Bound<'_, Benchmark>,
        robot: &Bound<'_, Robot>,
        settings: &Bound<'_, PyDict>,
        width: f64,
        force: f64,
        gripper: bool,
        held: Option<(Numbers<'_>, f64, Numbers<'_>)>,
    ) -> PyResult<Driver> {
        let kind: ActionKind = action_kind(settings)?;
        let held = match held {
            None => None,
            Some((x_tp, mass, centre)) => {
                let seven: [f64; 7] = exactly(&x_tp, "held_pose")?;
                Some(Held {
                    part: String::new(),
                    x_tp: pose(&seven[..3], &seven[3..])?,
                    mass,
                    p_centre: Point3::from(exactly::<3>(&centre, "held_centre")?),
                })
            }
        };
        let numbers = kind.numbers() + usize::from(gripper);
        let arm = &Arc::clone(&benchmark.get().inner).arm;
        let seen = robot.get().seen()?;
        let inner = Inner::new(&kind, arm, &seen, GripperCommand { width, force }, held);
        Ok(Driver { inner: Mutex::new(inner), numbers })
    }

    /// Lets an action work for so many control periods of 1 ms; what is sensed after the last.
    fn act(
        &self,
        py: Python<'_>,
        robot: &Bound<'_, Robot>,
        action: Numbers<'_>,
        #[pyo3(from_py_with = integers::periods)] periods: u32,
    ) -> PyResult<Observation> {
        let action = all(&action);
        if action.len() != self.numbers || !action.iter().all(|it| it.is_finite()) {
            return Err(input(format!("{} finite numbers were expected", self.numbers)));
        }
        let robot = robot.get();
        detached(py, || {
            let mut driver = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
            let mut interrupts = Interrupts::new();
            let mut seen = robot.seen()?;
            for _ in 0..periods {
                let command = driver.command(&action, &seen);
                seen = match robot.take(&command) {
                    Ok(seen) => seen,
                    Err(error) => {
                        if Python::attach(|py| error.is_instance_of::<Recovered>(py)) {
                            driver.begin_anew(&robot.seen()?);
                        }
                        return Err(error);
                    }
                };
                interrupts.check()?;
            }
            Ok(Observation { inner: seen })
        })
    }

    /// The target from the tip, axes of the world: m, rotation vector in rad, shape (6,).
    fn lead<'py>(&self, py: Python<'py>, observation: &Bound<'_, Observation>) -> Bound<'py, PyArray1<f64>> {
        let driver = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
        driver.lead(&observation.get().inner).as_slice().to_vec().into_pyarray(py)
    }
}
