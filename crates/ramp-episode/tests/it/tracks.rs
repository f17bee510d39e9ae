//! Tracks: what an agent may see. The baseline builds from readings with noise and from images; it gets
//! nothing else.

use ramp_robot::{Agent, Camera, Command, Event, Image, PartReading, RobotError, Track};
use ramp_testing::GoalFiles;
use ramp_testing::robot::{Alteration, Altered};
use ramp_twin::{Setup, Twin};
use ramp_world::World;

/// The fault of the cameras.
#[derive(Clone, Copy)]
enum Trouble {
    None,
    /// This one gives no image from a robot time (s) on.
    Stops(Camera, f64),
    /// The light goes out at a robot time, s.
    Dark(f64),
}

/// Ends the agent's work at a robot time, with trouble on the way.
struct Short {
    /// s
    limit: f64,
    trouble: Trouble,
    /// How often the agent asked for something that its track does not give.
    refused: usize,
}

impl Short {
    fn note<T>(&mut self, given: Result<T, RobotError>) -> Result<T, RobotError> {
        self.refused += usize::from(matches!(given, Err(RobotError::NotOnTrack { .. })));
        given
    }
}

impl Alteration<Twin> for Short {
    fn before(&mut self, twin: &Twin, _command: &mut Command) -> Result<(), RobotError> {
        if twin.time() > self.limit { Err(RobotError::OutOfTime { limit: self.limit }) } else { Ok(()) }
    }

    fn parts(
        &mut self,
        _time: f64,
        given: Result<Vec<PartReading>, RobotError>,
    ) -> Result<Vec<PartReading>, RobotError> {
        self.note(given)
    }

    fn exposed(&mut self, given: Result<(), RobotError>) -> Result<(), RobotError> {
        self.note(given)
    }

    fn image(&mut self, camera: Camera, given: Result<Image, RobotError>) -> Result<Image, RobotError> {
        let mut image = self.note(given)?;
        match self.trouble {
            Trouble::Stops(stopped, from) if stopped == camera && image.time > from => {
                Err(RobotError::CameraStopped { camera })
            }
            Trouble::Dark(from) if image.time > from => {
                image.pixels.fill(3);
                Ok(image)
            }
            _ => Ok(image),
        }
    }
}

/// Runs the beginning of easy-1: what ended it, what happened, and the state in the end.
fn begin(track: Track, seed: u64, limit: f64, trouble: Trouble) -> (Result<(), RobotError>, Vec<Event>, u64) {
    let world = GoalFiles::new("easy-1");
    let mut twin = Twin::new(&world.setup(track, seed)).unwrap();
    let mut agent = world.baseline(track, seed);
    let ended =
        agent.run(&mut Altered { robot: &mut twin, alteration: Short { limit, trouble, refused: 0 } });
    (ended, agent.account().events, twin.state_hash())
}

fn has(events: &[Event], kind: &str, what: &str) -> bool {
    events.iter().any(|event| event.kind.name() == kind && event.kind.to_string().contains(what))
}

#[test]
fn easy_1_is_built_from_readings_with_noise() {
    let result = GoalFiles::new("easy-1").run(Track::Noisy, 1);
    assert_eq!((result.track.as_str(), result.counted()), ("noisy", 3), "{:?}", result.events);
    assert_eq!(result.ended.reason, "done");
}

/// An episode in which it does counts on no board.
#[test]
fn the_baseline_asks_for_nothing_that_its_track_does_not_give() {
    let world = GoalFiles::new("easy-1");
    for track in Track::ALL {
        let mut twin = Twin::new(&world.setup(track, 1)).unwrap();
        let mut agent = world.baseline(track, 1);
        let alteration = Short { limit: 6.0, trouble: Trouble::None, refused: 0 };
        let mut robot = Altered { robot: &mut twin, alteration };
        assert_eq!(agent.run(&mut robot), Err(RobotError::OutOfTime { limit: 6.0 }));
        assert_eq!(robot.alteration.refused, 0, "{track:?}");
    }
}

/// Readings with noise and images, too, are those of the seed.
#[test]
fn an_episode_is_the_same_to_the_bit_for_a_seed() {
    for (track, limit) in [(Track::Noisy, 20.0), (Track::Tags, 12.0)] {
        let once = begin(track, 7, limit, Trouble::None);
        assert_eq!(once.0, Err(RobotError::OutOfTime { limit }), "{track:?}");
        assert_eq!(once, begin(track, 7, limit, Trouble::None), "{track:?}");
    }
}

/// A broken camera is reported, and the work continues with the other one.
#[test]
fn a_camera_that_stops_is_told_and_the_run_goes_on() {
    for camera in Camera::ALL {
        let (ended, events, _) = begin(Track::Tags, 1, 25.0, Trouble::Stops(camera, 4.0));
        assert_eq!(ended, Err(RobotError::OutOfTime { limit: 25.0 }), "{events:?}");
        assert!(has(&events, "fault", &format!("`{}` gives no image", camera.name())), "{events:?}");
        assert!(has(&events, "action_ended", "pick up b4"), "{events:?}");
    }
}

/// Without any working camera the run ends with a reason; it does not continue from the old belief.
#[test]
fn a_robot_in_the_dark_ends_with_a_reason() {
    let (ended, events, _) = begin(Track::Tags, 1, 60.0, Trouble::Dark(4.0));
    assert!(matches!(ended, Err(RobotError::CameraStopped { .. })), "{ended:?}");
    assert!(has(&events, "fault", "black"), "{events:?}");
    assert!(!has(&events, "done", "insert"), "{events:?}");
}

/// The agent's crates are built without the twin and without the referee: there is no path to the truth but
/// the trait. The crates that an agent is made of use one another and no other crate of ours.
#[test]
fn nothing_that_an_agent_is_made_of_knows_the_twin() {
    // Of `world` an agent is told the limits of its start. A draw needs the seed.
    const AGENT: [&str; 10] = [
        "source",
        "kit",
        "assembly",
        "action-language",
        "planner",
        "robot",
        "world",
        "motion",
        "vision",
        "skills",
    ];
    let crates = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for name in AGENT {
        let text = std::fs::read_to_string(crates.join(format!("ramp-{name}/Cargo.toml"))).unwrap();
        let dependencies = text.split("[dependencies]").nth(1).unwrap().split("\n[").next().unwrap();
        assert!(!dependencies.contains("mujoco"), "ramp-{name} depends on the engine");
        for used in dependencies.lines().filter_map(|line| line.strip_prefix("ramp-")) {
            let used = used.split(['.', ' ']).next().unwrap();
            assert!(AGENT.contains(&used), "ramp-{name} depends on ramp-{used}");
        }
    }
}

/// Without any tag, from images alone, with the faults of the real world: every peg counts, and a peg that
/// the fingers drop is found again.
#[test]
fn the_baseline_builds_without_tags() {
    let world = World::shipped("real").unwrap();
    let result = GoalFiles::new("easy-1").run_in(world, Track::Colour, 3);
    assert_eq!(result.ended.reason, "done", "{:?}", result.events);
    assert!((result.completion - 1.0).abs() < 1e-12, "{:?}", result.events);
    let files = GoalFiles::new("easy-3");
    let fault = Some("peg-dropped@1".parse().unwrap());
    let setup = Setup { world, fault, ..files.setup(Track::Colour, 1) };
    let result = files.run_setup(&setup);
    assert!((result.completion - 1.0).abs() < 1e-12, "{:?}", result.events);
}

/// The same with depth.
#[test]
fn the_baseline_builds_with_depth() {
    let world = World::shipped("real").unwrap();
    let result = GoalFiles::new("easy-1").run_in(world, Track::Depth, 3);
    assert!((result.completion - 1.0).abs() < 1e-12, "{:?}", result.events);
}
