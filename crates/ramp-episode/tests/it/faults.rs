//! Faults on purpose, in the real physics with the baseline at work: each does what its page says, and a
//! replay does it again.

use std::path::Path;

use nalgebra::Vector3;
use ramp_episode::{Label, record_episode, replay};
use ramp_log::Log;
use ramp_log::Sources;
use ramp_result::episode::Software;
use ramp_robot::{Account, Agent, Camera, Command, Observation, Pose, Robot, RobotError, Track};
use ramp_skills::Baseline;
use ramp_testing::episode::Swing;
use ramp_testing::robot::{Alteration, Altered, StopAt};
use ramp_testing::{GoalFiles, data};
use ramp_twin::{Fault, FaultReport, Setup, Twin};

/// Ends the agent's work a while after a fault has struck.
struct Until {
    /// s
    after: f64,
    /// The truth and the tip at the strike.
    struck: Option<(Vec<Pose>, Observation)>,
    /// The largest distance between the fingers since then, while they are commanded to close, m.
    widest: f64,
}

impl Alteration<Twin> for Until {
    fn after(&mut self, twin: &Twin, command: &Command, seen: &Observation) -> Result<(), RobotError> {
        let Some(at) = twin.fault().and_then(|fault| fault.at) else { return Ok(()) };
        if self.struck.is_none() {
            self.struck = Some((twin.truth().x_wp, seen.clone()));
        }
        // Any final error ends the agent's work.
        if seen.time > at + self.after {
            return Err(RobotError::OutOfTime { limit: seen.time });
        }
        if command.gripper.width < 0.03 {
            self.widest = self.widest.max(seen.width);
        }
        Ok(())
    }
}

/// A peg that fell beside its hole, where no camera finds its tag, keeps no other peg from it.
#[test]
fn a_peg_that_is_lost_stands_in_no_way() {
    let goal = GoalFiles::new("easy-1");
    let real = ramp_twin::World::shipped("real").unwrap();
    let fault = Some("peg-dropped@1".parse().unwrap());
    let start = ramp_twin::Start::moved();
    let setup = Setup { fault, start, world: real, ..goal.setup(Track::Tags, 2) };
    let mut twin = Twin::new(&setup).unwrap();
    let mut agent = goal.baseline(Track::Tags, 2);
    let alteration = Until { after: 16.0, struck: None, widest: 0.0 };
    agent.run(&mut Altered { robot: &mut twin, alteration }).unwrap_err();
    let lost = twin.fault().unwrap().part.clone().unwrap();
    let events: Vec<String> = agent.account().events.iter().map(|event| event.kind.to_string()).collect();
    let fastened = |event: &String| event.starts_with("fasten C1") && !event.ends_with(&lost);
    assert!(events.iter().any(fastened), "{events:?}");
}

/// The outcome of a fault, a given time (s) after its trigger.
struct Outcome {
    report: FaultReport,
    twin: Twin,
    /// Index of the part that was struck, and its pose at the strike; `None` for a holder.
    part: Option<(usize, Pose)>,
    before: Vec<Pose>,
    seen: Observation,
    widest: f64,
}

impl Outcome {
    fn now(&self, part: usize) -> Pose {
        self.twin.truth().x_wp[part]
    }

    /// Where the struck beam is, where it belongs, and the beam.
    fn beam<'w>(&self, world: &'w GoalFiles) -> (Pose, Pose, &'w ramp_kit::Beam) {
        let name = self.report.part.as_ref();
        let placed = world.assembly.beams.iter().find(|it| Some(&it.beam.name) == name).unwrap();
        (self.now(self.part.unwrap().0), world.assembly.kit.x_wa() * placed.x_ab, &placed.beam)
    }

    /// The motion of the affected part in the hand: m, rad.
    fn moved_in_hand(&self) -> (f64, f64) {
        let (part, before) = self.part.unwrap();
        let before = self.seen.x_wt.inverse() * before;
        let now = self.twin.observe().x_wt.inverse() * self.now(part);
        let shift = (now.translation.vector - before.translation.vector).norm();
        (shift, before.rotation.angle_to(&now.rotation))
    }
}

fn setup<'w>(world: &'w GoalFiles, fault: &str) -> Setup<'w> {
    let fault: Fault = fault.parse().unwrap();
    Setup { fault: Some(fault), ..world.setup(Track::State, 1) }
}

fn strike(world: &GoalFiles, fault: &str, after: f64) -> Outcome {
    let mut twin = Twin::new(&setup(world, fault)).unwrap();
    let mut agent = world.baseline(Track::State, 1);
    let alteration = Until { after, struck: None, widest: 0.0 };
    let mut until = Altered { robot: &mut twin, alteration };
    assert!(agent.run(&mut until).is_err(), "{fault} did not strike");
    let ((before, seen), widest) = (until.alteration.struck.unwrap(), until.alteration.widest);
    let report = twin.fault().unwrap().clone();
    let part = twin.part_names().position(|name| Some(name) == report.part.as_deref());
    Outcome { part: part.map(|part| (part, before[part])), report, twin, before, seen, widest }
}

#[test]
fn parts_are_moved_in_the_grip_and_out_of_it() {
    let world = GoalFiles::new("easy-1");
    let dropped = strike(&world, "peg-dropped@1", 1.0);
    let (part, _) = dropped.part.unwrap();
    let fallen = dropped.seen.x_wt.translation.z - dropped.now(part).translation.z;
    assert!(fallen > 0.05, "the peg is {fallen} m below where the hand was");

    let tilted = strike(&world, "peg-tilted@1", 2.0);
    let (_, angle) = tilted.moved_in_hand();
    assert!((0.07..0.3).contains(&angle), "tilted by {angle} rad");

    let slipped = strike(&world, "beam-slipped@1", 2.0);
    let (shift, _) = slipped.moved_in_hand();
    assert!((3.0e-3..20.0e-3).contains(&shift), "slipped by {shift} m");

    let turned = strike(&world, "beam-turned@1", 2.2);
    let (_, angle) = turned.moved_in_hand();
    assert!((0.05..0.25).contains(&angle), "turned by {angle} rad");
}

#[test]
fn what_stands_is_pushed_and_what_is_inserted_held_up() {
    let world = GoalFiles::new("easy-1");
    let bumped = strike(&world, "beam-bumped@1", 1.5);
    let size = bumped.report.size.unwrap();
    assert!((2.5e-3..17.0e-3).contains(&size), "pushed by {size} m");
    let (x_wb, goal, beam) = bumped.beam(&world);
    let last = beam.p_b_hole(beam.joints.len() - 1);
    let off = (x_wb * last - goal * last).norm();
    assert!(off > size, "its end is {off} m from where it was");

    let shifted = strike(&world, "holder-shifted@1", 1.5);
    assert_eq!(shifted.report.part.as_deref(), Some("h1"));
    let size = shifted.report.size.unwrap();
    assert!((2.5e-3..9.0e-3).contains(&size), "pushed by {size} m");
    // The pegs that are left in it go with it.
    for peg in ["p2", "p3"] {
        let index = shifted.twin.part_names().position(|name| name == peg).unwrap();
        let shift = shifted.now(index).translation.vector - shifted.before[index].translation.vector;
        assert!((shift.norm() - size).abs() < 1.5e-3, "{peg} went {} m", shift.norm());
    }

    // Two seconds after it met the burr, a beam is still short of where it goes.
    let jammed = strike(&world, "jam@1", 2.0);
    let (x_wb, goal, _) = jammed.beam(&world);
    let short = (x_wb.translation.vector - goal.translation.vector).norm();
    assert!(short > 3.0e-3, "only {short} m short");
}

#[test]
fn fingers_and_sensors_fail() {
    let world = GoalFiles::new("easy-1");
    let weak = strike(&world, "gripper-weak@1", 0.1);
    let open = weak.widest - weak.seen.width;
    assert!((1.0e-3..5.0e-3).contains(&open), "the fingers spring back by {open} m");

    // The same time without a fault: the arm has made the same motions, and measured another wrench.
    let drift = strike(&world, "force-drift@1", 5.0);
    let (at, growth) = (drift.report.at.unwrap(), drift.report.size.unwrap());
    let mut calm = Twin::new(&world.setup(Track::State, 1)).unwrap();
    let mut agent = world.baseline(Track::State, 1);
    let end = drift.twin.time();
    assert!(agent.run(&mut Altered { robot: &mut calm, alteration: StopAt(end) }).is_err());
    let force = |twin: &Twin| -> Vector3<f64> { twin.observe().wrench.fixed_rows::<3>(0).into() };
    let off = (force(&drift.twin) - force(&calm)).norm();
    assert!((off - growth * (end - at)).abs() < 0.02, "off by {off} N, {growth} N/s since {at} s");
    assert_eq!(drift.twin.state_hash(), calm.state_hash(), "a sensor does not move anything");
}

#[test]
fn cameras_repeat_their_images_and_miss_a_tag_and_a_peg() {
    let world = GoalFiles::new("easy-1");
    let mut frozen = strike(&world, "camera-frozen@1", 0.5).twin;
    let stay = Command {
        arm: ramp_robot::ArmCommand::JointVelocities([0.0; 7]),
        gripper: ramp_robot::GripperCommand { width: 0.0, force: 60.0 },
    };
    for camera in Camera::ALL {
        let (one, two) = (frozen.look(camera).unwrap(), frozen.look(camera).unwrap());
        assert_eq!(one.pixels, two.pixels);
        assert!(two.time > one.time);
        // In another size it is the same image, not a new one.
        let small = frozen.look_sized(camera, ramp_robot::ImageWidth::new(320)).unwrap();
        let at = |row: usize, column: usize| 3 * ((4 * row + 2) * two.width + 4 * column + 2);
        for (row, column) in [(0, 0), (100, 160), (199, 319)] {
            let own = &small.pixels[3 * (row * 320 + column)..][..3];
            assert_eq!(own, &two.pixels[at(row, column)..][..3], "{camera:?}, {row}, {column}");
        }
    }
    let before = frozen.look(Camera::Wrist).unwrap();
    for _ in 0..5000 {
        frozen.step(&stay).unwrap();
    }
    assert_ne!(before.pixels, frozen.look(Camera::Wrist).unwrap().pixels);

    // A tag that is covered changes the image where that tag is, and nowhere else.
    let image = |fault: Option<Fault>| {
        let setup = Setup { fault, ..world.setup(Track::State, 1) };
        let mut twin = Twin::new(&setup).unwrap();
        let pixels = twin.look(Camera::BirdsEye).unwrap().pixels;
        (pixels, twin)
    };
    let (plain, _) = image(None);
    let (covered, twin) = image(Some("tag-covered@1".parse().unwrap()));
    let changed = plain.chunks(3).zip(covered.chunks(3)).filter(|(one, other)| one != other).count();
    assert!((20..2000).contains(&changed), "{changed} pixels");
    assert_eq!(twin.fault().unwrap().at, Some(0.0));

    let (_, twin) = image(Some("peg-missing@2".parse().unwrap()));
    assert_eq!(twin.fault().unwrap().part.as_deref(), Some("p2"));
    assert!(!twin.part_names().any(|name| name == "p2"));
}

/// The baseline, stopped some seconds after the start.
struct Short<'w>(Baseline<'w>);

impl Agent for Short<'_> {
    fn name(&self) -> (&str, &str) {
        ("short", "1")
    }

    fn account(&self) -> Account {
        self.0.account()
    }

    fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError> {
        // That it was stopped is no error of the robot's.
        let _ = self.0.run(&mut Altered { robot, alteration: StopAt(10.0) });
        Ok(())
    }
}

#[test]
fn a_replay_has_the_fault_too() {
    let world = GoalFiles::new("easy-1");
    let read = |name: &str| std::fs::read_to_string(data().join(name)).unwrap();
    let (goal, kit, arm) = (read("goals/easy-1.xml"), read("kit.xml"), read("arms/panda.json"));
    let sources = Sources { goal: &goal, kit: &kit, arm: &arm };
    let software = Software { version: "test".into(), commit: "test".into() };
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("a.mcap");
    let mut agent = Short(world.baseline(Track::State, 1));
    let setup = setup(&world, "beam-slipped@1");
    let label = Label::new(software.clone(), 1);
    let result = record_episode(&setup, &sources, &mut agent, &label, &path, &mut |_, _| {}).unwrap().result;
    let fault = result.fault.clone().unwrap();
    assert_eq!((fault.kind.as_str(), fault.occasion, fault.part.as_deref()), ("beam-slipped", 1, Some("b4")));

    let log = Log::read(&path).unwrap();
    assert_eq!(log.header.fault.as_deref(), Some("beam-slipped@1"));
    let replayed = replay(&log).unwrap();
    assert!(replayed.is_equal(), "{:?}", replayed.differences);

    // The report about a fault must be true.
    let mut other = log.clone();
    other.result.fault = None;
    assert!(replay(&other).unwrap_err().to_string().contains("fault"));
    let mut other = log.clone();
    other.header.fault = Some("beam-sloped".to_string());
    other.result.fault.as_mut().unwrap().kind = "beam-sloped".to_string();
    assert!(replay(&other).unwrap_err().to_string().contains("beam-sloped"));

    // Result and header are of the published schemas.
    for (schema, value) in [
        ("schema/episode.schema.json", serde_json::to_value(&result).unwrap()),
        ("schema/log/episode.schema.json", serde_json::to_value(&log.header).unwrap()),
    ] {
        let schema = serde_json::from_str(&read(schema)).unwrap();
        let errors: Vec<String> = jsonschema::validator_for(&schema)
            .unwrap()
            .iter_errors(&value)
            .map(|error| error.to_string())
            .collect();
        assert!(errors.is_empty(), "{errors:?}");
    }
    assert!(!Path::new(&path).with_extension("mcap.partial").exists());
}

/// On every track an episode without a fault has no such field.
#[test]
fn an_ordinary_result_says_nothing_of_faults() {
    let world = GoalFiles::new("easy-1");
    let mut twin = Twin::new(&world.setup(Track::Noisy, 1)).unwrap();
    assert_eq!(twin.fault(), None);
    assert!(twin.read_parts().is_ok());
    let folder = tempfile::TempDir::new().unwrap();
    let result = world.record_noisy(&mut Swing(100), &folder.path().join("a.mcap"));
    assert!(!result.to_json().contains("\"fault\":"));
}
