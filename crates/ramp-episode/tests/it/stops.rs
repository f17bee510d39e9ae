//! Stops of the arm after which it is ready again: the agent is told, the result counts them, and a log
//! repeats them.

use ramp_episode::replay;
use ramp_log::Log;
use ramp_robot::{Account, Agent, EventKind, Robot, RobotError, Track};
use ramp_testing::robot::press;
use ramp_testing::{GoalFiles, data};
use ramp_twin::{Setup, World};

/// Presses on the table until the arm stops, and then lifts the hand, so many times.
struct Presser {
    times: usize,
    /// The errors that it was told.
    told: Vec<RobotError>,
}

impl Agent for Presser {
    fn name(&self) -> (&str, &str) {
        ("presser", "1")
    }

    fn account(&self) -> Account {
        Account::default()
    }

    fn run(&mut self, robot: &mut dyn Robot) -> Result<(), RobotError> {
        let home = robot.observe();
        for _ in 0..self.times {
            let down = robot.observe().x_wt.translation.z + 0.1;
            match press(robot, -down, home.positions) {
                Err(error) if !error.is_final() => self.told.push(error),
                other => other?,
            }
            let up = home.x_wt.translation.z - robot.observe().x_wt.translation.z;
            press(robot, up, home.positions)?;
        }
        Ok(())
    }
}

/// In the world `real`, an agent that presses until the reflex is told, and goes on. Each stop is an event
/// and counted, takes the world's time, and is the same in a replay.
#[test]
fn a_reflex_in_the_real_world_is_recovered_counted_and_replayed() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("a.mcap");
    let goal = GoalFiles::new("easy-1");
    let world = World::shipped("real").unwrap();
    let setup = Setup { world, ..goal.setup(Track::State, 3) };
    let mut agent = Presser { times: 2, told: Vec::new() };
    let result = goal.record(&setup, &mut agent, &path);
    let expected = world.draw(3).controller.recovery;
    assert_eq!(result.ended.reason, "done");
    assert_eq!(agent.told.len(), 2);
    assert_eq!(result.physics.as_ref().map(|physics| physics.stops), Some(2));
    let events = result.events.iter();
    let stops: Vec<(f64, f64)> = events
        .filter_map(|event| match &event.kind {
            EventKind::Recovered { after, why } if why.starts_with("reflex: ") => Some((event.time, *after)),
            _ => None,
        })
        .collect();
    let [(first, after), (second, _)] = stops[..] else { panic!("{:?}", result.events) };
    assert!((after - expected).abs() < 1e-3, "{after} and {expected} s");
    assert!(second > first + after && result.time.robot > second + after, "{stops:?}");
    let schema = std::fs::read_to_string(data().join("schema/episode.schema.json")).unwrap();
    let schema = serde_json::from_str(&schema).unwrap();
    assert!(jsonschema::is_valid(&schema, &serde_json::to_value(&result).unwrap()));

    let replayed = replay(&Log::read(&path).unwrap()).unwrap();
    assert!(replayed.is_equal(), "{:?}", replayed.differences);
}

/// A log that leaves a stop out of its result is found out.
#[test]
fn a_result_that_hides_a_stop_differs_from_its_replay() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("a.mcap");
    let goal = GoalFiles::new("easy-1");
    let setup = Setup { world: World::shipped("real").unwrap(), ..goal.setup(Track::State, 3) };
    goal.record(&setup, &mut Presser { times: 1, told: Vec::new() }, &path);
    let mut log = Log::read(&path).unwrap();
    log.result.physics.as_mut().unwrap().stops = 0;
    let replayed = replay(&log).unwrap();
    let what: Vec<&str> = replayed.differences.iter().map(|it| it.what.as_str()).collect();
    assert_eq!(what, ["stops of the arm"]);
}
