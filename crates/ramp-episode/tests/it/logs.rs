//! Logs: they record a run to the last bit, and errors in a log are reported.

use std::path::Path;

use ramp_episode::{ReplayError, replay};
use ramp_log::calls::Entry;
use ramp_log::records::bytes_of;
use ramp_log::{Limits, Log};
use ramp_robot::{Account, Agent, ArmCommand, Camera, Command, GripperCommand, Robot, RobotError, Track};
use ramp_testing::episode::Swing;
use ramp_testing::log::{as_log, entries, messages, with_entries};
use ramp_testing::{GoalFiles, data};
use ramp_twin::Setup;

fn read(bytes: &[u8]) -> Result<Log, String> {
    Log::from_bytes(Path::new("x.mcap"), bytes, &Limits::default()).map_err(|error| error.to_string())
}

/// A log with its calls changed.
fn with_calls(bytes: &[u8], mut change: impl FnMut(usize, &mut Entry)) -> Vec<u8> {
    let mut entries = entries(bytes);
    entries.iter_mut().enumerate().for_each(|(index, entry)| change(index, entry));
    with_entries(bytes, &entries)
}

#[test]
fn a_log_replays_to_the_bit_and_a_changed_one_does_not() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("a.mcap");
    let world = GoalFiles::new("easy-1");
    let result = world.record_noisy(&mut Swing(1500), &path);
    let names: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|it| it.unwrap().file_name()).collect();
    assert_eq!(names, ["a.mcap"], "nothing else is left");

    let log = Log::read(&path).unwrap();
    assert_eq!(Some(&log.sha256), result.log.as_ref());
    assert_eq!(log.result.without_clock(), result.without_clock());
    assert_eq!(log.header.goal.name, "easy-1");
    let replayed = replay(&log).unwrap();
    assert!(replayed.is_equal(), "{:?}", replayed.differences);
    assert_eq!(replayed.result, log.result);

    // The same calls written once more are still the same.
    let bytes = std::fs::read(&path).unwrap();
    assert!(replay(&read(&with_calls(&bytes, |_, _| {})).unwrap()).unwrap().is_equal());

    // One bit of one command, after 0.7 s.
    let mut is_bent = false;
    let bent = with_calls(&bytes, |index, entry| {
        if let Entry::Step(command, _) = entry
            && let ArmCommand::JointPositions(positions) = &mut command.arm
            && index >= 710
            && !is_bent
        {
            positions[0] = f64::from_bits(positions[0].to_bits() + 1);
            is_bent = true;
        }
    });
    let replayed = replay(&read(&bent).unwrap()).unwrap();
    let first = &replayed.differences[0];
    assert_eq!(first.what, "state of the physics");
    // The state is compared every 0.1 s, and after the reading that was pending then.
    assert!((0.69..=0.85).contains(&first.time), "{first:?}");

    // A peg that was never seated, in the result alone.
    let mut told = messages(&bytes);
    let last = told.iter_mut().find(|(topic, _)| topic == "/result").unwrap();
    let mut value: serde_json::Value = serde_json::from_slice(&last.1).unwrap();
    value["pegs"][0] = serde_json::json!(
        {"connection": "C1", "joints": ["b7j1", "b4j1"], "peg": "p1", "t_robot": 0.5, "t_total": 0.5}
    );
    last.1 = value.to_string().into_bytes();
    let replayed = replay(&read(&as_log(&told)).unwrap()).unwrap();
    assert_eq!(replayed.differences[0].what, "connection 1");
    assert_eq!(replayed.differences[0].replayed, "no peg");
}

#[test]
fn what_is_wrong_with_a_log_is_told() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("a.mcap");
    GoalFiles::new("easy-1").record_noisy(&mut Swing(300), &path);
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(read(b"").unwrap_err(), "x.mcap is not a complete MCAP file: it ends too early");
    assert!(read(b"{\"schema\": \"ramp-episode-3\"}").unwrap_err().contains("not a complete MCAP file"));
    for length in [9, bytes.len() / 2, bytes.len() - 1] {
        let error = read(&bytes[..length]).unwrap_err();
        assert!(error.contains("it ends too early"), "{length}: {error}");
    }
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 4;
    assert!(read(&flipped).unwrap_err().contains("not a complete MCAP file"));

    let with = |topic: &str, data: &[u8]| {
        let mut messages = messages(&bytes);
        messages.iter_mut().filter(|it| it.0 == topic).for_each(|it| it.1 = data.to_vec());
        as_log(&messages)
    };
    let without = |topic: &str| {
        let mut messages = messages(&bytes);
        messages.retain(|it| it.0 != topic);
        as_log(&messages)
    };
    for topic in ["/episode", "/result"] {
        let error = read(&without(topic)).unwrap_err();
        assert!(error.contains(&format!("it has no message on {topic}")), "{error}");
        assert!(read(&with(topic, b"{}")).unwrap_err().contains("missing field `schema`"));
    }
    let error = read(&with("/episode", br#"{"schema": "ramp-log-9"}"#)).unwrap_err();
    assert!(error.contains("`ramp-log-9`, and `ramp-log-3` is what this program knows"), "{error}");
    let error = replay(&read(&with("/calls", &[77])).unwrap()).unwrap_err();
    assert!(matches!(error, ReplayError::Calls(_)), "{error}");

    // Mismatches: the kit and its hash, the start and the end.
    let change = |topic: &str, change: &dyn Fn(&mut serde_json::Value)| {
        let mut messages = messages(&bytes);
        for (_, data) in messages.iter_mut().filter(|it| it.0 == topic) {
            let mut value = serde_json::from_slice(data).unwrap();
            change(&mut value);
            *data = value.to_string().into_bytes();
        }
        read(&as_log(&messages))
    };
    let error = change("/episode", &|it| it["kit"]["xml"] = "<data/>".into()).unwrap_err();
    assert!(error.contains("its kit does not match its hash"), "{error}");
    let error = change("/episode", &|it| it["world"]["toml"] = "name = \"ideal\"\n".into()).unwrap_err();
    assert!(error.contains("its world does not match its hash"), "{error}");
    let drawn = |it: &mut serde_json::Value| it["world"]["draw"] = serde_json::json!({"arm.offset": [0.1]});
    let error = replay(&change("/result", &drawn).unwrap()).unwrap_err();
    assert!(matches!(error, ReplayError::Draw), "{error}");
    let error = replay(&change("/result", &|it| it["seed"] = 4.into()).unwrap()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the log contradicts itself: its seed is 3 at its start and 4 in its result"
    );
    let error = replay(&change("/episode", &|it| it["rules"] = "old".into()).unwrap()).unwrap_err();
    assert!(matches!(error, ReplayError::Rules { .. }), "{error}");
    let error = replay(&change("/episode", &|it| it["start"]["name"] = "moved".into()).unwrap()).unwrap_err();
    assert!(matches!(error, ReplayError::Contradiction { what: "start", .. }), "{error}");
    let error = change("/episode", &|it| it["start"]["toml"] = "".into()).unwrap_err();
    assert!(error.contains("its start does not match its hash"), "{error}");
    let empty = |it: &mut serde_json::Value| {
        it["start"]["toml"] = "".into();
        it["start"]["sha256"] = ramp_result::sha256(b"").into();
    };
    // The start that the result names is another one, then.
    let error = replay(&change("/episode", &empty).unwrap()).unwrap_err();
    assert!(matches!(error, ReplayError::Contradiction { what: "start", .. }), "{error}");
}

/// A small file can hold many records, and a reader has to stop in time.
#[test]
fn a_log_is_read_within_limits() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("a.mcap");
    GoalFiles::new("easy-1").record_noisy(&mut Swing(300), &path);
    let bytes = std::fs::read(&path).unwrap();
    let read = |bytes: &[u8], limits: Limits| {
        Log::from_bytes(Path::new("x.mcap"), bytes, &limits).map(|_| ()).map_err(|error| error.to_string())
    };
    let all = Limits::default();
    assert_eq!(read(&bytes, all), Ok(()));
    let refusal = |bytes: &[u8], limits: Limits| read(bytes, limits).unwrap_err();
    let mut crowd = messages(&bytes);
    crowd.extend((0..=all.channels).map(|number| (format!("/channel-{number}"), Vec::new())));
    assert!(refusal(&as_log(&crowd), all).ends_with("it has more than 64 channels"));
    let mut flood = messages(&bytes);
    flood.extend(std::iter::repeat_n(("/calls".to_string(), Vec::new()), 1000));
    assert!(
        refusal(&as_log(&flood), Limits { messages: 1000, ..all })
            .ends_with("it has more than 1000 messages")
    );
    let mut bomb = messages(&bytes);
    bomb.extend(std::iter::repeat_n(("/zeros".to_string(), vec![0; 1 << 20]), 8));
    let bomb = as_log(&bomb);
    assert!(bomb.len() < 1 << 20, "{} bytes", bomb.len());
    let why = refusal(&bomb, Limits { decompressed: 4 << 20, ..all });
    assert!(why.ends_with("it holds more than 4 MiB after decompression"), "{why}");
    assert!(refusal(&bytes, Limits { calls: 100, ..all }).ends_with("it has more than 100 bytes of calls"));
    // The size of the file itself.
    let error = bytes_of(&path, &Limits { file: 100, ..all }).unwrap_err().to_string();
    assert!(error.ends_with("it is larger than 100 bytes"), "{error}");
}

/// A refusal by the robot is in the log, and is repeated in the replay.
#[test]
fn a_command_that_ended_the_episode_ends_its_replay() {
    struct Mad(f64);
    impl Agent for Mad {
        fn name(&self) -> (&str, &str) {
            ("mad", "1")
        }
        fn account(&self) -> Account {
            Account::default()
        }
        fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError> {
            // A request outside the track does not end the episode.
            assert!(robot.look(Camera::Wrist).is_err());
            let arm = ArmCommand::JointTorques([self.0; 7]);
            let command = Command { arm, gripper: GripperCommand { width: 0.04, force: 10.0 } };
            (0..5000).try_for_each(|_| robot.step(&command).map(|_| ()))
        }
    }
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("a.mcap");
    let world = GoalFiles::new("easy-1");
    for (torque, reason) in [
        (f64::NAN, "the command's joint torques is not a finite, valid number"),
        (1e12, "the command's joint torque is 1e12, above the limit of 1000 N·m"),
        (80.0, "joint "),
    ] {
        let result = world.record_noisy(&mut Mad(torque), &path);
        assert!(result.ended.reason.starts_with(reason), "{}", result.ended.reason);
        let replayed = replay(&Log::read(&path).unwrap()).unwrap();
        assert!(replayed.is_equal(), "{:?}", replayed.differences);
    }
}

/// Each message follows the schema that its channel carries, which is the published one.
#[test]
fn the_messages_of_a_log_follow_their_schemas() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("a.mcap");
    let goal = GoalFiles::new("easy-1");
    let world = ramp_twin::World::shipped("real+touch").unwrap();
    goal.record(&Setup { world, ..goal.setup(Track::Noisy, 3) }, &mut Swing(300), &path);
    let bytes = std::fs::read(&path).unwrap();
    let mut topics = std::collections::BTreeSet::new();
    let mut felt = false;
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let Some(schema) = &message.channel.schema else {
            assert_eq!(message.channel.topic, "/calls");
            continue;
        };
        let schema: serde_json::Value = serde_json::from_slice(&schema.data).unwrap();
        let value: serde_json::Value = serde_json::from_slice(&message.data).unwrap();
        let validator = jsonschema::validator_for(&schema).unwrap();
        let errors: Vec<String> = validator.iter_errors(&value).map(|error| error.to_string()).collect();
        assert!(errors.is_empty(), "{}: {errors:?}", message.channel.topic);
        felt |= value["touch"][1]["force"]["z"].is_number();
        topics.insert(message.channel.topic.clone());
    }
    assert!(felt, "no reading of the tactile sensors");
    let expected = ["/command", "/episode", "/events", "/parts", "/result", "/robot", "/tip"];
    assert_eq!(topics.into_iter().collect::<Vec<_>>(), expected);
    let published = std::fs::read_dir(data().join("schema/log")).unwrap().count();
    assert_eq!(published, expected.len(), "with that of /referee, without that of /result");
}
