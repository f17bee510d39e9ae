//! Logs that were tampered with: relabelled, stripped, spliced, reordered. Each is caught by its replay.

use std::path::Path;

use ramp_episode::{Breach, Replayed, replay};
use ramp_log::calls::Entry;
use ramp_log::{Limits, Log};
use ramp_robot::{Account, Agent, ArmCommand, Camera, Command, GripperCommand, Robot, RobotError, Track};
use ramp_testing::GoalFiles;
use ramp_testing::episode::Swing;
use ramp_testing::log::{as_log, entries, messages, with_entries};

/// A log that can be changed.
struct Forged(Vec<u8>);

impl Forged {
    fn read(path: &Path) -> Forged {
        Forged(std::fs::read(path).unwrap())
    }

    fn entries(&self) -> Vec<Entry> {
        entries(&self.0)
    }

    fn with_entries(&self, entries: &[Entry]) -> Forged {
        Forged(with_entries(&self.0, entries))
    }

    /// Says another track at its start and in its result.
    fn relabelled(&self, track: Track) -> Forged {
        let mut messages = messages(&self.0);
        for (topic, data) in &mut messages {
            if ["/episode", "/result"].contains(&topic.as_str()) {
                let mut value: serde_json::Value = serde_json::from_slice(data).unwrap();
                value["track"] = track.name().into();
                *data = value.to_string().into_bytes();
            }
        }
        Forged(as_log(&messages))
    }

    fn replay(&self) -> Replayed {
        replay(&Log::from_bytes(Path::new("x.mcap"), &self.0, &Limits::default()).unwrap()).unwrap()
    }

    /// The first difference.
    fn first(&self) -> [String; 3] {
        let replayed = self.replay();
        let first = replayed.differences.first().expect("a difference");
        [&first.what, &first.logged, &first.replayed].map(Clone::clone)
    }
}

/// Looks, moves, looks again, and asks for the parts where it may.
struct Looker;

impl Agent for Looker {
    fn name(&self) -> (&str, &str) {
        ("looker", "1")
    }

    fn account(&self) -> Account {
        Account::default()
    }

    fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError> {
        let mut positions = robot.observe().positions;
        for turn in 0..3 {
            let _ = robot.look(Camera::BirdsEye)?;
            let begin = positions[0];
            for step in 1..=200 {
                // It is at rest at both ends.
                let s = f64::from(step) / 200.0;
                positions[0] = begin + 0.02 * f64::from(turn) * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
                let gripper = GripperCommand { width: 0.05, force: 20.0 };
                robot.step(&Command { arm: ArmCommand::JointPositions(positions), gripper })?;
            }
        }
        Ok(())
    }
}

#[test]
fn another_track_on_the_label_is_caught() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("a.mcap");
    let world = GoalFiles::new("easy-1");
    world.record(&world.setup(Track::State, 3), &mut Swing(600), &path);
    let forged = Forged::read(&path);
    let honest = forged.replay();
    assert!(honest.is_equal() && honest.breach.is_none(), "{:?}", honest.differences);

    // The readings were given, and are refused.
    let tags = forged.relabelled(Track::Tags);
    let [what, _, replayed] = tags.first();
    assert_eq!([what.as_str(), replayed.as_str()], ["answer to the agent", "refused"]);
    // They were exact, and are noisy.
    let [what, _, _] = forged.relabelled(Track::Noisy).first();
    assert_eq!(what, "answer to the agent");

    // A log that contains their refusal shows an agent that asked for them.
    let entries: Vec<Entry> = forged
        .entries()
        .into_iter()
        .map(|entry| if matches!(entry, Entry::Answered(_)) { Entry::Refused } else { entry })
        .collect();
    let replayed = forged.with_entries(&entries).relabelled(Track::Tags).replay();
    assert!(replayed.is_equal(), "{:?}", replayed.differences);
    let breach = replayed.breach.unwrap();
    assert!(matches!(breach, Breach::Forbidden { track: Track::Tags, .. }), "{breach}");
    let what = "at 0.251 s the agent requested poses of parts, not available on track `tags`";
    assert_eq!(breach.to_string(), what);
}

#[test]
fn calls_that_were_stripped_spliced_or_reordered_are_caught() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = |name: &str| folder.path().join(name);
    let world = GoalFiles::new("easy-1");
    world.record(&world.setup(Track::Tags, 3), &mut Looker, &path("a.mcap"));
    world.record(&world.setup(Track::Tags, 4), &mut Looker, &path("b.mcap"));
    let (forged, other) = (Forged::read(&path("a.mcap")), Forged::read(&path("b.mcap")));
    let honest = forged.replay();
    assert!(honest.is_equal() && honest.breach.is_none(), "{:?}", honest.differences);
    let entries = forged.entries();
    let keep = |keep: &dyn Fn(&Entry) -> bool| {
        let kept: Vec<Entry> = entries.iter().filter(|entry| keep(entry)).cloned().collect();
        assert!(kept.len() < entries.len());
        forged.with_entries(&kept).first()
    };

    // Stripped of images, with and without their answers; of answers; of the intermediate states.
    let [what, ..] = keep(&|entry| !matches!(entry, Entry::Look(..)));
    assert_eq!(what, "answer to the agent");
    let [what, ..] = keep(&|entry| !matches!(entry, Entry::Look(..) | Entry::Answered(_)));
    assert_eq!(what, "state of the physics");
    let [what, logged, _] = keep(&|entry| !matches!(entry, Entry::Answered(_)));
    assert_eq!([what.as_str(), logged.as_str()], ["answer to the agent", "missing"]);
    let [what, logged, _] = keep(&|entry| !matches!(entry, Entry::State(_)));
    assert_eq!([what.as_str(), logged.as_str()], ["state of the physics", "missing"]);

    // Spliced: the second half, or an image, of another episode.
    let theirs = other.entries();
    let half = entries.len() / 2;
    let spliced = [&entries[..half], &theirs[half..]].concat();
    forged.with_entries(&spliced).first();
    let image = |entry: &Entry| matches!(entry, Entry::Answered(_));
    let mut spliced = entries.clone();
    let at = spliced.iter().rposition(image).unwrap();
    spliced[at] = theirs.iter().rfind(|entry| image(entry)).unwrap().clone();
    let [what, ..] = forged.with_entries(&spliced).first();
    assert_eq!(what, "answer to the agent");
    // And a whole stream under the seed of another.
    forged.with_entries(&theirs).first();

    // Reordered: two commands, and an image that comes before it was taken.
    let commands: Vec<usize> =
        (0..entries.len()).filter(|index| matches!(entries[*index], Entry::Step(..))).collect();
    let mut reordered = entries.clone();
    reordered.swap(commands[commands.len() / 2], commands[commands.len() - 1]);
    forged.with_entries(&reordered).first();
    let mut reordered = entries.clone();
    reordered.swap(0, 1);
    let [what, ..] = forged.with_entries(&reordered).first();
    assert_eq!(what, "answer to the agent");

    // Data after the end, and a missing end.
    let mut longer = entries.clone();
    longer.insert(longer.len() - 1, Entry::State(0));
    let [what, logged, replayed] = forged.with_entries(&longer).first();
    assert_eq!([what, logged, replayed], ["state of the physics", "present", "not due"]);
    let [what, logged, _] = forged.with_entries(&entries[..entries.len() - 1]).first();
    assert_eq!([what.as_str(), logged.as_str()], ["final state of the physics", "missing"]);
}

/// The frame was built with exact poses; then every reading was taken out of the log, and it was called
/// `tags`.
#[test]
fn a_frame_that_was_built_blind_is_caught() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("a.mcap");
    let world = GoalFiles::new("easy-1");
    let mut agent = world.baseline(Track::State, 3);
    let result = world.record(&world.setup(Track::State, 3), &mut agent, &path);
    assert!(result.completion > 0.0);
    let forged = Forged::read(&path);
    let mut entries = forged.entries();
    assert!(!entries.iter().any(|entry| matches!(entry, Entry::Look(..))), "no images on `state`");
    entries.retain(|entry| !matches!(entry, Entry::ReadParts | Entry::Answered(_)));
    let replayed = forged.with_entries(&entries).relabelled(Track::Tags).replay();
    assert!(replayed.is_equal(), "{:?}", replayed.differences);
    let breach = replayed.breach.unwrap();
    assert!(matches!(&breach, Breach::NeverLooked { track: Track::Tags, .. }), "{breach}");
}
