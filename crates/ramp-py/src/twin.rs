//! The twin as an object to drive.

use std::sync::{Arc, Mutex, MutexGuard};

use numpy::{IntoPyArray, PyArray3};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use ramp_assembly::Task;
use ramp_gym::View;
use ramp_gym::pictures::Painter;
use ramp_referee::Referee;
use ramp_robot::{Robot as _, Track};
use ramp_twin::{Fault, Setup, Twin as Inner};

use crate::convert::{CameraImage, Command, Observation, camera as camera_of, picture, seven, width_of};
use crate::errors::{data, detached, input, robot};
use crate::files::Benchmark;
use crate::integers;
use crate::robot::{readings, step};

/// The state of a twin, to go back to.
#[pyclass(frozen, module = "ramp")]
pub struct Snapshot {
    inner: ramp_twin::Snapshot,
}

#[pymethods]
impl Snapshot {
    /// Robot time at which it was taken, s.
    #[getter]
    fn time(&self) -> f64 {
        self.inner.time()
    }
}

/// A twin with its referee.
struct RefereedTwin {
    twin: Inner,
    referee: Referee,
}

/// The digital twin of an episode.
#[pyclass(frozen, module = "ramp._ramp", name = "Twin")]
pub struct Twin {
    benchmark: Arc<ramp_gym::Benchmark>,
    /// The names of the goal's connections.
    connections: Vec<String>,
    cell: Mutex<RefereedTwin>,
}

/// The track of that name.
pub fn track(name: &str) -> PyResult<Track> {
    let named = Track::ALL.into_iter().find(|it| it.name() == name);
    let names = Track::ALL.map(Track::name).join(", ");
    named.ok_or_else(|| input(format!("there is no track `{name}`; there are {names}")))
}

/// A fault as on the command line.
pub fn fault(text: Option<&str>) -> PyResult<Option<Fault>> {
    text.map(|text| text.parse::<Fault>().map_err(input)).transpose()
}

impl Twin {
    fn cell(&self) -> PyResult<MutexGuard<'_, RefereedTwin>> {
        self.cell.try_lock().map_err(|_| PyRuntimeError::new_err("the twin is at work on another thread"))
    }
}

#[pymethods]
impl Twin {
    #[new]
    #[pyo3(signature = (benchmark, goal, track="state", world="real", start="moved", seed=1, fault=None))]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn new(
        py: Python<'_>,
        benchmark: &Bound<'_, Benchmark>,
        goal: &str,
        track: &str,
        world: &str,
        start: &str,
        #[pyo3(from_py_with = integers::seed)] seed: u64,
        fault: Option<&str>,
    ) -> PyResult<Twin> {
        let benchmark = Arc::clone(&benchmark.get().inner);
        let assembly = benchmark.goal(goal).map_err(data)?;
        let world = benchmark.world(world).map_err(data)?;
        let start = benchmark.start(start).map_err(data)?;
        let (track, fault) = (self::track(track)?, self::fault(fault)?);
        let connections = assembly.connections.iter().map(|it| it.name.clone()).collect();
        let cell = detached(py, || {
            let setup = Setup {
                assembly: &assembly,
                arm: &benchmark.arm,
                track,
                seed,
                start: &start,
                world: &world,
                state: None,
                task: Task::Build,
                fault,
            };
            let twin = Inner::new(&setup).map_err(input)?;
            let referee = Referee::new(&assembly, twin.part_names());
            Ok(RefereedTwin { twin, referee })
        })?;
        Ok(Twin { benchmark, connections, cell: Mutex::new(cell) })
    }

    #[pyo3(signature = (command, periods=1))]
    fn step(
        &self,
        py: Python<'_>,
        command: &Bound<'_, Command>,
        #[pyo3(from_py_with = integers::periods)] periods: u32,
    ) -> PyResult<Observation> {
        let command = &command.get().inner;
        detached(py, || Ok(Observation { inner: step(&mut self.cell()?.twin, command, periods)? }))
    }

    fn observe(&self) -> PyResult<Observation> {
        Ok(Observation { inner: self.cell()?.twin.observe() })
    }

    fn read_parts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let parts = self.cell()?.twin.read_parts().map_err(|error| robot(&error))?;
        readings(py, parts)
    }

    fn expose(&self) -> PyResult<()> {
        self.cell()?.twin.expose().map_err(|error| robot(&error))
    }

    #[pyo3(signature = (camera, size=None))]
    fn look(&self, py: Python<'_>, camera: &str, size: Option<u64>) -> PyResult<CameraImage> {
        let (camera, width) = (camera_of(camera)?, width_of(size)?);
        let look = || self.cell()?.twin.look_sized(camera, width).map_err(|error| robot(&error));
        let image = detached(py, look)?;
        Ok(image.into())
    }

    fn snapshot(&self) -> PyResult<Snapshot> {
        Ok(Snapshot { inner: self.cell()?.twin.snapshot() })
    }

    fn restore(&self, snapshot: &Bound<'_, Snapshot>) -> PyResult<()> {
        self.cell()?.twin.restore(&snapshot.get().inner).map_err(input)
    }

    fn true_poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let cell = self.cell()?;
        let poses = PyDict::new(py);
        for (name, x) in cell.twin.part_names().zip(cell.twin.truth().x_wp) {
            poses.set_item(name, seven(&x).into_pyarray(py))?;
        }
        Ok(poses)
    }

    /// The peg that pins each connection now, by the referee's rule.
    fn pegs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let mut cell = self.cell()?;
        let truth = cell.twin.truth();
        cell.referee.watch(&truth, 0.0);
        let pegs = PyDict::new(py);
        for (name, seated) in self.connections.iter().zip(cell.referee.verdict()) {
            pegs.set_item(name, seated.as_ref().map(|seated| seated.peg.clone()))?;
        }
        Ok(pegs)
    }

    #[pyo3(signature = (camera="birds-eye", size=256))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        camera: &str,
        #[pyo3(from_py_with = integers::size)] size: usize,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let camera = camera_of(camera)?;
        let pixels = detached(py, || {
            let cell = self.cell()?;
            let view = View { camera, size, depth: false };
            let mut painter = Painter::of(view, &self.benchmark).map_err(input)?;
            painter.dress(&cell.twin).map_err(input)?;
            painter.paint(&cell.twin);
            Ok(painter.colour)
        })?;
        picture(py, pixels, [size, size])
    }

    #[getter]
    fn time(&self) -> PyResult<f64> {
        Ok(self.cell()?.twin.time())
    }

    #[getter]
    fn scene(&self) -> PyResult<String> {
        Ok(self.cell()?.twin.scene().to_string())
    }

    #[getter]
    fn qpos<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, numpy::PyArray1<f64>>> {
        Ok(self.cell()?.twin.qpos().to_vec().into_pyarray(py))
    }

    #[getter]
    fn ctrl<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, numpy::PyArray1<f64>>> {
        Ok(self.cell()?.twin.ctrl().to_vec().into_pyarray(py))
    }

    #[getter]
    fn state_hash(&self) -> PyResult<String> {
        Ok(format!("{:016x}", self.cell()?.twin.state_hash()))
    }

    #[getter]
    fn largest_force(&self) -> PyResult<f64> {
        Ok(self.cell()?.twin.largest_force())
    }

    #[getter]
    fn deepest_penetration(&self) -> PyResult<f64> {
        Ok(self.cell()?.twin.deepest_penetration())
    }
}
