//! The robot as an agent or a skill in Python gets it: for as long as its `run` runs, and on its thread.

use std::sync::{Mutex, PoisonError};
use std::thread::ThreadId;

use numpy::IntoPyArray;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use ramp_robot::{Command as Inner, Observation as Seen, PartReading, Robot as Seam};

use crate::convert::{CameraImage, Command, Observation, camera as camera_of, seven, width_of};
use crate::errors::{Interrupts, detached, robot};
use crate::integers;

/// A robot that somebody else owns.
#[derive(Clone, Copy)]
struct Borrowed(*mut (dyn Seam + 'static));

// SAFETY: it is only used on the thread that lent it (`Robot::with` checks), so nothing is sent.
#[expect(
    unsafe_code,
    reason = "Python's objects must be able to go anywhere; this one refuses to work elsewhere"
)]
unsafe impl Send for Borrowed {}

/// A robot to drive. It works until the `run` that it was given to is over.
#[pyclass(frozen, module = "ramp")]
pub struct Robot {
    lent: Mutex<Option<Borrowed>>,
    thread: ThreadId,
}

/// Takes the robot back, whatever happens.
struct Lent<'py>(Bound<'py, Robot>);

impl Drop for Lent<'_> {
    fn drop(&mut self) {
        *self.0.get().lent.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

impl Robot {
    /// Lends a robot to Python for as long as `work` takes.
    pub fn lend<'py, T>(
        py: Python<'py>,
        robot: &mut dyn Seam,
        work: impl FnOnce(&Bound<'py, Robot>) -> PyResult<T>,
    ) -> PyResult<T> {
        let pointer: *mut dyn Seam = robot;
        // SAFETY: only the lifetime is changed. The pointer is taken back below before `robot`'s borrow ends.
        #[expect(unsafe_code, reason = "Python's objects have no lifetimes")]
        let pointer = unsafe { std::mem::transmute::<*mut dyn Seam, *mut (dyn Seam + 'static)>(pointer) };
        let lent = Mutex::new(Some(Borrowed(pointer)));
        let object = Bound::new(py, Robot { lent, thread: std::thread::current().id() })?;
        let lent = Lent(object);
        work(&lent.0)
    }

    /// Does something with the robot.
    fn with<T>(&self, work: impl FnOnce(&mut dyn Seam) -> PyResult<T>) -> PyResult<T> {
        if std::thread::current().id() != self.thread {
            return Err(PyRuntimeError::new_err(
                "the robot works only on the thread on which `run` was called",
            ));
        }
        let lent = self.lent.try_lock().map_err(|_| PyRuntimeError::new_err("the robot is at work"))?;
        let Some(Borrowed(pointer)) = *lent else {
            return Err(PyRuntimeError::new_err("the robot is gone: the `run` that it was given to is over"));
        };
        // SAFETY: `lend` holds the only borrow of the robot and waits; the lock is held, so there is no
        // second one.
        #[expect(unsafe_code, reason = "see above")]
        let robot = unsafe { &mut *pointer };
        work(robot)
    }
}

impl Robot {
    /// The last observation.
    pub fn seen(&self) -> PyResult<Seen> {
        self.with(|robot| Ok(robot.observe()))
    }

    /// One control period under a command.
    pub fn take(&self, command: &Inner) -> PyResult<Seen> {
        self.with(|it| it.step(command).map_err(|error| robot(&error)))
    }
}

/// So many control periods under a command; what was sensed after the last.
pub fn step(robot: &mut dyn Seam, command: &Inner, periods: u32) -> PyResult<Seen> {
    let mut interrupts = Interrupts::new();
    let mut seen = None;
    for _ in 0..periods {
        seen = Some(robot.step(command).map_err(|error| crate::errors::robot(&error))?);
        interrupts.check()?;
    }
    Ok(seen.unwrap_or_else(|| robot.observe()))
}

/// Readings of parts as a dictionary: name to pose (7,) and standard deviations (m, rad).
pub fn readings<'py>(py: Python<'py>, readings: Vec<PartReading>) -> PyResult<Bound<'py, PyDict>> {
    let parts = PyDict::new(py);
    for reading in readings {
        parts.set_item(reading.part, seven(&reading.x_wp).into_pyarray(py))?;
    }
    Ok(parts)
}

#[pymethods]
impl Robot {
    /// Lets `periods` control periods of 1 ms pass under `command`; what is sensed after the last.
    #[pyo3(signature = (command, periods=1))]
    fn step(
        &self,
        py: Python<'_>,
        command: &Bound<'_, Command>,
        #[pyo3(from_py_with = integers::periods)] periods: u32,
    ) -> PyResult<Observation> {
        let command = &command.get().inner;
        detached(py, || self.with(|robot| Ok(Observation { inner: step(robot, command, periods)? })))
    }

    /// The last observation. No time passes.
    fn observe(&self) -> PyResult<Observation> {
        self.with(|robot| Ok(Observation { inner: robot.observe() }))
    }

    /// Part poses that the track gives: name to x, y, z in m and quaternion w, x, y, z.
    fn read_parts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let parts = self.with(|it| it.read_parts().map_err(|error| robot(&error)))?;
        readings(py, parts)
    }

    /// Opens the shutters of both cameras, and takes no time: `look` gives the images later, the oldest
    /// first.
    fn expose(&self) -> PyResult<()> {
        self.with(|it| it.expose().map_err(|error| robot(&error)))
    }

    /// An image of a camera, `wrist` or `birds-eye`. Robot time passes. `size`: pixels in a row, 16 to 1280,
    /// for an image of the whole field of view that is drawn in this size at once; without it, 1280.
    #[pyo3(signature = (camera, *, size=None))]
    fn look(&self, py: Python<'_>, camera: &str, size: Option<u64>) -> PyResult<CameraImage> {
        let (which, width) = (camera_of(camera)?, width_of(size)?);
        let look = |it: &mut dyn Seam| {
            it.look_sized(which, width).map(CameraImage::from).map_err(|error| robot(&error))
        };
        detached(py, || self.with(look))
    }
}
