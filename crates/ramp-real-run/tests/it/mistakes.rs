//! Logs of poses with a mistake of units, axes, frames or the order of numbers: each is refused with its
//! cause, and no result is made.

use std::f64::consts::PI;

use nalgebra::{UnitQuaternion, Vector3};
use ramp_kit::Pose;
use ramp_real_run::poses::QuaternionOrder;
use ramp_testing::GoalFiles;
use serde_json::{Value, json};

use crate::poses::{BEGIN, Bench, pose_of, sight};

type Messages = Vec<(String, Value)>;

/// A log after `change` of every transform.
fn each(messages: &Messages, change: impl Fn(&mut Value)) -> Messages {
    let mut messages = messages.clone();
    for (_, message) in messages.iter_mut().filter(|(topic, _)| topic == "/parts") {
        message["transforms"].as_array_mut().unwrap().iter_mut().for_each(&change);
    }
    messages
}

/// A log whose poses are changed.
fn posed(messages: &Messages, change: impl Fn(Pose) -> Pose) -> Messages {
    each(messages, |transform| {
        let name = transform["child_frame_id"].as_str().unwrap().to_string();
        let changed = sight(0.0, &[(&name, change(pose_of(transform)))]);
        for field in ["translation", "rotation"] {
            transform[field] = changed["transforms"][0][field].clone();
        }
    })
}

/// A log in which the numbers of the quaternions stand in other fields: `fields[k]` takes that of `from[k]`.
fn reordered(messages: &Messages, fields: [&str; 4], from: [&str; 4]) -> Messages {
    each(messages, |transform| {
        let old = transform["rotation"].clone();
        for (field, from) in fields.iter().zip(from) {
            transform["rotation"][field] = old[from].clone();
        }
    })
}

fn about(axis: nalgebra::Unit<Vector3<f64>>, angle: f64) -> Pose {
    Pose::from_parts(nalgebra::Translation3::identity(), UnitQuaternion::from_axis_angle(&axis, angle))
}

fn refused(bench: &Bench, messages: &Messages, words: &[&str]) {
    let why = bench.judge(&bench.bytes(messages)).unwrap_err();
    for word in words {
        assert!(why.contains(word), "`{word}` is not in: {why}");
    }
}

#[test]
fn quaternions_in_another_order_are_refused_and_read_with_their_order() {
    let bench = Bench(GoalFiles::new("easy-1"));
    let sound = bench.messages();
    let names = ["w", "x", "y", "z"];
    for (order, from) in
        [(QuaternionOrder::Xyzw, ["x", "y", "z", "w"]), (QuaternionOrder::Zwxy, ["z", "w", "x", "y"])]
    {
        let wrong = reordered(&sound, names, from);
        let asked = format!("(try --quaternion {})?", order.name());
        refused(&bench, &wrong, &["message 1", "b7, which is clamped, is turned by", &asked]);
        let read = bench.judge_in(&bench.bytes(&wrong), order).unwrap();
        assert_eq!(read.pegs, bench.judge(&bench.bytes(&sound)).unwrap().pegs);
        // Sound quaternions are not in that order.
        let why = bench.judge_in(&bench.bytes(&sound), order).unwrap_err();
        assert!(why.contains("(try --quaternion wxyz)?"), "{why}");
        // Pegs alone tell it as well, from their first sight.
        if order == QuaternionOrder::Zwxy {
            let pegs: Messages = [&wrong[..1], &wrong[2..]].concat();
            refused(&bench, &pegs, &["p1 stands on its head when it is seen first", &asked]);
        }
    }
}

#[test]
fn another_frame_is_refused_with_its_cause() {
    let bench = Bench(GoalFiles::new("easy-1"));
    let sound = bench.messages();
    let x_wa = bench.0.assembly.kit.x_wa();
    refused(&bench, &posed(&sound, |x| x_wa.inverse() * x), &["b7, which", "in the frame of the assembly"]);
    refused(&bench, &posed(&sound, |x| x.inverse()), &["of the world in the parts' frames?"]);
    let camera = Pose::translation(0.2, -0.1, 0.9) * about(Vector3::x_axis(), 2.5);
    refused(&bench, &posed(&sound, |x| camera.inverse() * x), &["mm from its place", "robot's base?"]);
    let sideways = about(Vector3::z_axis(), PI / 2.0);
    refused(&bench, &posed(&sound, |x| sideways * x), &["has their frame other axes (expected x forward"]);
    // Without the clamped beam, the table tells.
    let without: Messages = [&sound[..1], &sound[2..]].concat();
    let lower = Pose::translation(0.0, 0.0, -0.12);
    refused(&bench, &posed(&without, |x| lower * x), &["20.000 s", "p1 is", "mm in the table"]);
}

#[test]
fn another_unit_of_length_is_refused_with_its_name() {
    let bench = Bench(GoalFiles::new("easy-1"));
    let sound = bench.messages();
    let scaled = |factor: f64| {
        posed(&sound, move |x| Pose::from_parts((x.translation.vector * factor).into(), x.rotation))
    };
    refused(
        &bench,
        &scaled(1e3),
        &["b7 is at", "expected it within 10 m", "are the positions in millimetres or centimetres?"],
    );
    refused(&bench, &scaled(1e2), &["are the positions in millimetres or centimetres?"]);
    // Near the origin, where numbers are small.
    refused(&bench, &scaled(10.0), &["b7, which is clamped, is", "in metres,"]);
}

#[test]
fn another_unit_of_time_is_refused_with_its_name() {
    let bench = Bench(GoalFiles::new("easy-1"));
    let sound = bench.messages();
    let whole = |stamp: &mut Value, factor: f64| {
        let seconds = stamp["sec"].as_u64().unwrap() as f64 + stamp["nsec"].as_f64().unwrap() * 1e-9;
        *stamp = json!({"sec": (seconds * factor) as u64, "nsec": 0});
    };
    for (factor, unit) in [(1e3, "milliseconds"), (1e6, "microseconds"), (1e9, "nanoseconds")] {
        let mut all = each(&sound, |transform| whole(&mut transform["timestamp"], factor));
        let stamps_only = all.clone();
        for end in ["begin", "end"] {
            whole(&mut all[0].1[end], factor);
        }
        refused(&bench, &all, &["/run: it ends after", &format!("is it in {unit} (expected seconds)?")]);
        let words = ["message 1", "seen after the end, 200.000 s", &format!("is it in {unit}")];
        refused(&bench, &stamps_only, &words);
    }
    let mut planning = sound.clone();
    planning[0].1["planning"] = json!(3500.0);
    refused(&bench, &planning, &["free to move after 3500 s", "is it in milliseconds (expected seconds)?"]);
    // Fractions of seconds in milliseconds instead of nanoseconds.
    let mut fractions = sound.clone();
    for (index, (_, message)) in fractions.iter_mut().enumerate().skip(1) {
        for transform in message["transforms"].as_array_mut().unwrap() {
            transform["timestamp"]["nsec"] = json!(100 + index);
        }
    }
    refused(&bench, &fractions, &["no `nsec` on /parts is 1000000 or more", "nanoseconds"]);
    // A run that is only too long is not asked about.
    let mut long = sound.clone();
    long[0].1["end"]["sec"] = json!(BEGIN + 2000);
    assert!(!bench.judge(&bench.bytes(&long)).unwrap_err().contains("seconds (expected"));
}

#[test]
fn parts_upside_down_are_refused_with_their_cause() {
    let bench = Bench(GoalFiles::new("easy-1"));
    let sound = bench.messages();
    let over = about(Vector3::x_axis(), PI);
    // The whole world.
    let world = posed(&sound, |x| over * x);
    refused(&bench, &world, &["b7, which is clamped, is", "upside down", "does z of their frame point down"]);
    // The clamped beam alone, and turned about its hole.
    let clamped = |turn: Pose| {
        let mut messages = sound.clone();
        let beams = bench.beams().into_iter();
        let beams: Vec<(&str, Pose)> =
            beams.map(|(name, x)| (name, if name == "b7" { x * turn } else { x })).collect();
        messages[1].1 = sight(0.5, &beams);
        messages
    };
    refused(&bench, &clamped(over), &["b7, which is clamped, is upside down: in which order are"]);
    let half = about(Vector3::z_axis(), PI / 2.0);
    refused(&bench, &clamped(half), &["turned by 90° from its place", "--quaternion"]);
    // As inaccurate as a tag is allowed.
    let slight = about(Vector3::z_axis(), 15.0 / 180.0 * PI);
    assert!(bench.judge(&bench.bytes(&clamped(slight))).is_ok());
    // Other parts, at their first sight.
    let without: Messages = [&sound[..1], &sound[2..]].concat();
    refused(
        &bench,
        &posed(&without, |x| x * over),
        &["p1 stands on its head", "does z of their frame point down"],
    );
    let beam = |turn: Pose| {
        let mut messages = sound.clone();
        let (_, x) = bench.beams().into_iter().find(|(name, _)| *name == "b4").unwrap();
        messages[1].1 = sight(0.5, &[("b4", x * turn)]);
        messages
    };
    refused(&bench, &beam(about(Vector3::x_axis(), PI / 2.0)), &["b4 stands on an edge or an end when"]);
    assert!(bench.judge(&bench.bytes(&beam(about(Vector3::z_axis(), 1.0)))).is_ok());
    // A peg that fell during the run may lie as it likes.
    let mut fell = sound.clone();
    fell[7].1 = sight(199.0, &[("p1", Pose::translation(0.4, 0.3, 0.024) * over)]);
    let result = bench.judge(&bench.bytes(&fell)).unwrap();
    assert_eq!(result.pegs.iter().flatten().count(), 1);
}

#[test]
fn tags_with_other_axes_are_refused_with_their_cause() {
    let bench = Bench(GoalFiles::new("easy-1"));
    let sound = bench.by_tags();
    bench.judge(&bench.bytes(&sound)).unwrap();
    // x to the right, y down, z into the face, as computer vision has it.
    let inwards = posed(&sound, |x| x * about(Vector3::x_axis(), PI));
    refused(&bench, &inwards, &["b7, which is clamped", "does z of the tags point inwards (expected x to"]);
    let turned = posed(&sound, |x| x * about(Vector3::z_axis(), PI / 2.0));
    refused(&bench, &turned, &["have the tags other axes"]);
    // Without the clamped beam, the pegs tell it.
    let mut pegs = inwards.clone();
    pegs.remove(1);
    refused(&bench, &pegs, &["p1 stands on its head", "does z of the tags point inwards"]);
}
