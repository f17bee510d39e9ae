//! `ramp run`: plans a goal, assembles it in the twin, and scores it.

use std::cell::{Cell, RefCell};
use std::fmt::Write;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use miette::{IntoDiagnostic, Report, miette};
use ramp_data::Data;
use ramp_episode::{EpisodeError, Label, Progress, Recorded, Tape, record_episode, tape};
use ramp_external_agent::AgentFile;
use ramp_kit::source::read_text;
use ramp_log::Log;
use ramp_policy_client::PolicyServer;
use ramp_report::curve::completion_svg;
use ramp_result::collection::LARGEST;
use ramp_result::episode::{EpisodeResult, RobotTime, StartInfo, WorldLabel};
use ramp_result::resume::{Identity, Shared, Wanted};
use ramp_robot::{Agent, Event, EventKind};
use ramp_skills::{ReferenceTimes, reference_times_of_goal};
use ramp_twin::{Fault, ForMujoco, Setup, Twin};

use crate::command::agent;
use crate::command::parts::Parts;
use crate::command::station;
use crate::options::{ArmOption, StartOption, TrackName, WorldOption};
use crate::output::{check_place, make_folder_of, print, tell, write_file};
use crate::pictures::{self, Pictures};
use crate::rules::domains;
use crate::software::software;
use crate::status::{DONE, INCOMPLETE, MachineFault};

/// Default folder for results.
const RESULTS: &str = "results";

#[derive(clap::Args)]
pub struct Arguments {
    /// Name of a goal, or a goal file
    goal: String,
    /// Knowledge that the agent has of the parts' poses
    #[arg(long, value_enum, default_value_t = TrackName::Tags)]
    track: TrackName,
    #[command(flatten)]
    arm: ArmOption,
    #[command(flatten)]
    world: WorldOption,
    #[command(flatten)]
    start: StartOption,
    /// Seed of all random numbers of the episode
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    agent: agent::Arguments,
    /// Play the commands of this log without sight: the floor of a board
    #[arg(long, value_name = "LOG", conflicts_with_all = ["agent", "policy", "path", "skill", "plan", "planner", "domain"])]
    tape: Option<PathBuf>,
    /// Inject a fault at its Nth occasion, or at one drawn from the seed: peg-dropped, peg-tilted,
    /// beam-slipped, beam-turned, beam-bumped, holder-shifted, jam, peg-missing, tag-covered, camera-frozen,
    /// gripper-weak, force-drift
    #[arg(long, value_name = "KIND[@N]")]
    fault: Option<Fault>,
    #[command(flatten)]
    station: station::Arguments,
    /// Show the twin in a window during the episode
    #[arg(long)]
    view: bool,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
    /// Also write the scene as MJCF, with keyframes `start` and `end`, for MuJoCo 3.13 or newer
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    pictures: pictures::Arguments,
    /// File for the result [default: results/GOAL-SEED.json]; the curve goes beside it as .svg, the log as
    /// .mcap
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace a result of another agent, arm, world, track or version
    #[arg(long)]
    force: bool,
    /// File for the log of the episode, for viewers and `ramp replay` [default: beside the result]
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Which of several runs in a row this is
    #[arg(long, default_value_t = 1, hide = true, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// Seed of the world that came of a secret and of the number given with --seed
    #[arg(long, hide = true, value_name = "SEED", requires = "secret")]
    world_seed: Option<u64>,
    /// Commitment of that secret
    #[arg(long, hide = true, value_name = "HEX", requires = "world_seed")]
    secret: Option<String>,
    /// Time on the wall after which the agent's work is ended and scored
    #[arg(long, hide = true, value_name = "SECONDS")]
    end_after: Option<u64>,
}

impl Arguments {
    /// Returns true if an external agent program runs.
    pub fn has_agent(&self) -> bool {
        self.agent.has_program()
    }
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    if let Some(file) = &arguments.station.robot {
        let inputs = station::Inputs {
            goal: &arguments.goal,
            track: arguments.track,
            world: &arguments.world,
            start: &arguments.start,
            seed: arguments.seed,
            agent: &arguments.agent,
            output: arguments.output.as_deref(),
            record: arguments.record.as_deref(),
            force: arguments.force,
            json: arguments.json,
            view: arguments.view,
            pictures: &arguments.pictures,
        };
        return station::run(data, file, &arguments.station, &inputs);
    }
    let end = arguments.end_after.and_then(|after| Instant::now().checked_add(Duration::from_secs(after)));
    let data = &arguments.arm.of(data)?;
    let (assembly, texts) = data.goal_with_texts(&arguments.goal)?;
    let arm = data.arm()?;
    let physics = arguments.world.read(data)?;
    let start = arguments.start.read(data)?;
    let agent_file = arguments.agent.file()?;
    let parts = arguments.agent.parts.read(data)?;
    let policy = arguments.agent.policy()?;
    let plan = parts.plan(&assembly)?;
    let output = match &arguments.output {
        Some(path) => path.clone(),
        None => Path::new(RESULTS).join(format!("{}-{}.json", assembly.name, arguments.seed)),
    };
    let curve = output.with_extension("svg");
    let log = arguments.record.clone().unwrap_or_else(|| output.with_extension(ramp_log::ENDING));
    check_places(&output, &curve, &log, arguments.scene.as_deref())?;
    let seed = arguments.world_seed.unwrap_or(arguments.seed);
    let setup = Setup {
        assembly: &assembly,
        arm: &arm,
        track: arguments.track.into(),
        seed,
        start: &start,
        world: &physics,
        fault: arguments.fault,
    };
    if !arguments.force {
        let known =
            Known { tape: arguments.tape.is_some(), file: agent_file.as_ref(), policy: policy.as_ref() };
        refuse_other(&output, &setup, arguments, &known.identity(&parts))?;
    }
    let sandbox =
        arguments.agent.sandbox(agent_file.as_ref().or(parts.planner.as_ref()), &[&output, &log])?;
    if let Some(sandbox) = &sandbox {
        agent::tell_open_ends(sandbox);
    }
    let mut window = if arguments.view { Some(Window::open(&setup)?) } else { None };
    let mut pictures = Pictures::new(&arguments.pictures, &setup)?;
    make_folder_of(&log)?;
    let display = Display::new(assembly.connections.len());
    let complete = Cell::new(false);
    let inputs = agent::AgentSetup {
        setup: setup.clone(),
        texts: &texts,
        parts: &parts,
        plan,
        policy: policy.as_ref(),
        asynchronous: arguments.agent.asynchronous,
        complete: &complete,
    };
    let robot_time = robot_time(data, &setup)?;
    let limit = arguments.agent.agent_limit;
    let mut agent: Box<dyn Agent + '_> = match &arguments.tape {
        Some(path) => Box::new(Tape::of(&Log::read(path).into_diagnostic()?).into_diagnostic()?),
        None => agent::start(&inputs, agent_file.as_ref(), sandbox, limit, end, |event| {
            display.event(event);
        })?,
    };
    let mut end = Vec::new();
    let mut watcher = |progress: &Progress, twin: &Twin| {
        display.progress(progress);
        complete.set(progress.seated == progress.pegs);
        if arguments.scene.is_some() {
            end.clear();
            end.extend_from_slice(twin.qpos());
        }
        if let Some(window) = &mut window {
            window.show(twin);
        }
        pictures.show(twin, &display.action(), progress);
    };
    let label = Label {
        software: software(),
        repeat: arguments.repeat,
        secret: arguments.secret.clone().map(|commitment| (arguments.seed, commitment)),
        robot_time,
    };
    let recorded = record_episode(&setup, &texts.sources(), agent.as_mut(), &label, &log, &mut watcher);
    display.finish();
    let Recorded { result, unlogged } = recorded.map_err(|error| match error {
        EpisodeError::Log(error) => MachineFault::of(error).into(),
        EpisodeError::Twin(error) => Report::msg(error),
    })?;
    // Write the result first.
    write_file(&output, result.to_json()).map_err(MachineFault::of)?;
    write_file(&curve, completion_svg(&result)).map_err(MachineFault::of)?;
    pictures.end()?;
    if let Some(path) = &arguments.scene {
        let start = Twin::new(&setup).into_diagnostic()?;
        let scene = start.export(ForMujoco::Newest, &[("start", start.qpos()), ("end", &end)]);
        write_file(path, &scene)?;
    }
    print(&if arguments.json { result.to_json() } else { summary(&result, [&output, &curve, &log]) })?;
    match unlogged {
        Some(error) => Err(MachineFault { what: format!("there is no log: {error}") }.into()),
        None if result.counted() == result.pegs.len() => Ok(DONE),
        None => Ok(INCOMPLETE),
    }
}

/// Checks that all files of a run can be written, and that the result does not overwrite another file.
fn check_places(output: &Path, curve: &Path, log: &Path, scene: Option<&Path>) -> Result<(), Report> {
    for (other, what) in [(curve, "curve"), (log, "log")] {
        if other == output {
            return Err(miette!(
                help = "end the file's name in .json",
                "{} is where the {what} goes",
                output.display()
            ));
        }
    }
    for path in [Some(output), Some(curve), Some(log), scene].into_iter().flatten() {
        check_place(path)?;
    }
    Ok(())
}

/// Rejects an output file that is not a result of this very episode and agent: it would be lost.
fn refuse_other(
    output: &Path,
    setup: &Setup,
    arguments: &Arguments,
    (name, sha256): &KnownIdentity,
) -> Result<(), Report> {
    if !output.exists() {
        return Ok(());
    }
    let software = software();
    let name = name.as_ref().map(|(name, version)| (name.as_str(), version.as_str()));
    let agent = Identity { name, sha256: sha256.as_deref(), asynchronous: arguments.agent.asynchronous };
    let (world, start) = (WorldLabel::of(setup.world).sha256, StartInfo::of(setup.start).sha256);
    let shared = Shared {
        arm: &setup.arm.name,
        worlds: vec![&world],
        start: &start,
        secret: arguments.secret.clone(),
        software: &software,
        agent,
    };
    let wanted = Wanted {
        goal: &setup.assembly.name,
        pegs: setup.assembly.connections.len(),
        track: setup.track.name(),
        world: &world,
        seed: arguments.seed,
        fault: setup.fault.map(|fault| fault.kind.name()),
    };
    let what = match shared.find(&wanted, &read_text(output, LARGEST).unwrap_or_default()) {
        Ok(Some(_)) => return Ok(()),
        Ok(None) => "another file".to_string(),
        Err(foreign) => format!("a result {foreign}"),
    };
    Err(miette!(
        help = "name another file with -o, or replace this one with --force",
        "{} exists already: {what}",
        output.display()
    ))
}

/// The agent, as far as it is known before it starts.
struct Known<'a> {
    tape: bool,
    file: Option<&'a AgentFile>,
    policy: Option<&'a PolicyServer>,
}

/// Name and version of an agent, if no program says them, and the hash of what it was read from.
type KnownIdentity = (Option<(String, String)>, Option<String>);

impl Known<'_> {
    /// The agent's identity; `parts` are those of the baseline.
    fn identity(&self, parts: &Parts) -> KnownIdentity {
        if let Some(file) = self.file {
            return (None, Some(file.sha256().to_string()));
        }
        if let Some(server) = self.policy {
            let it = server.metadata();
            return (Some((it.name.clone(), it.version.clone())), Some(it.sha256.clone()));
        }
        let own = match self.tape {
            true => (tape::NAME.to_string(), tape::VERSION.to_string()),
            false => parts.name(),
        };
        (Some(own), parts.parameters.sha256.clone())
    }
}

/// Bound and reference of the robot time, if the baseline has a plan for the goal.
fn robot_time(data: &Data, setup: &Setup) -> Result<Option<RobotTime>, Report> {
    let times = reference_times_of_goal(setup.assembly, setup.arm, &domains(data, None)?);
    Ok(times.ok().map(|ReferenceTimes { bound, reference }| RobotTime { bound, reference }))
}

/// The result as text.
pub fn summary(result: &EpisodeResult, [output, curve, log]: [&Path; 3]) -> String {
    let name = |named: Option<&String>| named.map_or("none", String::as_str).to_string();
    let place = match &result.real {
        Some(real) => format!("{}, track {}, repeat {}", real.kind.words(), result.track, result.repeat),
        None => format!(
            "arm {}, world {}, start {}, track {}, seed {}",
            name(result.arm.as_ref()),
            name(result.world.as_ref().map(|world| &world.name)),
            name(result.start.as_ref().map(|start| &start.name)),
            result.track,
            result.seed
        ),
    };
    let pegs = result.pegs.len();
    let mut text = format!("{}, {place}: {} of {pegs} pegs\n", result.goal, result.counted());
    for (index, peg) in result.pegs.iter().enumerate() {
        let _ = match peg {
            Some(peg) => writeln!(
                text,
                "  {:<4} {} in {}  {:<4} seated at {:6.1} s",
                peg.connection, peg.joints[1], peg.joints[0], peg.peg, peg.t_total
            ),
            None => writeln!(text, "  connection {} has no peg that counts", index + 1),
        };
    }
    for rejected in &result.rejected {
        let _ = writeln!(text, "  does not count: {rejected}");
    }
    let time = &result.time;
    let _ = writeln!(
        text,
        "time {:.1} s = planning {:.2} + computing {:.2} + robot {:.1}",
        time.total, time.planning, time.compute, time.robot
    );
    if let Some(share) = time.waiting.filter(|_| time.is_loaded()) {
        let _ = writeln!(
            text,
            "the machine was loaded: the program waited {:.0} % of its time for a processor, and planning and \
             computing took longer than on an idle machine",
            100.0 * share
        );
    }
    if let Some(RobotTime { bound, reference }) = result.robot_time {
        let _ = writeln!(
            text,
            "robot time of the baseline's plan: bound {bound:.1} s, reference {reference:.1} s"
        );
    }
    if result.ended.reason != "done" {
        let _ = writeln!(text, "ended early: {}", result.ended.reason);
    }
    if let Some(fault) = &result.fault {
        let struck = fault.at.map_or_else(|| "never".to_string(), |at| format!("{at:.1} s"));
        let _ = writeln!(text, "fault {}@{}, struck {struck}: {}", fault.kind, fault.occasion, fault.text);
    }
    if let Some(physics) = &result.physics {
        let _ = writeln!(
            text,
            "deepest penetration {:.2} mm, largest force {:.0} N",
            physics.deepest_penetration * 1e3,
            physics.largest_force
        );
    }
    let _ = writeln!(text, "result: {}", output.display());
    let _ = writeln!(text, "curve:  {}\nlog:    {}", curve.display(), log.display());
    let folder = output.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    if result.real.is_none() {
        let film = log.with_extension("gif");
        let _ = writeln!(text, "film:   ramp replay {} --video {}", log.display(), film.display());
    }
    let _ = writeln!(text, "report: ramp report {} -o report.html", folder.display());
    text
}

/// Progress on standard error: one moving line on a terminal, a line for each action elsewhere.
pub struct Display {
    bar: Option<ProgressBar>,
    action: RefCell<String>,
}

impl Display {
    /// `pegs` is the number of pegs in the goal.
    pub fn new(pegs: usize) -> Display {
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::new(pegs as u64);
            if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len} pegs  {msg}") {
                bar.set_style(style);
            }
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        Display { bar, action: RefCell::new("planning".to_string()) }
    }

    /// The agent's current action.
    pub fn action(&self) -> String {
        self.action.borrow().clone()
    }

    pub fn event(&self, event: &Event) {
        let line = || format!("{:7.1} s  {}: {}", event.time, event.kind.name(), event.kind);
        match (&self.bar, &event.kind) {
            (_, EventKind::ActionBegun(action)) => *self.action.borrow_mut() = action.to_string(),
            (None, EventKind::ActionEnded(action)) => tell(&format!("{:7.1} s  {action}", event.time)),
            (Some(_), EventKind::ActionEnded(_)) => {}
            (Some(bar), _) => bar.println(line()),
            (None, _) => tell(&line()),
        }
    }

    pub fn progress(&self, progress: &Progress) {
        if let Some(bar) = &self.bar {
            bar.set_position(progress.seated as u64);
            bar.set_message(format!("{:.1} s  {}", progress.time, self.action.borrow()));
        }
    }

    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(feature = "view")]
use ramp_twin::view::Window as TwinWindow;

/// The live window, if the program was built with it.
pub struct Window {
    #[cfg(feature = "view")]
    inner: TwinWindow,
}

impl Window {
    #[cfg(feature = "view")]
    pub fn open(setup: &Setup) -> Result<Window, Report> {
        let inner = TwinWindow::open(setup).map_err(|error| {
            miette!(help = "is there a display? without one, leave --view out", "{error}")
        })?;
        Ok(Window { inner })
    }

    #[cfg(not(feature = "view"))]
    pub fn open(_: &Setup) -> Result<Window, Report> {
        Err(miette!(
            help = "build it with `cargo build --release --features view` (needs OpenGL and a display), or leave --view out",
            "this program was built without a window"
        ))
    }

    #[cfg_attr(not(feature = "view"), allow(clippy::unused_self, unused_variables))]
    pub fn show(&mut self, twin: &Twin) {
        #[cfg(feature = "view")]
        self.inner.show(twin);
    }
}
