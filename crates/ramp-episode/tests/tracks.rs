//! Tracks: what an agent may see. The baseline builds from readings with noise and from images; it gets
//! nothing else.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]

mod common;

use common::World;
use ramp_robot::{
    Agent, Camera, CameraModel, Command, Event, Image, Observation, PartReading, Robot, RobotError, Track,
};
use ramp_skills::Baseline;
use ramp_twin::Twin;

/// The fault of the cameras.
#[derive(Clone, Copy)]
enum Trouble {
    None,
    /// This one gives no image from a robot time (s) on.
    Stops(Camera, f64),
    /// The light goes out at a robot time, s.
    Dark(f64),
}

/// The twin, limited to a given robot time (s).
struct Short<'t> {
    twin: &'t mut Twin,
    limit: f64,
    trouble: Trouble,
    /// Number of requests that the track does not allow.
    refused: usize,
}

impl Short<'_> {
    fn note<T>(&mut self, given: Result<T, RobotError>) -> Result<T, RobotError> {
        self.refused += usize::from(matches!(given, Err(RobotError::NotOnTrack { .. })));
        given
    }
}

impl Robot for Short<'_> {
    fn step(&mut self, command: &Command) -> Result<Observation, RobotError> {
        if self.twin.time() > self.limit {
            return Err(RobotError::OutOfTime { limit: self.limit });
        }
        self.twin.step(command)
    }

    fn observe(&self) -> Observation {
        self.twin.observe()
    }

    fn read_parts(&mut self) -> Result<Vec<PartReading>, RobotError> {
        let given = self.twin.read_parts();
        self.note(given)
    }

    fn expose(&mut self) -> Result<(), RobotError> {
        let given = self.twin.expose();
        self.note(given)
    }

    fn look(&mut self, camera: Camera) -> Result<Image, RobotError> {
        let given = self.twin.look(camera);
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

    fn camera(&self, camera: Camera) -> CameraModel {
        self.twin.camera(camera)
    }
}

/// Runs the beginning of easy-1: what ended it, what happened, and the state in the end.
fn begin(track: Track, seed: u64, limit: f64, trouble: Trouble) -> (Result<(), RobotError>, Vec<Event>, u64) {
    let world = World::new("easy-1");
    let mut twin = Twin::new(&world.setup_on(track, seed)).unwrap();
    let mut agent = Baseline::new(&world.assembly, &world.arm, &world.domains, seed);
    let ended = agent.run(&mut Short { twin: &mut twin, limit, trouble, refused: 0 });
    (ended, agent.account().events, twin.state_hash())
}

fn has(events: &[Event], kind: &str, what: &str) -> bool {
    events.iter().any(|event| event.kind.name() == kind && event.kind.to_string().contains(what))
}

#[test]
fn easy_1_is_built_from_readings_with_noise() {
    let result = World::new("easy-1").run_on(Track::Noisy, 1);
    assert_eq!((result.track.as_str(), result.counted()), ("noisy", 3), "{:?}", result.events);
    assert_eq!(result.ended.reason, "done");
}

/// An episode in which it does counts on no board.
#[test]
fn the_baseline_asks_for_nothing_that_its_track_does_not_give() {
    let world = World::new("easy-1");
    for track in Track::ALL {
        let mut twin = Twin::new(&world.setup_on(track, 1)).unwrap();
        let agent = Baseline::new(&world.assembly, &world.arm, &world.domains, 1);
        let mut robot = Short { twin: &mut twin, limit: 6.0, trouble: Trouble::None, refused: 0 };
        assert_eq!(agent.on_track(track).run(&mut robot), Err(RobotError::OutOfTime { limit: 6.0 }));
        assert_eq!(robot.refused, 0, "{track:?}");
    }
}

/// With cameras and noise as without: a seed says everything.
#[test]
fn an_episode_is_the_same_to_the_bit_for_a_seed() {
    for (track, limit) in [(Track::Noisy, 20.0), (Track::Tags, 12.0)] {
        let once = begin(track, 7, limit, Trouble::None);
        assert_eq!(once.0, Err(RobotError::OutOfTime { limit }), "{track:?}");
        assert_eq!(once, begin(track, 7, limit, Trouble::None), "{track:?}");
        assert_ne!(once.2, begin(track, 8, limit, Trouble::None).2, "{track:?}");
    }
}

/// A broken camera is reported, and the work continues with the other one.
#[test]
fn a_camera_that_stops_is_told_and_the_run_goes_on() {
    for camera in Camera::ALL {
        let (ended, events, _) = begin(Track::Tags, 1, 25.0, Trouble::Stops(camera, 4.0));
        assert_eq!(ended, Err(RobotError::OutOfTime { limit: 25.0 }), "{events:?}");
        assert!(has(&events, "fault", &format!("`{}` gives no image", camera.name())), "{events:?}");
        assert!(has(&events, "done", "pick up b4"), "{events:?}");
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
    const AGENT: [&str; 9] =
        ["source", "kit", "assembly", "action-language", "planner", "robot", "motion", "vision", "skills"];
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
