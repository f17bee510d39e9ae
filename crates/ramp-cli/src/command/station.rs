//! `ramp run --robot`: the same agent at a station, over the wire of its arm.

use std::path::{Path, PathBuf};

use crate::command::agent;
use crate::options::{StartOption, TrackName, WorldOption};
use crate::pictures;

#[derive(clap::Args)]
pub struct Arguments {
    /// Drive the arm of this station file, and not the twin in this program
    #[arg(long, value_name = "FILE", conflicts_with_all = ["arm", "tape", "fault", "scene", "secret", "state", "task"])]
    pub robot: Option<PathBuf>,
    /// With --robot: let the twin do it, with that arm and its walls, for --view or --video; nothing is
    /// connected, and no result is written
    #[arg(long, requires = "robot")]
    dry_run: bool,
    /// With --robot: wait for Enter before each action
    #[arg(long, requires = "robot", conflicts_with = "dry_run")]
    step: bool,
    /// With --robot: put the images that the agent takes into the log
    #[arg(long, requires = "robot", conflicts_with = "dry_run")]
    images: bool,
    /// With --robot: do not ask before the arm moves; for a served twin on this machine
    #[arg(long, requires = "robot")]
    yes: bool,
}

/// The other arguments of `ramp run` that matter at a station.
#[cfg_attr(not(feature = "franka"), expect(dead_code, reason = "without the wire there is no station"))]
pub struct Inputs<'a> {
    pub goal: &'a str,
    pub track: TrackName,
    pub world: &'a WorldOption,
    pub start: &'a StartOption,
    pub seed: u64,
    pub agent: &'a agent::Arguments,
    pub output: Option<&'a Path>,
    pub record: Option<&'a Path>,
    pub force: bool,
    pub json: bool,
    pub view: bool,
    pub pictures: &'a pictures::Arguments,
}

#[cfg(not(feature = "franka"))]
pub fn run(_: &ramp_data::Data, _: &Path, _: &Arguments, _: &Inputs) -> Result<u8, miette::Report> {
    Err(super::serve::built_without())
}

#[cfg(feature = "franka")]
pub use with_wire::run;

#[cfg(feature = "franka")]
mod with_wire {
    use std::cell::Cell;
    use std::io::IsTerminal;
    use std::path::{Path, PathBuf};

    use miette::{IntoDiagnostic, Report, miette};
    use ramp_assembly::Task;
    use ramp_calibration::Calibration;
    use ramp_data::Data;
    use ramp_episode::{Label, Progress, run_episode};
    use ramp_franka::cameras::LocalCameras;
    use ramp_franka::station::Station;
    use ramp_franka::{FrankaRobot, Pace, Statistics};
    use ramp_real_run::drive::{Driven, Guard, Run, Workspace, drive};
    use ramp_report::curve::completion_svg;
    use ramp_result::episode::{EpisodeResult, RobotKind};
    use ramp_robot::arm::ArmModel;
    use ramp_robot::{Account, Agent, Camera, CameraModel, Event, EventKind, Robot, RobotError, Track};
    use ramp_twin::{Setup, Twin};

    use super::{Arguments, Inputs};
    use crate::command::agent::{self, AgentSetup};
    use crate::command::run_view::{Display, Window, summary};
    use crate::ending;
    use crate::output::{check_place, make_folder_of, print, tell, write_file};
    use crate::pictures::Pictures;
    use crate::software::software;
    use crate::status::{DONE, INCOMPLETE, MachineFault};

    /// Default folder for results.
    const RESULTS: &str = "results/station";
    /// A person's answers.
    const YES: &str = "yes";
    const QUIT: &str = "q";
    /// Why a run ends when a person stops it.
    const BY_PERSON: &str = "a person stopped the run";

    pub fn run(data: &Data, file: &Path, arguments: &Arguments, inputs: &Inputs) -> Result<u8, Report> {
        let station = Station::read(file)?;
        let kind = kind_of(&station);
        let asks = !arguments.yes && !arguments.dry_run;
        let repeat = checked(&station, file, arguments, inputs)?;
        let data = &data.with_arm(&station.arm)?;
        let (assembly, texts) = data.goal_with_texts(inputs.goal)?;
        let arm = data.arm()?;
        let slowed = slowed(&arm, station.speed);
        let (world, start) = (inputs.world.read(data)?, inputs.start.read(data)?);
        let parts = inputs.agent.parts.read(data, inputs.track.into())?;
        let agent_file = inputs.agent.file()?;
        let policy = inputs.agent.policy()?;
        let output = inputs.output.map_or_else(
            || Path::new(RESULTS).join(format!("{}-{repeat}.json", assembly.name)),
            Path::to_path_buf,
        );
        let log = inputs.record.map_or_else(|| output.with_extension(ramp_log::ENDING), Path::to_path_buf);
        check_places(&output, &log, inputs.force, arguments.dry_run)?;
        let models = station.calibration.as_deref().map(models_of).transpose()?;
        let setup = Setup {
            assembly: &assembly,
            arm: &slowed,
            track: inputs.track.into(),
            seed: inputs.seed,
            start: &start,
            world: &world,
            state: None,
            task: Task::Build,
            fault: None,
        };
        let track = Track::from(inputs.track);
        if station.cameras.is_some() && track.has_depth() {
            let help = "the same without depth is the track `colour`";
            return Err(miette!(help = help, "the cameras of this station give no depth"));
        }
        let workspace = Workspace { low: station.low, high: station.high };
        let sandboxes = inputs.agent.sandboxes(agent_file.as_ref(), &parts, &[&output, &log])?;
        ending::defer_requests();
        let (display, complete, quit) =
            (Display::new(assembly.connections.len(), "pegs"), Cell::new(false), Cell::new(false));
        let inside = AgentSetup {
            setup: setup.clone(),
            texts: &texts,
            parts: &parts,
            plan: parts.plan(&assembly)?,
            policy: policy.as_ref(),
            asynchronous: inputs.agent.asynchronous,
            complete: &complete,
        };
        let listen = |event: &Event| {
            display.event(event);
            if arguments.step
                && let EventKind::ActionBegun(action) = &event.kind
            {
                let question = format!("next: {action}; Enter goes on, {QUIT} stops: ");
                quit.set(quit.get() || display.pause(|| ask(&question)) == QUIT);
            }
        };
        let limit = inputs.agent.agent_limit;
        let mut agent = agent::start(&inside, agent_file.as_ref(), sandboxes, limit, None, listen)?;
        let stop = || (quit.get() || ending::requested().is_some()).then(|| BY_PERSON.to_string());
        if arguments.dry_run {
            let mut guarded =
                Guarded { agent: agent.as_mut(), arms: [&arm, &slowed], workspace, stop: &stop };
            return dry_run(&setup, &mut guarded, &display, inputs);
        }
        if asks && !display.pause(|| confirmed(&station, file, &workspace)) {
            tell("nothing has moved");
            return Ok(INCOMPLETE);
        }
        make_folder_of(&log)?;
        let cameras = cameras(&station, models.as_ref())?;
        let mut robot = FrankaRobot::connect(&station.connection, &arm, &station.controller, track)
            .map_err(|error| miette!(help = HELP, "{error}"))?;
        robot = match (cameras, models) {
            (Some(cameras), _) => robot.with_cameras(cameras),
            (None, Some(models)) => robot.with_models(models),
            (None, None) => robot,
        };
        let run = Run {
            assembly: &assembly,
            arm: &arm,
            told: &slowed,
            track,
            repeat,
            kind,
            robot: &station.robot,
            scorer: &station.scorer,
            source: &station.source,
            software: &software(),
            workspace: &workspace,
            images: arguments.images,
        };
        let driven = drive(&run, &mut robot, agent.as_mut(), &stop, &log).map_err(MachineFault::of)?;
        display.finish();
        report(&driven, &robot.statistics(), [&output, &log], inputs.json)
    }

    /// Refuses what a station does not do. Returns the number of the run.
    fn checked(
        station: &Station,
        file: &Path,
        arguments: &Arguments,
        inputs: &Inputs,
    ) -> Result<u32, Report> {
        let asks = !arguments.yes && !arguments.dry_run;
        if arguments.yes && !station.is_loopback() {
            return Err(miette!(
                help = "leave --yes out, and stand beside the arm",
                "--yes is for a served twin on this machine, and the arm of {} is at {}",
                file.display(),
                station.connection.arm
            ));
        }
        if (asks || arguments.step) && !std::io::stdin().is_terminal() {
            return Err(miette!(
                help = "run it on a terminal; for a served twin on this machine, --yes answers",
                "a person has to be asked before the arm moves, and there is no terminal"
            ));
        }
        if !arguments.dry_run && (inputs.view || inputs.pictures.any()) {
            return Err(miette!(
                help = "add --dry-run, or leave them out",
                "--view, --video and --rerun show the twin, and a station has none"
            ));
        }
        let repeat = u32::try_from(inputs.seed).ok().filter(|repeat| (1..=100_000).contains(repeat));
        repeat.ok_or_else(|| {
            miette!("the number of a run at a station is {}, expected --seed 1 to 100000", inputs.seed)
        })
    }

    /// The calibrated models of both cameras.
    fn models_of(file: &Path) -> Result<[CameraModel; 2], Report> {
        let calibration = Calibration::read(file)?;
        let model = |camera: Camera| {
            let model = calibration.camera(camera);
            model.ok_or_else(|| {
                let steps = match camera {
                    Camera::Wrist => "`ramp calibrate lens` and `ramp calibrate hand-eye`",
                    Camera::BirdsEye => {
                        "`ramp calibrate lens --camera birds-eye` and `ramp calibrate birds-eye`"
                    }
                };
                miette!(
                    help = format!("make it with {steps}"),
                    "{}: the lens or the pose of the camera `{}` is missing",
                    file.display(),
                    camera.name()
                )
            })
        };
        let [first, second] = Camera::ALL.map(model);
        Ok([first?, second?])
    }

    /// The cameras of this computer, if the station has any.
    fn cameras(station: &Station, models: Option<&[CameraModel; 2]>) -> Result<Option<LocalCameras>, Report> {
        let Some((devices, models)) = station.cameras.as_ref().zip(models) else { return Ok(None) };
        let help = "which formats does it have? `v4l2-ctl --list-formats-ext -d DEVICE` lists them";
        let opened = LocalCameras::open(devices, models.clone());
        opened.map(Some).map_err(|error| miette!(help = help, "{error}"))
    }

    const HELP: &str =
        "is the arm on, unlocked and in FCI mode? a served twin is started with `ramp twin serve GOAL`";

    /// Without a cell it is an arm; a cell is a served twin's.
    fn kind_of(station: &Station) -> RobotKind {
        match (station.connection.cell.is_some(), station.connection.pace) {
            (false, Pace::RealTime) => RobotKind::Arm,
            (true, Pace::RealTime) => RobotKind::ServedTwin,
            (_, Pace::LockStep) => RobotKind::ServedTwinInLockStep,
        }
    }

    /// The arm as agents are told of it: slower.
    fn slowed(arm: &ArmModel, speed: f64) -> ArmModel {
        let mut slowed = arm.clone();
        slowed.joints.iter_mut().for_each(|joint| joint.velocity *= speed);
        slowed
    }

    fn check_places(output: &Path, log: &Path, force: bool, dry_run: bool) -> Result<(), Report> {
        if dry_run {
            return Ok(());
        }
        if output == log {
            return Err(miette!(
                help = "end the file's name in .json",
                "{} is where the log goes",
                log.display()
            ));
        }
        for path in [output, log] {
            check_place(path)?;
            if path.exists() && !force {
                return Err(miette!(
                    help = "number the run with --seed, name another file with -o, or replace this one with --force",
                    "{} exists already",
                    path.display()
                ));
            }
        }
        Ok(())
    }

    /// Asks on the terminal, and returns the answer.
    fn ask(question: &str) -> String {
        tell(question);
        let mut line = String::new();
        // No answer is no.
        if std::io::stdin().read_line(&mut line).unwrap_or_default() == 0 {
            return QUIT.to_string();
        }
        line.trim().to_string()
    }

    /// Tells what will move, and asks whether it may.
    fn confirmed(station: &Station, file: &Path, workspace: &Workspace) -> bool {
        let Workspace { low, high } = workspace;
        tell(&format!(
            "{} at {} ({}) will move, at {:.0} % of its speed, with the tip in x {:.2} to {:.2}, y {:.2} to {:.2}, z {:.2} \
             to {:.2} m.\nIs the emergency stop in your hand, the table as the sheet shows it, and nobody within reach?",
            station.robot,
            station.connection.arm,
            file.display(),
            100.0 * station.speed,
            low[0],
            high[0],
            low[1],
            high[1],
            low[2],
            high[2]
        ));
        ask(&format!("`{YES}` begins, anything else ends: ")) == YES
    }

    /// An agent whose robot is guarded.
    struct Guarded<'a> {
        agent: &'a mut dyn Agent,
        arms: [&'a ArmModel; 2],
        workspace: Workspace,
        stop: &'a dyn Fn() -> Option<String>,
    }

    impl Agent for Guarded<'_> {
        fn name(&self) -> (&str, &str) {
            self.agent.name()
        }

        fn account(&self) -> Account {
            self.agent.account()
        }

        fn failure(&self) -> Option<String> {
            self.agent.failure()
        }

        fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError> {
            self.agent.run(&mut Guard::new(robot, self.arms, &self.workspace, self.stop))
        }

        fn finish(&mut self) {
            self.agent.finish();
        }
    }

    /// Runs the agent in the twin, with the station's arm and walls.
    fn dry_run(setup: &Setup, agent: &mut Guarded, display: &Display, inputs: &Inputs) -> Result<u8, Report> {
        let mut window = if inputs.view { Some(Window::open(setup)?) } else { None };
        let mut pictures = Pictures::new(inputs.pictures, setup)?;
        let label = Label::new(software(), 1);
        let mut watcher = |progress: &Progress, twin: &Twin| {
            display.progress(progress);
            if let Some(window) = &mut window {
                window.show(twin);
            }
            pictures.show(twin, &display.action(), progress);
        };
        let result = run_episode(setup, agent, &label, &mut watcher).into_diagnostic()?;
        display.finish();
        pictures.end()?;
        print(&format!(
            "dry run in the twin, world {}: {} of {} pegs in {:.1} s; {}\n",
            setup.world.name,
            result.counted(),
            result.pegs.len(),
            result.time.robot,
            result.ended.reason
        ))?;
        Ok(status(&result))
    }

    fn status(result: &EpisodeResult) -> u8 {
        if result.counted() == result.pegs.len() { DONE } else { INCOMPLETE }
    }

    fn report(
        driven: &Driven,
        statistics: &Statistics,
        [output, log]: [&PathBuf; 2],
        json: bool,
    ) -> Result<u8, Report> {
        let result = &driven.result;
        let curve = output.with_extension("svg");
        write_file(output, result.to_json()).map_err(MachineFault::of)?;
        write_file(&curve, completion_svg(result)).map_err(MachineFault::of)?;
        if json {
            print(&result.to_json())?;
            return Ok(status(result));
        }
        if let Some(error) = &driven.unmeasured {
            tell(&format!("the frame was not measured: {error}"));
        }
        let Statistics { periods, late, longest, gaps } = statistics;
        print(&format!(
            "{}{periods} control periods, {late} without a new command in time, {longest} in a row at most; {gaps} states \
             not a millisecond after the one before\n",
            summary(result, [output, &curve, log]),
        ))?;
        Ok(status(result))
    }
}
