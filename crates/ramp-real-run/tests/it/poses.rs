//! Logs of camera-measured poses of a real robot: verdicts of the referee, and refused input.

use std::path::Path;

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use ramp_kit::Pose;
use ramp_kit::joint::FEMALE_HEIGHT;
use ramp_real_run::poses::{QuaternionOrder, Reader};
use ramp_result::EpisodeResult;
use ramp_result::episode::Software;
use ramp_testing::episode::Swing;
use ramp_testing::log::as_log;
use ramp_testing::{GoalFiles, data};
use serde_json::{Value, json};

/// The clock's reading at the handover of the goal, s.
pub(crate) const BEGIN: u64 = 1_700_000_000;

fn run() -> Value {
    json!({
        "schema": "ramp-poses-1", "rules": "ramp-rules-9", "goal": "easy-1", "repeat": 2, "track": "tags",
        "agent": "our-system", "version": "2.1", "robot": "Franka Research 3", "computer": "a laptop", "cores": 8,
        "scorer": "A. Person", "source": "bench 2 of our lab",
        "begin": {"sec": BEGIN, "nsec": 0}, "planning": 3.5, "end": {"sec": BEGIN + 200, "nsec": 0}, "ended": "done",
    })
}

/// Measured poses of some parts at a time, s.
pub(crate) fn sight(time: f64, parts: &[(&str, Pose)]) -> Value {
    let stamp = json!({"sec": BEGIN + time.floor() as u64, "nsec": (time.fract() * 1e9).round() as u64});
    let transform = |(name, x): &(&str, Pose)| {
        let (p, q) = (x.translation.vector, x.rotation.quaternion());
        json!({
            "timestamp": stamp, "parent_frame_id": "world", "child_frame_id": name,
            "translation": {"x": p.x, "y": p.y, "z": p.z}, "rotation": {"x": q.i, "y": q.j, "z": q.k, "w": q.w},
        })
    };
    json!({"transforms": parts.iter().map(transform).collect::<Vec<_>>()})
}

/// The pose of a transform.
pub(crate) fn pose_of(transform: &Value) -> Pose {
    let number = |it: &str, axis: &str| transform[it][axis].as_f64().unwrap();
    let [x, y, z] = ["x", "y", "z"].map(|axis| number("translation", axis));
    let [i, j, k, w] = ["x", "y", "z", "w"].map(|axis| number("rotation", axis));
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
    Pose::from_parts(Translation3::new(x, y, z), turn)
}

/// The beams in their goal poses, and a peg at this height (m) above its seat in the connection of
/// that number.
pub(crate) struct Bench(pub GoalFiles);

impl Bench {
    pub(crate) fn beams(&self) -> Vec<(&str, Pose)> {
        let x_wa = self.0.assembly.kit.x_wa();
        let beams = self.0.assembly.beams.iter();
        beams.map(|placed| (placed.beam.name.as_str(), x_wa * placed.x_ab)).collect()
    }

    fn seat(&self, connection: usize, gap: f64) -> Pose {
        let assembly = &self.0.assembly;
        let hole = self.0.assembly.kit.x_wa() * assembly.p_a_hole(assembly.connections[connection].female);
        Pose::translation(hole.x, hole.y, hole.z + FEMALE_HEIGHT / 2.0 + gap)
    }

    /// p1 is seated at 60 s. p2 is seated at 90.25 s, comes out at 120 s and is seated again at
    /// 150.5 s.
    pub(crate) fn messages(&self) -> Vec<(String, Value)> {
        let sights = [
            sight(0.5, &self.beams()),
            sight(20.0, &[("p1", self.seat(0, 0.05))]),
            sight(60.0, &[("p1", self.seat(0, 0.0003))]),
            sight(90.25, &[("p2", self.seat(1, 0.0))]),
            sight(120.0, &[("p2", self.seat(1, 0.02)), ("p1", self.seat(0, -0.0002))]),
            sight(150.5, &[("p2", self.seat(1, 0.0))]),
            sight(199.0, &[("p3", self.seat(2, 0.001))]),
        ];
        let parts = sights.into_iter().map(|sight| ("/parts".to_string(), sight));
        std::iter::once(("/run".to_string(), run())).chain(parts).collect()
    }

    pub(crate) fn bytes(&self, messages: &[(String, Value)]) -> Vec<u8> {
        let text = |(topic, value): &(String, Value)| (topic.clone(), value.to_string().into_bytes());
        as_log(&messages.iter().map(text).collect::<Vec<_>>())
    }

    pub(crate) fn judge(&self, bytes: &[u8]) -> Result<EpisodeResult, String> {
        self.judge_in(bytes, QuaternionOrder::default())
    }

    pub(crate) fn judge_in(&self, bytes: &[u8], order: QuaternionOrder) -> Result<EpisodeResult, String> {
        let software = Software { version: "test".into(), commit: "test".into() };
        let goals = std::slice::from_ref(&self.0.assembly);
        let reader =
            Reader { kit: &self.0.assembly.kit, goals, software: &software, order, unmeasured: false };
        let judged = reader.from_bytes(Path::new("run.mcap"), bytes);
        judged.map(|judged| judged.result).map_err(|error| error.to_string())
    }

    /// [`Bench::messages`] as the tags on the parts, and that of the sheet, tell them.
    pub(crate) fn by_tags(&self) -> Vec<(String, Value)> {
        let places = ramp_kit::tags::places(&self.0.assembly.kit);
        let mut messages = self.messages();
        for (_, message) in messages.iter_mut().filter(|(topic, _)| topic == "/parts") {
            let mut of_tags = Vec::new();
            for transform in message["transforms"].as_array().unwrap() {
                let part = transform["child_frame_id"].as_str().unwrap();
                for place in places.iter().filter(|place| place.part == part) {
                    of_tags.push((format!("tag{}", place.id), pose_of(transform) * place.x_pg));
                }
            }
            of_tags.push(("tag0".to_string(), ramp_kit::tags::x_wg_sheet(&self.0.assembly.kit)));
            let time = &message["transforms"][0]["timestamp"];
            let time = (time["sec"].as_u64().unwrap() - BEGIN) as f64 + time["nsec"].as_f64().unwrap() * 1e-9;
            let of_tags: Vec<(&str, Pose)> = of_tags.iter().map(|(name, x)| (name.as_str(), *x)).collect();
            assert!(of_tags.len() > 1);
            *message = sight(time, &of_tags);
        }
        messages
    }
}

#[test]
fn the_referee_judges_what_cameras_saw() {
    let bench = Bench(GoalFiles::new("easy-1"));
    let bytes = bench.bytes(&bench.messages());
    let result = bench.judge(&bytes).unwrap();
    let times: Vec<_> =
        result.pegs.iter().map(|peg| peg.as_ref().map(|peg| (peg.t_total, peg.t_robot))).collect();
    assert_eq!(times, [Some((60.0, 56.5)), Some((150.5, 147.0)), None]);
    assert_eq!((result.seed, result.time.total, result.time.planning), (2, 200.0, 3.5));
    assert_eq!(result.log, Some(ramp_result::sha256(&bytes)));
    // It is a result like any other, and its log follows the published schemas.
    let follows = |schema: &str, value: &Value| {
        let text = std::fs::read_to_string(data().join(format!("schema/{schema}.schema.json"))).unwrap();
        let validator = jsonschema::validator_for(&serde_json::from_str(&text).unwrap()).unwrap();
        let errors: Vec<String> = validator.iter_errors(value).map(|error| error.to_string()).collect();
        assert!(errors.is_empty(), "{schema}: {errors:?}");
    };
    follows("episode", &serde_json::from_str(&result.to_json()).unwrap());
    ramp_result::collection::parse("it", result.to_json().as_bytes()).unwrap();
    for (topic, value) in bench.messages() {
        follows(if topic == "/run" { "real-run" } else { "log/parts" }, &value);
    }
}

/// The same run measured by the tags on the parts gives the same result.
#[test]
fn tags_tell_where_parts_are() {
    let bench = Bench(GoalFiles::new("easy-1"));
    let messages = bench.by_tags();
    let by_parts = bench.judge(&bench.bytes(&bench.messages())).unwrap();
    let by_tags = bench.judge(&bench.bytes(&messages)).unwrap();
    assert_eq!(by_tags.pegs, by_parts.pegs);
    // A tag of another kit.
    let mut wrong = messages.clone();
    wrong[2].1["transforms"][0]["child_frame_id"] = json!("tag999");
    assert!(bench.judge(&bench.bytes(&wrong)).unwrap_err().contains("no part or tag `tag999`"));
}

#[test]
fn what_cannot_have_happened_is_refused_with_its_place() {
    let bench = Bench(GoalFiles::new("easy-1"));
    let refused = |messages: &[(String, Value)], words: &[&str]| {
        let why = bench.judge(&bench.bytes(messages)).unwrap_err();
        for word in words {
            assert!(why.contains(word), "`{word}` is not in: {why}");
        }
    };
    let with = |index: usize, path: &str, value: Value| {
        let mut messages = bench.messages();
        *messages[index].1.pointer_mut(path).unwrap() = value;
        messages
    };
    let first = |field: &str| format!("/transforms/0/{field}");
    // Invalid poses, reported with the number and time of the message.
    refused(&with(4, &first("timestamp/sec"), (BEGIN + 10).into()), &["message 4", "10.250 s", "backwards"]);
    refused(
        &with(3, &first("timestamp/sec"), (BEGIN - 1).into()),
        &["message 3", "backwards, after 20.000 s"],
    );
    refused(&with(1, &first("timestamp/sec"), (BEGIN - 1).into()), &["message 1", "before the beginning"]);
    refused(
        &with(7, &first("timestamp/sec"), (BEGIN + 300).into()),
        &["message 7", "after the end, 200.000 s"],
    );
    refused(&with(2, &first("timestamp/nsec"), 1_500_000_000.into()), &["more than 999999999 nanoseconds"]);
    refused(
        &with(2, &first("child_frame_id"), "b77".into()),
        &["no part or tag `b77`", "did you mean `b7`?"],
    );
    refused(&with(2, &first("parent_frame_id"), "camera".into()), &["20.000 s", "`camera`", "`world`"]);
    refused(&with(2, &first("translation/x"), 40.0.into()), &["p1 is at (40, "]);
    refused(&with(2, &first("rotation/w"), 0.5.into()), &["unit quaternion"]);
    refused(&with(2, &first("rotation/w"), Value::Null), &["message 2", "expected f64"]);
    let mut base = bench.messages();
    let moved = [("b7", Pose::translation(0.3, 0.3, 0.0166))];
    base[1].1 = sight(0.5, &moved);
    refused(&base, &["b7, which is clamped", "robot's base?"]);
    // Invalid runs.
    refused(&with(0, "/schema", "ramp-poses-9".into()), &["ramp-poses-9", "ramp-poses-1"]);
    refused(&with(0, "/goal", "esay-1".into()), &["no goal `esay-1`", "did you mean `easy-1`?"]);
    refused(&with(0, "/track", "tag".into()), &["no track `tag`", "`tags`"]);
    refused(&with(0, "/rules", "ramp-rules-0".into()), &["ramp-rules-0"]);
    refused(&with(0, "/scorer", " ".into()), &["`scorer` is empty"]);
    refused(&with(0, "/agent", "=1+1".into()), &["`agent` is `=1+1`, expected 1 to 64 letters"]);
    refused(&with(0, "/version", "v\u{1b}[2J".into()), &["`version` is `v\\u{1b}[2J`"]);
    refused(&with(0, "/ended", "done\u{202e}".into()), &["`ended` is `done\\u{202e}`"]);
    refused(&with(0, "/robot", "r".repeat(257).into()), &["`robot` is `rrr", "at most 256 characters"]);
    refused(&with(0, "/repeat", 0.into()), &["`repeat` is 0"]);
    refused(&with(0, "/planning", 300.0.into()), &["free to move after 300 s"]);
    refused(&with(0, "/planning", 100.0.into()), &["C1 is pinned since 60.000 s", "before 100 s"]);
    refused(&with(0, "/end/sec", (BEGIN + 2000).into()), &["1996 s of robot time", "1800 s"]);
    // Invalid files.
    refused(&bench.messages()[1..], &["comes before the one on /run"]);
    refused(&bench.messages()[..1], &["no pose on /parts"]);
    refused(&[], &["no message on /run"]);
    let mut twice = bench.messages();
    twice.push(twice[0].clone());
    refused(&twice, &["two messages on /run"]);
    // The log of an episode in the twin has the same poses, but is not the log of a real run.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("twin.mcap");
    bench.0.record_noisy(&mut Swing(50), &path);
    let why = bench.judge(&std::fs::read(&path).unwrap()).unwrap_err();
    assert!(why.contains("before the one on /run"), "{why}");
}

#[test]
fn whatever_the_bytes_there_is_a_result_or_a_message() {
    let bench = Bench(GoalFiles::new("easy-1"));
    let bytes = bench.bytes(&bench.messages());
    for end in (0..bytes.len()).step_by(7) {
        assert!(bench.judge(&bytes[..end]).is_err());
    }
    let mut stream = ramp_robot::random::Stream::new(1, "mangled");
    for _ in 0..500 {
        let mut mangled = bytes.clone();
        for _ in 0..3 {
            let at = (stream.uniform() * mangled.len() as f64) as usize;
            mangled[at] = (stream.uniform() * 256.0) as u8;
        }
        let _ = bench.judge(&mangled);
    }
}

/// Each compression of the format is read, and another one is named.
#[test]
fn a_log_may_be_compressed_in_each_way_of_the_format() {
    let bench = Bench(GoalFiles::new("easy-1"));
    let text = |(topic, value): &(String, Value)| (topic.clone(), value.to_string().into_bytes());
    let messages: Vec<_> = bench.messages().iter().map(text).collect();
    let compressed = |how: Option<mcap::Compression>| {
        let options = mcap::WriteOptions::new().compression(how);
        ramp_testing::log::write_log(&messages, options)
    };
    let pegs = bench.judge(&bench.bytes(&bench.messages())).unwrap().pegs;
    let lz4 = compressed(Some(mcap::Compression::Lz4));
    for bytes in [&lz4, &compressed(Some(mcap::Compression::Zstd)), &compressed(None)] {
        assert_eq!(bench.judge(bytes).unwrap().pegs, pegs);
    }
    let mut other = lz4.clone();
    let name = other.windows(7).position(|it| it == b"\x03\0\0\0lz4").unwrap() + 4;
    other[name..name + 3].copy_from_slice(b"br7");
    let why = bench.judge(&other).unwrap_err();
    assert!(why.contains("compressed with `br7`, expected zstd, lz4 or no compression"), "{why}");
}
