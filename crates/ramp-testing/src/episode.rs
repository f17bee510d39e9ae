//! Whole episodes: of the baseline, which always knows its track, and of small agents; with and without a
//! log.

use std::path::Path;
use std::sync::LazyLock;

use ramp_episode::{Label, record_episode, run_episode};
use ramp_log::Sources;
use ramp_planner::Domains;
use ramp_result::EpisodeResult;
use ramp_result::episode::Software;
use ramp_robot::{
    Account, Action, Agent, ArmCommand, Command, Event, EventKind, GripperCommand, Robot, RobotError, Track,
};
use ramp_skills::Baseline;
use ramp_twin::{Setup, Start, World};

use crate::data;
use crate::goal::GoalFiles;

/// The domains of the project.
pub fn domains() -> &'static Domains {
    static DOMAINS: LazyLock<Domains> = LazyLock::new(|| Domains::read(&data().join("domains")).unwrap());
    &DOMAINS
}

/// The program in an episode's result.
#[must_use]
pub fn label() -> Label {
    Label::new(Software { version: "test".into(), commit: "test".into() }, 1)
}

impl GoalFiles {
    /// The baseline for a track.
    #[must_use]
    pub fn baseline(&self, track: Track, seed: u64) -> Baseline<'_> {
        Baseline::new(&self.assembly, &self.arm, domains(), seed).on_track(track).from_start(Start::sheet())
    }

    /// An episode of the baseline in the world `ideal`.
    #[must_use]
    pub fn run(&self, track: Track, seed: u64) -> EpisodeResult {
        self.run_setup(&self.setup(track, seed))
    }

    /// An episode of the baseline in a world.
    #[must_use]
    pub fn run_in(&self, world: &World, track: Track, seed: u64) -> EpisodeResult {
        self.run_setup(&Setup { world, ..self.setup(track, seed) })
    }

    /// An episode of the baseline from a start.
    #[must_use]
    pub fn run_setup(&self, setup: &Setup) -> EpisodeResult {
        let mut agent = self.baseline(setup.track, setup.seed).from_start(setup.start).with_task(setup.task);
        run_episode(setup, &mut agent, &label(), &mut |_, _| {}).unwrap()
    }

    /// An episode of an agent from a start, with its log.
    pub fn record(&self, setup: &Setup, agent: &mut dyn Agent, path: &Path) -> EpisodeResult {
        let read = |name: &str| std::fs::read_to_string(data().join(name)).unwrap();
        let goal = read(&format!("goals/{}.xml", self.assembly.name));
        let (kit, arm) = (read("kit.xml"), read("arms/panda.json"));
        let sources = Sources { goal: &goal, kit: &kit, arm: &arm };
        let recorded = record_episode(setup, &sources, agent, &label(), path, &mut |_, _| {}).unwrap();
        assert!(recorded.unlogged.is_none());
        recorded.result
    }

    /// An episode of an agent on the track `noisy`, with its log.
    pub fn record_noisy(&self, agent: &mut dyn Agent, path: &Path) -> EpisodeResult {
        self.record(&self.setup(Track::Noisy, 3), agent, path)
    }
}

/// An agent that swings one joint for this many periods. It reads the parts every half second.
pub struct Swing(pub u32);

impl Agent for Swing {
    fn name(&self) -> (&str, &str) {
        ("swing", "1")
    }

    fn account(&self) -> Account {
        let event = Event::new(0.1, EventKind::ActionBegun(Action::new("swing")));
        Account { events: vec![event], ..Account::default() }
    }

    fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError> {
        let home = robot.observe().positions;
        for period in 0..self.0 {
            let mut positions = home;
            positions[0] += 0.1 * (1.0 - (f64::from(period) * 1e-3).cos());
            let arm = ArmCommand::JointPositions(positions);
            robot.step(&Command { arm, gripper: GripperCommand { width: 0.05, force: 20.0 } })?;
            if period % 500 == 250 {
                robot.read_parts()?;
            }
        }
        Ok(())
    }
}
