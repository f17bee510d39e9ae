//! Common helpers of the tests of whole episodes.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use ramp_assembly::Assembly;
use ramp_episode::{Label, run_episode};
use ramp_log::calls::{Decoder, Encoder, Entry};
use ramp_planner::Domains;
use ramp_result::EpisodeResult;
use ramp_result::episode::Software;
use ramp_robot::Track;
use ramp_robot::arm::ArmModel;
use ramp_skills::Baseline;
use ramp_twin::{Disturbance, Setup};

/// The files of one goal.
pub struct World {
    pub assembly: Assembly,
    pub arm: ArmModel,
    pub domains: Domains,
}

pub fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

impl World {
    pub fn new(goal: &str) -> World {
        let kit = ramp_kit::read_kit(&data().join("kit.xml")).unwrap();
        let assembly = ramp_assembly::read_goal(&data().join(format!("goals/{goal}.xml")), &kit).unwrap();
        let arm = ArmModel::read(&data().join("arms/panda.json")).unwrap();
        let domains = Domains::read(&data().join("domains")).unwrap();
        World { assembly, arm, domains }
    }

    #[allow(dead_code)]
    pub fn setup(&self, seed: u64) -> Setup<'_> {
        self.setup_on(Track::State, seed)
    }

    pub fn setup_on(&self, track: Track, seed: u64) -> Setup<'_> {
        Setup {
            assembly: &self.assembly,
            arm: &self.arm,
            track,
            seed,
            disturbance: Disturbance::default(),
            world: ramp_twin::World::ideal(),
            fault: None,
        }
    }

    #[allow(dead_code)]
    pub fn run(&self, seed: u64) -> EpisodeResult {
        self.run_on(Track::State, seed)
    }

    #[allow(dead_code)]
    pub fn run_on(&self, track: Track, seed: u64) -> EpisodeResult {
        self.run_in(ramp_twin::World::ideal(), track, seed)
    }

    /// An episode of the baseline in a world.
    #[allow(dead_code)]
    pub fn run_in(&self, world: &ramp_twin::World, track: Track, seed: u64) -> EpisodeResult {
        let baseline = Baseline::new(&self.assembly, &self.arm, &self.domains, seed);
        let mut agent = baseline.on_track(track);
        let software = Software { version: "test".into(), commit: "test".into() };
        let setup = Setup { world, ..self.setup_on(track, seed) };
        run_episode(&setup, &mut agent, &Label::new(software, 1), &mut |_, _| {}).unwrap()
    }
}

/// An agent that swings a joint and reads the parts, for a number of periods.
#[allow(dead_code)]
pub struct Swing(pub u32);

impl ramp_robot::Agent for Swing {
    fn name(&self) -> (&str, &str) {
        ("swing", "1")
    }

    fn account(&self) -> ramp_robot::Account {
        let kind = ramp_robot::EventKind::ActionBegun(ramp_robot::Action::new("swing"));
        let event = ramp_robot::Event::new(0.1, kind);
        ramp_robot::Account { events: vec![event], ..ramp_robot::Account::default() }
    }

    fn run(&mut self, robot: &mut dyn ramp_robot::Robot) -> Result<(), ramp_robot::RobotError> {
        let home = robot.observe().positions;
        for period in 0..self.0 {
            let mut positions = home;
            positions[0] += 0.1 * (1.0 - (f64::from(period) * 1e-3).cos());
            let command = ramp_robot::Command {
                arm: ramp_robot::ArmCommand::JointPositions(positions),
                gripper: ramp_robot::GripperCommand { width: 0.05, force: 20.0 },
            };
            robot.step(&command)?;
            if period % 500 == 250 {
                robot.read_parts()?;
            }
        }
        Ok(())
    }
}

impl World {
    /// A log of a short episode on the track `noisy`.
    #[allow(dead_code)]
    pub fn record(&self, goal: &str, agent: &mut dyn ramp_robot::Agent, path: &Path) -> EpisodeResult {
        self.record_on(Track::Noisy, 3, goal, agent, path)
    }

    /// A log of an episode.
    #[allow(dead_code)]
    pub fn record_on(
        &self,
        track: Track,
        seed: u64,
        goal: &str,
        agent: &mut dyn ramp_robot::Agent,
        path: &Path,
    ) -> EpisodeResult {
        let read = |name: &str| std::fs::read_to_string(data().join(name)).unwrap();
        let (goal, kit, arm) = (read(&format!("goals/{goal}.xml")), read("kit.xml"), read("arms/panda.json"));
        let sources = ramp_log::Sources { goal: &goal, kit: &kit, arm: &arm };
        let software = Software { version: "test".into(), commit: "test".into() };
        let setup = self.setup_on(track, seed);
        let label = Label::new(software, 1);
        let recorded = ramp_episode::record_episode(&setup, &sources, agent, &label, path, &mut |_, _| {});
        let recorded = recorded.unwrap();
        assert!(recorded.unlogged.is_none());
        recorded.result
    }
}

/// The messages of a log, by topic, to be changed and written again.
#[allow(dead_code)]
pub fn messages(bytes: &[u8]) -> Vec<(String, Vec<u8>)> {
    mcap::MessageStream::new(bytes)
        .unwrap()
        .map(|message| message.unwrap())
        .map(|message| (message.channel.topic.clone(), message.data.into_owned()))
        .collect()
}

/// A file of these messages.
#[allow(dead_code)]
pub fn as_log(messages: &[(String, Vec<u8>)]) -> Vec<u8> {
    write_log(messages, mcap::WriteOptions::new())
}

/// The same, written in some way.
#[allow(dead_code)]
pub fn write_log(messages: &[(String, Vec<u8>)], options: mcap::WriteOptions) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut file = options.compression_threads(0).create(&mut bytes).unwrap();
    let mut channels = std::collections::BTreeMap::new();
    for (topic, data) in messages {
        let encoding = if topic == "/calls" { ramp_log::CALLS } else { "json" };
        let channel_id = *channels.entry(topic.clone()).or_insert_with(|| {
            file.add_channel(0, topic, encoding, &std::collections::BTreeMap::new()).unwrap()
        });
        let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time: 0, publish_time: 0 };
        file.write_to_known_channel(&header, data).unwrap();
    }
    file.finish().unwrap();
    drop(file);
    bytes.into_inner()
}

/// The entries of a log's calls.
#[allow(dead_code)]
pub fn entries(bytes: &[u8]) -> Vec<Entry> {
    let calls: Vec<u8> = messages(bytes)
        .iter()
        .filter(|(topic, _)| topic == "/calls")
        .flat_map(|(_, data)| data.clone())
        .collect();
    Decoder::new(&calls).map(Result::unwrap).collect()
}

/// A log with other calls.
#[allow(dead_code)]
pub fn with_entries(bytes: &[u8], entries: &[Entry]) -> Vec<u8> {
    let mut messages = messages(bytes);
    let mut encoder = Encoder::default();
    for entry in entries {
        match entry {
            Entry::Step(command, periods) => (0..*periods).for_each(|_| encoder.step(command)),
            Entry::ReadParts => encoder.read_parts(),
            Entry::Look(camera) => encoder.look(*camera),
            Entry::Expose => encoder.expose(),
            Entry::Answered(hash) => encoder.answered(*hash),
            Entry::Refused => encoder.refused(),
            Entry::State(hash) => encoder.state(*hash),
        }
    }
    messages.retain(|(topic, _)| topic != "/calls");
    messages.insert(1, ("/calls".to_string(), encoder.take()));
    as_log(&messages)
}
