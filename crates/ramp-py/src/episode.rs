//! Whole episodes: the baseline, an agent or a skill in Python, judged by the referee.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use ramp_data::Texts;
use ramp_episode::{
    EpisodeError, Label, Progress, Recorded, Watcher, check_given, record_episode, run_episode,
};
use ramp_gym::outline::read_outline;
use ramp_gym::own::{Body, BodyError, Moment, OwnSkill, kind};
use ramp_kit::source::read_text;
use ramp_planner::Domains;
use ramp_report::curve::completion_svg;
use ramp_result::EpisodeResult;
use ramp_result::collection::LARGEST;
use ramp_result::episode::{RobotTime, Software, StartInfo, StateInfo, WorldLabel};
use ramp_result::resume::{Identity, Shared, Wanted};
use ramp_robot::{
    Account, Agent, Camera, CameraModel, Command, Event, Image, ImageWidth, MOST_EVENT, MOST_EVENTS,
    Observation, PartReading, Robot as Seam, RobotError, TIME_LIMIT,
};
use ramp_skills::rehearsal::Outline;
use ramp_skills::{Baseline, Parameters, ReferenceTimes, reference_times_of_goal};
use ramp_twin::{Setup, Twin};

use crate::convert::seven;
use crate::errors::{EVERY, Interrupts, Raised, Recovered, RobotStopped, caught, data, detached, input};
use crate::files::Benchmark;
use crate::finder::finding;
use crate::given::{given, given_plan};
use crate::gym::EpisodePictures;
use crate::integers;
use crate::planner::planned;
use crate::robot::Robot;
use crate::twin::{fault, track};
use numpy::IntoPyArray;

/// Reason of the robot whose episode is thrown away.
fn stop() -> RobotError {
    RobotError::OutOfTime { limit: TIME_LIMIT }
}

/// A robot that stops when Ctrl-C is pressed or something in Python has raised.
struct Watched<'r> {
    robot: &'r mut dyn Seam,
    /// Checks for Ctrl-C; nothing if another thread does.
    interrupts: Option<Interrupts>,
    raised: Raised,
}

impl Watched<'_> {
    fn check(&mut self) -> Result<(), RobotError> {
        if let Some(Err(error)) = self.interrupts.as_mut().map(Interrupts::check) {
            self.raised.keep(error);
        }
        if self.raised.is_there() { Err(stop()) } else { Ok(()) }
    }
}

impl Seam for Watched<'_> {
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError> {
        self.check()?;
        self.robot.step(command)
    }

    fn observe(&self) -> Observation {
        self.robot.observe()
    }

    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        self.check()?;
        self.robot.read_parts()
    }

    fn expose(&mut self) -> Result<(), RobotError> {
        self.check()?;
        self.robot.expose()
    }

    fn look_sized(&mut self, camera: Camera, width: Option<ImageWidth>) -> Result<Image, RobotError> {
        self.check()?;
        self.robot.look_sized(camera, width)
    }

    fn camera(&self, camera: Camera) -> CameraModel {
        self.robot.camera(camera)
    }
}

/// Any agent, with a robot that can be stopped.
struct Stoppable<'a> {
    agent: Box<dyn Agent + 'a>,
    /// Whether it looks for Ctrl-C itself.
    looks: bool,
    raised: Raised,
}

impl Agent for Stoppable<'_> {
    fn name(&self) -> (&str, &str) {
        self.agent.name()
    }

    fn account(&self) -> Account {
        self.agent.account()
    }

    fn file_hash(&self) -> Option<&str> {
        self.agent.file_hash()
    }

    fn failure(&self) -> Option<String> {
        self.agent.failure()
    }

    fn run(&mut self, robot: &mut dyn Seam) -> Result<(), RobotError> {
        let interrupts = self.looks.then(Interrupts::new);
        self.agent.run(&mut Watched { robot, interrupts, raised: self.raised.clone() })
    }

    fn finish(&mut self) {
        self.agent.finish();
    }

    fn processor_time(&self) -> Option<f64> {
        self.agent.processor_time()
    }
}

/// The events that an agent in Python reported: a list of dictionaries.
fn events_of(py: Python<'_>, events: &Bound<'_, PyAny>) -> PyResult<Vec<Event>> {
    let json: String = py.import("json")?.call_method1("dumps", (events,))?.extract()?;
    let events: Vec<serde_json::Value> = serde_json::from_str(&json).map_err(input)?;
    if events.len() > MOST_EVENTS {
        return Err(input(format!(
            "the agent reported {} events, and {MOST_EVENTS} is the most",
            events.len()
        )));
    }
    events.into_iter().map(|event| event_of(&event.to_string())).collect()
}

/// An event that an agent reported, from its JSON.
fn event_of(json: &str) -> PyResult<Event> {
    let event: Event = serde_json::from_str(json).map_err(|error| input(format!("event: {error}")))?;
    if event.kind.is_of_episode() {
        return Err(input(format!("event: `{}` is a kind that only the episode reports", event.kind.name())));
    }
    event.kind.check(MOST_EVENT).map_err(|why| input(format!("the event {why}")))?;
    if event.time.is_finite() { Ok(event) } else { Err(input("event: its time is not finite")) }
}

/// Checks an event that an agent reports.
#[pyfunction]
pub fn check_event(event: &str) -> PyResult<()> {
    event_of(event).map(drop)
}

/// The text of an event.
#[pyfunction]
pub fn describe_event(event: &str) -> PyResult<String> {
    let event: Event = serde_json::from_str(event).map_err(|error| input(format!("event: {error}")))?;
    Ok(event.kind.to_string())
}

/// An agent in Python.
struct PythonAgent {
    object: Py<PyAny>,
    /// The goal, as the agent gets it.
    goal: Py<PyAny>,
    name: String,
    version: String,
    account: Account,
    raised: Raised,
}

impl PythonAgent {
    /// Calls the agent's `run`, and takes over what it tells.
    fn call(&mut self, robot: &mut dyn Seam) -> PyResult<()> {
        Python::attach(|py| {
            let object = self.object.bind(py);
            let outcome = Robot::lend(py, robot, |robot| object.call_method1("run", (robot, &self.goal)));
            if let Ok(events) = object.getattr("events") {
                self.account.events = events_of(py, &events)?;
            }
            outcome.map(|_| ())
        })
    }
}

impl Agent for PythonAgent {
    fn name(&self) -> (&str, &str) {
        (&self.name, &self.version)
    }

    fn account(&self) -> Account {
        self.account.clone()
    }

    fn run(&mut self, robot: &mut dyn Seam) -> Result<(), RobotError> {
        let mut kept = Kept { robot, stopped: None };
        let outcome = self.call(&mut kept);
        match (outcome, kept.stopped) {
            // The agent may catch what stopped the robot, or let it pass.
            (Ok(()), Some(error)) => Err(error),
            (Ok(()), None) => Ok(()),
            (Err(error), stopped) => {
                let robot = Python::attach(|py| error.is_instance_of::<RobotStopped>(py));
                if !robot || stopped.is_none() {
                    self.raised.keep(error);
                }
                Err(stopped.unwrap_or_else(stop))
            }
        }
    }
}

/// A robot that keeps what stopped it for good.
struct Kept<'r> {
    robot: &'r mut dyn Seam,
    stopped: Option<RobotError>,
}

impl Kept<'_> {
    fn keep<T>(&mut self, result: Result<T, RobotError>) -> Result<T, RobotError> {
        if let Err(error) = &result
            && error.is_final()
        {
            self.stopped.get_or_insert_with(|| error.clone());
        }
        result
    }
}

impl Seam for Kept<'_> {
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError> {
        let result = self.robot.step(command);
        self.keep(result)
    }

    fn observe(&self) -> Observation {
        self.robot.observe()
    }

    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        let result = self.robot.read_parts();
        self.keep(result)
    }

    fn expose(&mut self) -> Result<(), RobotError> {
        let result = self.robot.expose();
        self.keep(result)
    }

    fn look_sized(&mut self, camera: Camera, width: Option<ImageWidth>) -> Result<Image, RobotError> {
        let result = self.robot.look_sized(camera, width);
        self.keep(result)
    }

    fn camera(&self, camera: Camera) -> CameraModel {
        self.robot.camera(camera)
    }
}

/// A skill in Python.
struct PythonBody {
    object: Py<PyAny>,
    raised: Raised,
}

impl Body for PythonBody {
    fn rehearse(&self, expected: &Moment) -> Outline {
        let outline = Python::attach(|py| {
            let answer = self.object.bind(py).call_method1("outline", (moment_of(py, expected)?,))?;
            let Some(text) = answer.extract::<Option<String>>()? else { return Ok(Outline::Unknown) };
            let alternatives = serde_json::from_str(&text).map_err(|error| input(error.to_string()))?;
            read_outline(&alternatives).map_err(input)
        });
        outline.unwrap_or_else(|error| {
            self.raised.keep(error);
            Outline::Unknown
        })
    }

    fn run(&self, robot: &mut dyn Seam, moment: &Moment) -> Result<(), BodyError> {
        let mut kept = Kept { robot, stopped: None };
        let outcome = Python::attach(|py| {
            let task = moment_of(py, moment)?;
            let object = self.object.bind(py);
            let told = Robot::lend(py, &mut kept, |robot| object.call_method1("run", (robot, task)))?;
            // `None` is done; a text is why it gave up.
            if told.is_none() { Ok(None) } else { told.extract::<String>().map(Some) }
        });
        if let Some(error) = kept.stopped {
            return Err(error.into());
        }
        match outcome {
            Ok(None) => Ok(()),
            Ok(Some(why)) => Err(BodyError::GaveUp(ramp_kit::source::plain(&why, 199))),
            // A skill that does not go on after a stop of the arm gives up.
            Err(error) if Python::attach(|py| error.is_instance_of::<Recovered>(py)) => {
                Err(BodyError::GaveUp(ramp_kit::source::plain(&error.to_string(), 199)))
            }
            Err(error) => {
                self.raised.keep(error);
                Err(stop().into())
            }
        }
    }
}

/// The request to a skill, as a dictionary.
fn moment_of<'py>(py: Python<'py>, moment: &Moment) -> PyResult<Bound<'py, PyDict>> {
    let task = PyDict::new(py);
    let known = &moment.known;
    task.set_item("kind", moment.kind.name().replace('_', "-"))?;
    task.set_item("action", &moment.action)?;
    task.set_item("part", &known.part)?;
    task.set_item("part_pose", seven(&known.x_wp).into_pyarray(py))?;
    task.set_item("goal_pose", seven(&known.x_goal).into_pyarray(py))?;
    task.set_item("posture", known.posture.to_vec().into_pyarray(py))?;
    task.set_item("width", known.gripper.width)?;
    task.set_item("force", known.gripper.force)?;
    let held = known.held.as_ref().map(|held| (seven(&held.x_tp).into_pyarray(py), held.mass));
    task.set_item("held_pose", held.as_ref().map(|held| held.0.clone()))?;
    task.set_item("held_mass", held.map(|held| held.1))?;
    let centre = known.held.as_ref().map(|held| held.p_centre.coords.as_slice().to_vec().into_pyarray(py));
    task.set_item("held_centre", centre)?;
    Ok(task)
}

/// A skill in Python as one of the table.
fn own_skill(name: &str, label: &str, object: Py<PyAny>, raised: &Raised) -> PyResult<OwnSkill> {
    let kinds: Vec<String> = ramp_gym::own::kinds().map(|kind| kind.name().replace('_', "-")).collect();
    let kind = kind(name)
        .ok_or_else(|| input(format!("no skill carries out `{name}`; there are {}", kinds.join(", "))))?;
    let body = PythonBody { object, raised: raised.clone() };
    Ok(OwnSkill::new(kind, label, Box::new(body)))
}

/// This package.
fn software() -> Software {
    Software { version: env!("CARGO_PKG_VERSION").to_string(), commit: env!("RAMP_COMMIT").to_string() }
}

/// An agent in Python: the object, its name and its version, and what it is told of the goal.
type Own = (Py<PyAny>, String, String, Py<PyAny>);
/// A skill in Python: what it carries out, its name, and the object.
type OwnPart = (String, String, Py<PyAny>);

/// Runs an episode; the result as JSON. With `output`, the result is written to that file; a result of this
/// very episode that the file already has is returned instead.
#[pyfunction]
#[pyo3(signature = (benchmark, goal, *, arm, track, world, start, seed, task="build", state=None, agent=None, skills=Vec::new(), plan=None, plans=None, planner=None, finder=None, domain=None,
    parameters=None, fault=None, record=None, output=None, repeat=1, progress=None, pictures=None))]
#[expect(clippy::too_many_arguments, reason = "they are named in Python")]
pub fn run(
    py: Python<'_>,
    benchmark: &Bound<'_, Benchmark>,
    goal: &str,
    arm: &str,
    track: &str,
    world: &str,
    start: &str,
    #[pyo3(from_py_with = integers::seed)] seed: u64,
    task: &str,
    state: Option<PathBuf>,
    agent: Option<Own>,
    skills: Vec<OwnPart>,
    plan: Option<String>,
    plans: Option<PathBuf>,
    planner: Option<(Py<PyAny>, String)>,
    finder: Option<(Py<PyAny>, String)>,
    domain: Option<&str>,
    parameters: Option<&str>,
    fault: Option<&str>,
    record: Option<PathBuf>,
    output: Option<PathBuf>,
    #[pyo3(from_py_with = integers::repeat)] repeat: u32,
    progress: Option<Py<PyAny>>,
    pictures: Option<Py<EpisodePictures>>,
) -> PyResult<String> {
    let files = benchmark.get();
    let inner = Arc::clone(&files.inner);
    let files_of_arm = inner.data.with_arm(arm).map_err(data)?;
    let (assembly, texts) = files_of_arm.goal_with_texts(goal).map_err(data)?;
    let arm = files_of_arm.arm().map_err(data)?;
    let world = inner.world(world).map_err(data)?;
    let start = inner.start(start).map_err(data)?;
    let (track, fault) = (self::track(track)?, self::fault(fault)?);
    let replaced = plan.is_some() || plans.is_some() || planner.is_some();
    let (task, state) = given(task, state.as_deref(), &assembly, &start, replaced)?;
    let domains = files.domains(domain)?;
    let raised = Raised::default();
    // What runs Python's code does so on this thread; all else on one that can be left behind.
    let python = agent.is_some() || planner.is_some() || finder.is_some() || !skills.is_empty();
    let plan = given_plan(py, plan, plans, &assembly, &domains)?;
    let parameters = parameters_of(parameters)?;
    let mut table = ramp_skills::table::baseline(&parameters);
    for (name, label, object) in skills {
        table.replace(own_skill(&name, &label, object, &raised)?);
    }
    let stopped = raised.clone();
    let work = move || {
        let (start, world) = (&start, &world);
        let (assembly, arm, state) = (&assembly, &arm, state.as_ref());
        let setup = Setup { assembly, arm, track, seed, start, state, task, world, fault };
        check_given(&setup).map_err(input)?;
        let worker: Box<dyn Agent + '_> = match agent {
            Some((object, name, version, goal)) => {
                let account = Account::default();
                Box::new(PythonAgent { object, goal, name, version, account, raised: raised.clone() })
            }
            None => {
                let baseline = baseline(&setup, &domains, parameters).with_skills(table);
                let baseline = finding(baseline, &setup, finder, &raised)?;
                Box::new(planned(baseline, (assembly, &domains), plan, planner, &raised))
            }
        };
        let mut worker = Stoppable { agent: worker, looks: python, raised: raised.clone() };
        let software = software();
        if let Some(path) = &output
            && let Some(result) = kept(path, &setup, &worker, &software)?
        {
            return Ok(result.to_json());
        }
        let mut told = Interrupts::new();
        let mut watcher = |now: &Progress, twin: &Twin| {
            if let Some(pictures) = &pictures {
                pictures.get().look(twin).unwrap_or_else(|error| raised.keep(error));
            }
            let Some(progress) = progress.as_ref().filter(|_| !raised.is_there()) else { return };
            if let Some(Err(error)) = told
                .due(|| Python::attach(|py| progress.call1(py, (now.time, now.seated, now.pegs)).map(|_| ())))
            {
                raised.keep(error);
            }
        };
        let robot_time = robot_time(&setup, &inner.domains);
        let label = Label { robot_time, ..Label::new(software, repeat) };
        let result = match &record {
            Some(path) => recorded(&setup, &texts, &mut worker, &label, path, &mut watcher)?,
            None => run_episode(&setup, &mut worker, &label, &mut watcher).map_err(input)?,
        };
        if let Some(error) = raised.take() {
            return Err(error);
        }
        let text = result.to_json();
        if let Some(path) = &output {
            ramp_result::write_whole(path, &text).map_err(input)?;
        }
        Ok(text)
    };
    if python { detached(py, work) } else { aside(py, &stopped, work) }
}

/// The baseline for an episode.
fn baseline<'a>(setup: &Setup<'a>, domains: &'a Domains, parameters: Arc<Parameters>) -> Baseline<'a> {
    Baseline::new(setup.assembly, setup.arm, domains, setup.seed)
        .on_track(setup.track)
        .from_start(setup.start)
        .with_task(setup.task)
        .with_parameters(parameters)
}

/// The parameters of a file, or the baseline's.
fn parameters_of(path: Option<&str>) -> PyResult<Arc<Parameters>> {
    match path {
        Some(path) => Parameters::read(path.as_ref()).map_err(|error| input(format!("{error:#}"))),
        None => Ok(Parameters::baseline()),
    }
}

/// Bound and reference of the robot time. They hold where nothing is built at the start.
fn robot_time(setup: &Setup, domains: &Domains) -> Option<RobotTime> {
    let nothing_stands = setup.state.is_none();
    let times =
        nothing_stands.then(|| reference_times_of_goal(setup.assembly, setup.arm, domains).ok()).flatten();
    times.map(|ReferenceTimes { bound, reference }| RobotTime { bound, reference })
}

/// Runs an episode and leaves its log at `path`.
fn recorded(
    setup: &Setup,
    texts: &Texts,
    agent: &mut dyn Agent,
    label: &Label,
    path: &Path,
    watcher: &mut Watcher,
) -> PyResult<EpisodeResult> {
    let recorded = record_episode(setup, &texts.sources(), agent, label, path, watcher);
    let Recorded { result, unlogged } = recorded.map_err(|error| match error {
        EpisodeError::Log(error) => input(error),
        EpisodeError::Twin(error) => input(error),
    })?;
    match unlogged {
        Some(error) => Err(input(format!("there is no log: {error}"))),
        None => Ok(result),
    }
}

/// The result of this very episode in a file, if there is one.
///
/// # Errors
/// If the file has a result of another version, arm, world or agent.
fn kept(
    path: &Path,
    setup: &Setup,
    agent: &dyn Agent,
    software: &Software,
) -> PyResult<Option<EpisodeResult>> {
    let Ok(text) = read_text(path, LARGEST) else { return Ok(None) };
    let (world, start) = (WorldLabel::of(setup.world).sha256, StartInfo::of(setup.start).sha256);
    let state = setup.state.map(|state| StateInfo::of(&state.text).sha256);
    let shared = Shared {
        arm: &setup.arm.name,
        worlds: vec![&world],
        start: &start,
        states: vec![state.as_deref()],
        secret: None,
        software,
        agent: Identity {
            name: Some(agent.name()),
            sha256: agent.file_hash(),
            asynchronous: agent.is_asynchronous(),
        },
    };
    let wanted = Wanted {
        goal: &setup.assembly.name,
        task: setup.task.told(),
        state: state.as_deref(),
        count: setup.assembly.wanted(setup.task),
        track: setup.track.name(),
        world: &world,
        seed: setup.seed,
        fault: setup.fault.map(|fault| fault.kind.name()),
    };
    shared.find(&wanted, &text).map_err(|foreign| {
        let file = path.display();
        input(format!("{file} is a result {foreign}: name another folder, or move this file away"))
    })
}

/// Runs something that takes long on a thread of its own. Ctrl-C leaves it behind at once: its robot stops at
/// the next call.
fn aside(
    py: Python<'_>,
    raised: &Raised,
    work: impl FnOnce() -> PyResult<String> + Send + 'static,
) -> PyResult<String> {
    let (tell, told) = std::sync::mpsc::channel();
    let told = Mutex::new(told);
    std::thread::spawn(move || {
        // Nobody listens any more if Ctrl-C was pressed.
        let _ = tell.send(caught(work));
    });
    loop {
        let listen = || told.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(EVERY);
        match py.detach(listen) {
            Ok(result) => return result,
            Err(std::sync::mpsc::RecvTimeoutError::Timeout) => {
                if let Err(error) = py.check_signals() {
                    raised.keep(error.clone_ref(py));
                    return Err(error);
                }
            }
            Err(std::sync::mpsc::RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err("the episode ended without a result"));
            }
        }
    }
}

/// A result in the form of the present schema, from that of this one or of the one before.
#[pyfunction]
pub fn current_result(result: &str) -> PyResult<String> {
    Ok(EpisodeResult::from_json(result.as_bytes()).map_err(input)?.to_json())
}

/// The completion of a result over time, as SVG.
#[pyfunction]
pub fn curve_svg(result: &str) -> PyResult<String> {
    let result = EpisodeResult::from_json(result.as_bytes()).map_err(input)?;
    Ok(completion_svg(&result))
}
