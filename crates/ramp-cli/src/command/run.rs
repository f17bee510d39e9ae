//! `ramp run`: plans a goal, assembles it in the twin, and scores it.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use miette::{IntoDiagnostic, Report, miette};
use ramp_data::Data;
use ramp_episode::{EpisodeError, Label, Progress, Recorded, Tape, check_given, record_episode, tape};
use ramp_external_agent::AgentFile;
use ramp_kit::source::read_text;
use ramp_log::Log;
use ramp_policy_client::PolicyServer;
use ramp_report::curve::completion_svg;
use ramp_result::collection::LARGEST;
use ramp_result::episode::{RobotTime, StartInfo, WorldLabel};
use ramp_result::resume::{Identity, Shared, Wanted};
use ramp_robot::Agent;
use ramp_skills::{ReferenceTimes, reference_times_of_goal};
use ramp_twin::{Fault, ForMujoco, Setup, Twin};

use crate::command::agent;
use crate::command::parts::Parts;
use crate::command::run_view::{Display, Window, summary};
use crate::command::station;
use crate::command::task::{self, state_hash};
use crate::options::{ArmOption, StartOption, TrackName, WorldOption};
use crate::output::{check_place, make_folder_of, print, write_file};
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
    #[command(flatten)]
    task: task::Arguments,
    /// Seed of all random numbers of the episode
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    agent: agent::Arguments,
    /// Play the commands of this log without sight: the floor of a board
    #[arg(long, value_name = "LOG", conflicts_with_all = ["agent", "policy", "path", "skill", "plan", "planner", "finder", "domain"])]
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

    fn for_station(&self) -> station::Inputs<'_> {
        station::Inputs {
            goal: &self.goal,
            track: self.track,
            world: &self.world,
            start: &self.start,
            seed: self.seed,
            agent: &self.agent,
            output: self.output.as_deref(),
            record: self.record.as_deref(),
            force: self.force,
            json: self.json,
            view: self.view,
            pictures: &self.pictures,
        }
    }
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    match &arguments.station.robot {
        Some(file) => station::run(data, file, &arguments.station, &arguments.for_station()),
        None => in_twin(data, arguments),
    }
}

fn in_twin(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    let end = arguments.end_after.and_then(|after| Instant::now().checked_add(Duration::from_secs(after)));
    let data = &arguments.arm.of(data)?;
    let (assembly, texts) = data.goal_with_texts(&arguments.goal)?;
    let arm = data.arm()?;
    let physics = arguments.world.read(data)?;
    let start = arguments.start.read(data)?;
    let state = arguments.task.state(&assembly, &start, &arguments.agent)?;
    let agent_file = arguments.agent.file()?;
    let parts = arguments.agent.parts.read(data, arguments.track.into())?;
    let policy = arguments.agent.policy()?;
    let plan = parts.plan(&assembly)?;
    let output = match &arguments.output {
        Some(path) => path.clone(),
        None => Path::new(RESULTS).join(format!("{}-{}.json", assembly.name, arguments.seed)),
    };
    let curve = output.with_extension("svg");
    let log = arguments.record.clone().unwrap_or_else(|| output.with_extension(ramp_log::ENDING));
    check_places(&output, &curve, &log, arguments.scene.as_deref())?;
    let setup = Setup {
        assembly: &assembly,
        arm: &arm,
        track: arguments.track.into(),
        seed: arguments.world_seed.unwrap_or(arguments.seed),
        start: &start,
        state: state.as_ref(),
        task: arguments.task.task(),
        world: &physics,
        fault: arguments.fault,
    };
    check_given(&setup).into_diagnostic()?;
    if !arguments.force {
        let known =
            Known { tape: arguments.tape.is_some(), file: agent_file.as_ref(), policy: policy.as_ref() };
        refuse_other(&output, &setup, arguments, &known.identity(&parts))?;
    }
    let sandboxes = arguments.agent.sandboxes(agent_file.as_ref(), &parts, &[&output, &log])?;
    let mut window = if arguments.view { Some(Window::open(&setup)?) } else { None };
    let mut pictures = Pictures::new(&arguments.pictures, &setup)?;
    make_folder_of(&log)?;
    let display = Display::new(assembly.wanted(setup.task), setup.task.unit());
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
        None => agent::start(&inputs, agent_file.as_ref(), sandboxes, limit, end, |event| {
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
    arguments.scene.as_deref().map_or(Ok(()), |path| write_scene(path, &setup, &end))?;
    print(&if arguments.json { result.to_json() } else { summary(&result, [&output, &curve, &log]) })?;
    match unlogged {
        Some(error) => Err(MachineFault { what: format!("there is no log: {error}") }.into()),
        None if result.counted() == result.wanted() => Ok(DONE),
        None => Ok(INCOMPLETE),
    }
}

/// Writes the scene with the positions at the start and at the end.
fn write_scene(path: &Path, setup: &Setup, end: &[f64]) -> Result<(), Report> {
    let start = Twin::new(setup).into_diagnostic()?;
    let scene = start.export(ForMujoco::Newest, &[("start", start.qpos()), ("end", end)]);
    write_file(path, &scene)
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
    let state = setup.state.map(state_hash);
    let shared = Shared {
        arm: &setup.arm.name,
        worlds: vec![&world],
        start: &start,
        states: vec![state.as_deref()],
        secret: arguments.secret.clone(),
        software: &software,
        agent,
    };
    let wanted = Wanted {
        goal: &setup.assembly.name,
        task: setup.task.told(),
        state: state.as_deref(),
        count: setup.assembly.wanted(setup.task),
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

/// Bound and reference of the robot time, if the baseline has a plan for the goal. They hold where nothing is
/// built at the start.
fn robot_time(data: &Data, setup: &Setup) -> Result<Option<RobotTime>, Report> {
    if setup.state.is_some() {
        return Ok(None);
    }
    let times = reference_times_of_goal(setup.assembly, setup.arm, &domains(data, None)?);
    Ok(times.ok().map(|ReferenceTimes { bound, reference }| RobotTime { bound, reference }))
}
