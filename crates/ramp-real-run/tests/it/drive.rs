//! Runs over the wire, with the twin in process as the robot that is driven.

use std::cell::Cell;
use std::path::Path;

use ramp_real_run::drive::{Driven, Guard, Run, Workspace, drive};
use ramp_real_run::poses::{QuaternionOrder, Reader};
use ramp_result::episode::{EndKind, RobotKind};
use ramp_robot::{Agent, Command, Observation, Robot, RobotError, Track};
use ramp_testing::episode::label;
use ramp_testing::log::messages;
use ramp_testing::robot::{Alteration, Altered};
use ramp_testing::{GoalFiles, data};
use ramp_twin::{Setup, Twin, World};

const SEED: u64 = 1;
/// Wherever the arm reaches.
const EVERYWHERE: Workspace = Workspace { low: [-1.0, -1.0, -0.1], high: [1.0, 1.0, 1.5] };

/// The goal easy-1 with the baseline, driven in the world `ideal` until `stop` gives a reason.
fn driven(
    track: Track,
    workspace: &Workspace,
    stop: &dyn Fn() -> Option<String>,
    log: &Path,
) -> (Driven, Twin) {
    let goal = GoalFiles::new("easy-1");
    let mut twin = Twin::new(&Setup { world: World::ideal(), ..goal.setup(track, SEED) }).unwrap();
    let mut agent = goal.baseline(track, SEED);
    let run = Run {
        assembly: &goal.assembly,
        arm: &goal.arm,
        told: &goal.arm,
        track,
        repeat: 1,
        kind: RobotKind::ServedTwinInLockStep,
        robot: "the twin in process",
        scorer: "a test",
        source: "a test",
        software: &label().software,
        workspace,
        images: track == Track::Tags,
    };
    let driven = drive(&run, &mut twin, &mut agent, stop, log).unwrap();
    (driven, twin)
}

/// The messages of a log follow their schemas, and there are some on each channel.
fn follow_their_schemas(bytes: &[u8]) {
    let schemas = [
        ("/run", "real-run"),
        ("/parts", "log/parts"),
        ("/robot", "log/sensed"),
        ("/tip", "log/tip"),
        ("/command", "log/command"),
        ("/events", "log/event"),
        ("/image/wrist", "image"),
        ("/image/birds-eye", "image"),
    ];
    let messages = messages(bytes);
    for (topic, schema) in schemas {
        let text = std::fs::read_to_string(data().join(format!("schema/{schema}.schema.json"))).unwrap();
        let validator = jsonschema::validator_for(&serde_json::from_str(&text).unwrap()).unwrap();
        let mut of_topic = messages.iter().filter(|(found, _)| found == topic).peekable();
        assert!(of_topic.peek().is_some(), "nothing on {topic}");
        for (_, data) in of_topic {
            let value = serde_json::from_slice(data).unwrap();
            let errors: Vec<String> = validator.iter_errors(&value).map(|error| error.to_string()).collect();
            assert!(errors.is_empty(), "{topic}: {errors:?}");
        }
    }
}

/// The survey measures on images what stands, and the log that is left is scored the same again.
#[test]
fn a_build_on_images_is_measured_and_its_log_scored_again() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("run.mcap");
    let (Driven { result, stopped, unmeasured }, _) = driven(Track::Tags, &EVERYWHERE, &|| None, &log);
    assert_eq!((stopped, unmeasured), (None, None));
    assert_eq!((result.counted(), result.pegs.len()), (3, 3), "{result:?}");
    assert_eq!(result.ended.kind, Some(EndKind::Done));
    let real = result.real.as_ref().unwrap();
    assert_eq!(real.kind, RobotKind::ServedTwinInLockStep);
    // Nothing was measured before the end.
    for peg in result.pegs.iter().flatten() {
        assert!((peg.t_total - result.time.total).abs() < 1e-6, "{} of {}", peg.t_total, result.time.total);
    }
    follow_their_schemas(&std::fs::read(&log).unwrap());
    let goal = GoalFiles::new("easy-1");
    let goals = std::slice::from_ref(&goal.assembly);
    let (order, software) = (QuaternionOrder::default(), label().software);
    let reader = Reader { kit: &goal.assembly.kit, goals, software: &software, order, unmeasured: false };
    let again = reader.read(&log).unwrap().result;
    assert_eq!((&again.pegs, &again.time, &again.log), (&result.pegs, &result.time, &result.log));
}

/// The agent wants the tip behind a wall: the arm brakes before it is there, and the run ends with the
/// reason.
#[test]
fn a_wall_of_the_workspace_stops_the_arm_before_it() {
    let folder = tempfile::tempdir().unwrap();
    let workspace = Workspace { low: [0.2, -1.0, -0.1], high: [1.0, 0.15, 1.5] };
    let log = folder.path().join("run.mcap");
    let (Driven { result, .. }, twin) = driven(Track::State, &workspace, &|| None, &log);
    assert!(result.ended.reason.contains("of the workspace"), "{}", result.ended.reason);
    assert_eq!(result.ended.kind, Some(EndKind::Robot));
    let seen = twin.observe();
    assert!(seen.velocities.iter().all(|velocity| velocity.abs() < 0.01), "{:?}", seen.velocities);
    // On its way to rest it passed the wall by its braking distance at most.
    let tip = seen.x_wt.translation.vector;
    assert!(tip.x > 0.15 && tip.y < 0.20, "{tip}");
    assert!(log.exists());
}

/// Remembers the largest velocity of a joint, rad/s.
struct Fastest<'a>(&'a Cell<f64>);

impl<R: Robot + ?Sized> Alteration<R> for Fastest<'_> {
    fn after(&mut self, _: &R, _: &Command, seen: &Observation) -> Result<(), RobotError> {
        self.0.set(seen.velocities.iter().fold(self.0.get(), |most, velocity| most.max(velocity.abs())));
        Ok(())
    }
}

/// A person wants the arm to stop in a motion: it comes to rest within its limits.
#[test]
fn a_person_stops_the_arm_in_a_motion() {
    let goal = GoalFiles::new("easy-1");
    let mut twin = Twin::new(&Setup { world: World::ideal(), ..goal.setup(Track::State, SEED) }).unwrap();
    let steps = Cell::new(0);
    let fastest = Cell::new(0.0);
    // 1.4 s after the start, the arm is on its way to its first beam.
    let stop = || {
        steps.set(steps.get() + 1);
        (steps.get() > 1400).then(|| "a person stopped the run".to_string())
    };
    let error = {
        let mut watched = Altered { robot: &mut twin, alteration: Fastest(&fastest) };
        let mut guard = Guard::new(&mut watched, [&goal.arm; 2], &EVERYWHERE, &stop);
        goal.baseline(Track::State, SEED).run(&mut guard).unwrap_err()
    };
    assert_eq!(error.to_string(), "a person stopped the run");
    assert!(fastest.get() > 0.3, "nothing moved: {}", fastest.get());
    let seen = twin.observe();
    assert!(seen.velocities.iter().all(|velocity| velocity.abs() < 0.01), "{:?}", seen.velocities);
}

/// An agent that is told of slower joints than it moves is stopped.
#[test]
fn an_agent_that_is_too_fast_is_stopped() {
    let goal = GoalFiles::new("easy-1");
    let mut twin = Twin::new(&Setup { world: World::ideal(), ..goal.setup(Track::State, SEED) }).unwrap();
    let mut slow = goal.arm.clone();
    slow.joints.iter_mut().for_each(|joint| joint.velocity *= 0.1);
    let mut guard = Guard::new(&mut twin, [&goal.arm, &slow], &EVERYWHERE, &|| None);
    let error = goal.baseline(Track::State, SEED).run(&mut guard).unwrap_err();
    assert!(error.to_string().contains("rad/s, allowed are"), "{error}");
    let seen = twin.observe();
    assert!(seen.velocities.iter().all(|velocity| velocity.abs() < 0.01), "{:?}", seen.velocities);
}
