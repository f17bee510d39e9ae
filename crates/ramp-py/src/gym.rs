//! Environments: one, and many at a time.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadwriteArray1, PyReadwriteArray2};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use ramp_gym::action::{Cartesian, Joint};
use ramp_gym::batch::Outcome;
use ramp_gym::pictures::SIZES;
use ramp_gym::{
    ActionKind, Batch as InnerBatch, Begin, Env as Inner, Frame, Onlooker, Options, Scenario, Step, View,
    Weights, onlooker,
};
use ramp_twin::Twin;

use crate::convert::{Numbers, all, camera, picture, seven};
use crate::errors::{data, detached, env as env_error, input, scenario as scenario_error};
use crate::files::Benchmark;
use crate::integers;
use crate::twin::track;

/// A setting, if it is given, as a type of Rust.
fn setting<'py, T>(settings: &Bound<'py, PyDict>, name: &str) -> PyResult<Option<T>>
where
    T: for<'a> FromPyObject<'a, 'py>,
    for<'a> <T as FromPyObject<'a, 'py>>::Error: Into<PyErr>,
{
    let Some(value) = settings.get_item(name)? else { return Ok(None) };
    if value.is_none() {
        return Ok(None);
    }
    match value.extract::<T>() {
        Ok(value) => Ok(Some(value)),
        Err(error) => Err(input(format!("{name}: {}", error.into()))),
    }
}

/// A positive, finite number.
fn positive(number: f64, name: &str) -> PyResult<f64> {
    if number > 0.0 && number.is_finite() {
        Ok(number)
    } else {
        Err(input(format!("{name} must be more than 0")))
    }
}

/// Meaning of the numbers of an action.
pub fn action_kind(settings: &Bound<'_, PyDict>) -> PyResult<ActionKind> {
    let get = |name: &str| setting::<f64>(settings, name);
    let flag = |name: &str| setting::<bool>(settings, name);
    let action: String = setting(settings, "action")?.unwrap_or_else(|| "cartesian".to_string());
    let strict = flag("strict")?.unwrap_or(false);
    Ok(match action.as_str() {
        "cartesian" => {
            let mut it = Cartesian::default();
            it.turns = flag("turns")?.unwrap_or(it.turns);
            it.speed = positive(get("speed")?.unwrap_or(it.speed), "speed")?;
            it.turn_speed = positive(get("turn_speed")?.unwrap_or(it.turn_speed), "turn_speed")?;
            if let Some(leash) = setting::<[f64; 3]>(settings, "leash")? {
                for length in leash {
                    positive(length, "leash")?;
                }
                it.leash = leash;
            }
            if let Some(stiffness) = setting::<[f64; 6]>(settings, "stiffness")? {
                for each in stiffness {
                    positive(each, "stiffness")?;
                }
                it.stiffness = stiffness;
            }
            ActionKind::Cartesian(it)
        }
        "joint" => {
            let mut it = Joint::default();
            it.speed = positive(get("speed")?.unwrap_or(it.speed), "speed")?;
            ActionKind::Joint(it)
        }
        "raw" => ActionKind::Raw { strict },
        other => return Err(input(format!("there is no action `{other}`; there are cartesian, joint, raw"))),
    })
}

/// How an environment is driven, what it shows, and how it rewards.
fn options(settings: &Bound<'_, PyDict>) -> PyResult<Options> {
    let get = |name: &str| setting::<f64>(settings, name);
    let flag = |name: &str| setting::<bool>(settings, name);
    let action = action_kind(settings)?;
    let rate = get("rate")?.unwrap_or(20.0);
    if !(5.0..=100.0).contains(&rate) {
        return Err(input(format!("the rate {rate} is not within 5 and 100 Hz")));
    }
    let reward: String = setting(settings, "reward")?.unwrap_or_else(|| "sparse".to_string());
    let weights = match reward.as_str() {
        "sparse" => Weights::sparse(),
        "shaped" => Weights::shaped(),
        other => return Err(input(format!("there is no reward `{other}`; there are sparse, shaped"))),
    };
    let mut views = Vec::new();
    for (name, size, depth) in setting::<Vec<(String, usize, bool)>>(settings, "views")?.unwrap_or_default() {
        let [least, most] = SIZES;
        if !(least..=most).contains(&size) {
            return Err(input(format!("the image size {size} is not within {least} and {most} pixels")));
        }
        views.push(View { camera: camera(&name)?, size, depth });
    }
    let error = get("belief_error")?.unwrap_or(0.0);
    if !(0.0..=0.05).contains(&error) {
        return Err(input(format!("the belief_error {error} is not within 0 and 0.05 m")));
    }
    let other = Options::default();
    Ok(Options {
        action,
        gripper: flag("gripper")?.unwrap_or(other.gripper),
        periods: (1000.0 / rate).round() as u32,
        limit: positive(get("limit")?.unwrap_or(other.limit), "limit")?,
        starts: setting(settings, "starts")?.unwrap_or(other.starts),
        belief_error: error,
        weights,
        views,
        truth: flag("truth")?.unwrap_or(other.truth),
    })
}

/// Name, shape and place of some numbers, and what they are.
type FieldRow = (&'static str, Vec<usize>, usize, &'static str);

/// One environment.
#[pyclass(frozen, module = "ramp._ramp")]
pub struct Env {
    inner: Mutex<Inner>,
    /// Draws the pictures for a person, from the first one on.
    onlooker: Mutex<Option<Onlooker>>,
}

/// Pictures for a person of an episode that runs elsewhere: it looks now and then, and draws when asked.
#[pyclass(frozen, module = "ramp._ramp")]
pub struct EpisodePictures {
    onlooker: Mutex<Onlooker>,
}

impl EpisodePictures {
    /// Looks at the twin; only [`EpisodePictures::picture`] draws.
    pub fn look(&self, twin: &Twin) -> PyResult<()> {
        self.onlooker.lock().unwrap_or_else(PoisonError::into_inner).look(twin).map_err(input)
    }
}

#[pymethods]
impl EpisodePictures {
    #[new]
    fn new(benchmark: &Bound<'_, Benchmark>) -> PyResult<EpisodePictures> {
        let onlooker = Onlooker::new(&benchmark.get().inner).map_err(input)?;
        Ok(EpisodePictures { onlooker: Mutex::new(onlooker) })
    }

    /// A picture, shape (480, 640, 3); nothing before the episode has begun.
    fn picture<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, numpy::PyArray3<u8>>>> {
        let pixels = py.detach(|| self.onlooker.lock().unwrap_or_else(PoisonError::into_inner).picture());
        pixels.map(|pixels| person_picture(py, pixels)).transpose()
    }
}

/// A picture for a person as an array.
fn person_picture<'py>(py: Python<'py>, pixels: Vec<u8>) -> PyResult<Bound<'py, numpy::PyArray3<u8>>> {
    let [width, height] = onlooker::SIZE;
    picture(py, pixels, [height, width])
}

impl Env {
    fn env(&self) -> PyResult<MutexGuard<'_, Inner>> {
        self.inner
            .try_lock()
            .map_err(|_| PyRuntimeError::new_err("the environment is at work on another thread"))
    }
}

/// Knowledge at the start of the running episode; nothing before the first reset.
fn start<'py>(py: Python<'py>, env: &Inner) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let Some(start) = env.start() else { return Ok(dict) };
    let goal = &env.scenario().goals[start.task.0];
    dict.set_item("scene_seed", start.seed)?;
    dict.set_item("goal", &goal.assembly.name)?;
    if let Some(step) = goal.steps.get(start.task.1) {
        dict.set_item("skill", &step.task.skill)?;
        dict.set_item("action", &step.task.action)?;
    }
    if let Some(known) = &start.known {
        dict.set_item("part", &known.part)?;
        dict.set_item("goal_pose", seven(&known.x_goal).into_pyarray(py))?;
    }
    Ok(dict)
}

/// Outcome of an action, as a dictionary; with the `truth` on request.
fn told<'py>(py: Python<'py>, step: &Step, truth: bool) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("reward", step.terms.sum())?;
    dict.set_item("reward_progress", step.terms.progress)?;
    dict.set_item("reward_success", step.terms.success)?;
    dict.set_item("reward_lost", step.terms.lost)?;
    dict.set_item("reward_force", step.terms.force)?;
    dict.set_item("success", step.success)?;
    dict.set_item("terminated", step.terminated)?;
    dict.set_item("truncated", step.truncated)?;
    dict.set_item("cause", &step.cause)?;
    dict.set_item("completion", step.completion)?;
    if truth {
        let off: [f64; 3] = step.progress.off.into();
        let truth = PyDict::new(py);
        truth.set_item("off", off.to_vec().into_pyarray(py))?;
        dict.set_item("truth", truth)?;
    }
    Ok(dict)
}

#[pymethods]
impl Env {
    /// `skill` is a skill, or `None` for the whole goal; `goals` are its goals.
    #[new]
    #[pyo3(signature = (benchmark, skill, goals, *, track, world, start, begin, whole_scene, frame, settings))]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn new(
        py: Python<'_>,
        benchmark: &Bound<'_, Benchmark>,
        skill: Option<&str>,
        goals: Vec<String>,
        track: &str,
        world: &str,
        start: &str,
        begin: &str,
        whole_scene: bool,
        frame: &str,
        settings: &Bound<'_, PyDict>,
    ) -> PyResult<Env> {
        let files = Arc::clone(&benchmark.get().inner);
        let world = files.world(world).map_err(data)?;
        let start = files.start(start).map_err(data)?;
        let track = self::track(track)?;
        let begin = match begin {
            "ready" => Begin::Ready,
            "home" => Begin::Home,
            other => return Err(input(format!("there is no begin `{other}`; there are ready, home"))),
        };
        let frame = match frame {
            "rigid" => Frame::Rigid,
            "free" => Frame::Free,
            other => return Err(input(format!("there is no frame `{other}`; there are rigid, free"))),
        };
        let options = options(settings)?;
        if options.truth && skill.is_none() {
            return Err(input("`truth` is the place of the part of a skill, and this is a whole goal"));
        }
        let env = detached(py, || {
            let scenario = match (skill, goals.first()) {
                (Some(skill), _) => {
                    let scenario = Scenario::skill(files, skill, &goals, track, world, start, begin);
                    Scenario { whole_scene, frame, ..scenario.map_err(scenario_error)? }
                }
                (None, Some(goal)) => {
                    let assembly = files.goal(goal).map_err(data)?;
                    Scenario::goal(files, assembly, track, world, start)
                }
                (None, None) => return Err(input("a goal is needed")),
            };
            Inner::new(Arc::new(scenario), options).map_err(env_error)
        })?;
        Ok(Env { inner: Mutex::new(env), onlooker: Mutex::new(None) })
    }

    /// Makes all starts, on so many threads.
    fn prepare(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = integers::threads)] threads: usize,
    ) -> PyResult<()> {
        detached(py, || self.env()?.prepare(threads).map_err(env_error))
    }

    #[pyo3(signature = (seed=None))]
    fn reset(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = integers::maybe_seed)] seed: Option<u64>,
    ) -> PyResult<()> {
        detached(py, || self.env()?.reset(seed).map_err(env_error))
    }

    fn step<'py>(&self, py: Python<'py>, action: Numbers<'py>) -> PyResult<Bound<'py, PyDict>> {
        let action = all(&action);
        let step = detached(py, || self.env()?.step(&action).map_err(env_error))?;
        told(py, &step, self.env()?.options().truth)
    }

    fn observe<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let env = self.env()?;
        let mut row = vec![0.0; env.width()];
        env.observe(&mut row);
        Ok(row.into_pyarray(py))
    }

    /// Colour image of a view, shape (size, size, 3).
    fn image<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = integers::view)] view: usize,
    ) -> PyResult<Bound<'py, numpy::PyArray3<u8>>> {
        let env = self.env()?;
        let none = || input("there is no such view");
        let size = env.views().nth(view).ok_or_else(none)?.size;
        picture(py, env.image(view).ok_or_else(none)?.to_vec(), [size, size])
    }

    /// Depth image of a view, m, shape (size, size).
    fn depth<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = integers::view)] view: usize,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let env = self.env()?;
        let none = || input("there is no such view");
        let size = env.views().nth(view).ok_or_else(none)?.size;
        env.depth(view).ok_or_else(none)?.to_vec().into_pyarray(py).reshape([size, size])
    }

    /// A picture of the work for a person, shape (480, 640, 3); nothing before the first `reset`.
    fn picture<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, numpy::PyArray3<u8>>>> {
        let pixels = detached(py, || {
            let env = self.env()?;
            let Some(twin) = env.twin() else { return Ok(None) };
            let mut onlooker = self.onlooker.lock().unwrap_or_else(PoisonError::into_inner);
            let onlooker = match &mut *onlooker {
                Some(onlooker) => onlooker,
                none => none.insert(Onlooker::new(&env.scenario().benchmark).map_err(input)?),
            };
            onlooker.look(twin).map_err(input)?;
            Ok(onlooker.picture())
        })?;
        pixels.map(|pixels| person_picture(py, pixels)).transpose()
    }

    /// Name, shape and place of the numbers of an observation, and what they are.
    fn fields(&self) -> PyResult<Vec<FieldRow>> {
        let env = self.env()?;
        Ok(env.fields().iter().map(|it| (it.name, it.shape.clone(), it.offset, it.about)).collect())
    }

    /// Lowest and highest of each number of an action.
    fn bounds(&self) -> PyResult<Vec<[f64; 2]>> {
        Ok(self.env()?.bounds())
    }

    /// The parts whose poses an observation tells.
    fn part_names(&self) -> PyResult<Vec<String>> {
        Ok(self.env()?.part_names().to_vec())
    }

    /// Control periods of a millisecond for each action.
    #[getter]
    fn periods(&self) -> PyResult<u32> {
        Ok(self.env()?.options().periods)
    }

    /// Knowledge at the start of the running episode.
    fn start<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        start(py, &*self.env()?)
    }

    #[getter]
    fn state_hash(&self) -> PyResult<String> {
        Ok(format!("{:016x}", self.env()?.twin().map_or(0, ramp_twin::Twin::state_hash)))
    }

    /// MJCF of the running episode's scene.
    #[getter]
    fn scene(&self) -> PyResult<String> {
        Ok(self.env()?.twin().map(|twin| twin.scene().to_string()).unwrap_or_default())
    }

    /// MuJoCo's positions, velocities and actuator commands of the running episode.
    fn physics<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyArray1<f64>>; 2]> {
        let env = self.env()?;
        let twin = env.twin().ok_or_else(|| input("the environment was not reset"))?;
        Ok([twin.qpos().to_vec().into_pyarray(py), twin.ctrl().to_vec().into_pyarray(py)])
    }
}

/// Many environments.
#[pyclass(frozen, module = "ramp._ramp")]
pub struct Batch {
    inner: Mutex<InnerBatch>,
    truth: bool,
}

impl Batch {
    fn batch(&self) -> PyResult<MutexGuard<'_, InnerBatch>> {
        self.inner
            .try_lock()
            .map_err(|_| PyRuntimeError::new_err("the environments are at work on another thread"))
    }
}

/// A flag for each environment.
fn flags<'py>(
    py: Python<'py>,
    outcomes: &[Outcome],
    flag: impl Fn(&Outcome) -> bool,
) -> Bound<'py, PyArray1<bool>> {
    outcomes.iter().map(flag).collect::<Vec<_>>().into_pyarray(py)
}

/// A number for each environment.
fn numbers<'py>(
    py: Python<'py>,
    outcomes: &[Outcome],
    number: impl Fn(&Outcome) -> f64,
) -> Bound<'py, PyArray1<f64>> {
    outcomes.iter().map(number).collect::<Vec<_>>().into_pyarray(py)
}

#[pymethods]
impl Batch {
    #[new]
    fn new(
        py: Python<'_>,
        env: &Bound<'_, Env>,
        #[pyo3(from_py_with = integers::environments)] count: usize,
        #[pyo3(from_py_with = integers::threads)] threads: usize,
    ) -> PyResult<Batch> {
        let env = env.get();
        let truth = env.env()?.options().truth;
        let batch = detached(py, || InnerBatch::new(&*env.env()?, count, threads).map_err(env_error))?;
        Ok(Batch { inner: Mutex::new(batch), truth })
    }

    /// Resets the environments that have an entry which is not `False`: a seed, or `True` for the next
    /// episode.
    fn reset(&self, py: Python<'_>, which: Vec<Bound<'_, PyAny>>) -> PyResult<()> {
        let mut seeds = Vec::with_capacity(which.len());
        for it in which {
            seeds.push(match it.extract::<bool>() {
                Ok(false) => None,
                Ok(true) => Some(None),
                Err(_) => Some(Some(integers::seed(&it)?)),
            });
        }
        detached(py, || {
            let mut batch = self.batch()?;
            if seeds.len() != batch.len() {
                return Err(input(format!("{} entries, and {} were expected", seeds.len(), batch.len())));
            }
            batch.reset(&seeds).map_err(env_error)
        })
    }

    /// Steps all; `actions` has a row for each.
    fn step<'py>(
        &self,
        py: Python<'py>,
        actions: Numbers<'py>,
        reset_ended: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let actions = all(&actions);
        let outcomes = detached(py, || self.batch()?.step(&actions, reset_ended).map_err(env_error))?;
        let dict = PyDict::new(py);
        dict.set_item("reward", numbers(py, &outcomes, |it| it.step.terms.sum()))?;
        dict.set_item("reward_progress", numbers(py, &outcomes, |it| it.step.terms.progress))?;
        dict.set_item("reward_success", numbers(py, &outcomes, |it| it.step.terms.success))?;
        dict.set_item("reward_lost", numbers(py, &outcomes, |it| it.step.terms.lost))?;
        dict.set_item("reward_force", numbers(py, &outcomes, |it| it.step.terms.force))?;
        dict.set_item("completion", numbers(py, &outcomes, |it| it.step.completion))?;
        dict.set_item("success", flags(py, &outcomes, |it| it.step.success))?;
        dict.set_item("terminated", flags(py, &outcomes, |it| it.step.terminated))?;
        dict.set_item("truncated", flags(py, &outcomes, |it| it.step.truncated))?;
        dict.set_item("reset", flags(py, &outcomes, |it| it.reset))?;
        let causes: Vec<Option<&str>> = outcomes.iter().map(|it| it.step.cause.as_deref()).collect();
        dict.set_item("cause", causes)?;
        if self.truth {
            let offs: Vec<f64> =
                outcomes.iter().flat_map(|it| <[f64; 3]>::from(it.step.progress.off)).collect();
            dict.set_item("off", offs.into_pyarray(py).reshape([outcomes.len(), 3])?)?;
        }
        Ok(dict)
    }

    /// Knowledge at the start of the running episode of each environment.
    fn starts<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let batch = self.batch()?;
        (0..batch.len()).map(|index| batch.with(index, |env| start(py, env))).collect()
    }

    /// Ends the episodes of some environments from outside, as a limit of steps does.
    fn end(&self, which: Vec<bool>) -> PyResult<()> {
        self.batch()?.end(&which);
        Ok(())
    }

    /// Writes the observations into an array of shape (environments, numbers).
    fn observe(&self, mut out: PyReadwriteArray2<'_, f32>) -> PyResult<()> {
        let out = out.as_slice_mut().map_err(|_| input("the array is not contiguous"))?;
        self.batch()?.observe(out);
        Ok(())
    }

    /// Writes the colour images of a view into a flat array.
    fn images(
        &self,
        #[pyo3(from_py_with = integers::view)] view: usize,
        mut out: PyReadwriteArray1<'_, u8>,
    ) -> PyResult<()> {
        let out = out.as_slice_mut().map_err(|_| input("the array is not contiguous"))?;
        self.batch()?.images(view, out);
        Ok(())
    }

    /// Writes the depth images of a view into a flat array.
    fn depths(
        &self,
        #[pyo3(from_py_with = integers::view)] view: usize,
        mut out: PyReadwriteArray1<'_, f32>,
    ) -> PyResult<()> {
        let out = out.as_slice_mut().map_err(|_| input("the array is not contiguous"))?;
        self.batch()?.depths(view, out);
        Ok(())
    }

    /// A hash of the physics state of each environment.
    fn state_hashes(&self) -> PyResult<Vec<String>> {
        Ok(self.batch()?.state_hashes().into_iter().map(|hash| format!("{hash:016x}")).collect())
    }
}
