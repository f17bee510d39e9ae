//! A twin that is served in a thread of its own.

use std::net::{Ipv4Addr, SocketAddr};
use std::sync::atomic::{AtomicBool, AtomicU16, Ordering};
use std::sync::mpsc;
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;

use ramp_control::ControllerSettings;
use ramp_franka::{Connection, FrankaRobot};
use ramp_robot::Track;
use ramp_robot::arm::ArmModel;
use ramp_served_twin::{FciVersion, Options, Pace, Server, Verdict};
use ramp_testing::{GoalFiles, data};
use ramp_twin::{Setup, Twin, World, controller_settings};

/// The seed of all twins here.
pub const SEED: u64 = 3;

/// Ports that were tried: tests run side by side.
static PORT: AtomicU16 = AtomicU16::new(0);

/// A goal's files with the arm that speaks a version.
pub fn goal_for(version: FciVersion, goal: &str) -> GoalFiles {
    let name = match version {
        FciVersion::V5 => "panda",
        FciVersion::V10 => "fr3",
    };
    let arm = ArmModel::read(&data().join(format!("arms/{name}.json"))).unwrap();
    GoalFiles { arm, ..GoalFiles::new(goal) }
}

/// The twin of a goal in a world.
pub fn twin(goal: &GoalFiles, world: &World, track: Track) -> Twin {
    Twin::new(&Setup { world, ..goal.setup(track, SEED) }).unwrap()
}

/// The world `ideal` with an arm that limits the rate of torques, as every arm behind the protocol does.
pub fn ideal() -> &'static World {
    static IDEAL: OnceLock<World> = OnceLock::new();
    IDEAL.get_or_init(|| World::ideal().clone().with("controller.torque_rate", 1000.0).unwrap())
}

/// The world `real`.
pub fn real() -> &'static World {
    World::shipped("real").unwrap()
}

/// The settings of a controller that knows that twin's arm.
pub fn settings(world: &World) -> ControllerSettings {
    controller_settings(&world.draw(SEED))
}

/// A running server.
pub struct Served {
    pub address: SocketAddr,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<Verdict>>,
    /// What the server said of errors.
    pub said: mpsc::Receiver<String>,
}

impl Served {
    pub fn new(version: FciVersion, world: &'static World, track: Track, pace: Pace) -> Served {
        let over = Arc::new(AtomicBool::new(false));
        let stop = Arc::clone(&over);
        let (send, ready) = mpsc::channel();
        let (tell, said) = mpsc::channel();
        let thread = std::thread::spawn(move || {
            let goal = goal_for(version, "easy-1");
            let begin = 20_000 + (std::process::id() % 8_000) as u16;
            let mut server = loop {
                let port = begin + 3 * PORT.fetch_add(1, Ordering::Relaxed);
                let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
                let options = Options { address, version, pace, recovery: 0.7, model_library: None };
                if let Ok(server) = Server::new(options, twin(&goal, world, track), &goal.assembly, &goal.arm)
                {
                    send.send(address).unwrap();
                    break server;
                }
            }
            .with_listener(Box::new(move |line| {
                // A test that is over does not listen any more.
                let _ = tell.send(line.to_string());
            }));
            server.run(|| stop.load(Ordering::Relaxed));
            server.end()
        });
        Served { address: ready.recv().unwrap(), over, thread: Some(thread), said }
    }

    /// A connection to it.
    pub fn connection(&self, pace: Pace) -> Connection {
        let at = |offset: u16| format!("127.0.0.1:{}", self.address.port() + offset);
        Connection {
            arm: at(0),
            gripper: at(1),
            cell: Some(at(2)),
            pace: match pace {
                Pace::RealTime => ramp_franka::Pace::RealTime,
                Pace::LockStep => ramp_franka::Pace::LockStep,
            },
            reflex_force: 100.0,
            reflex_torque: 87.0,
        }
    }

    /// The project's own robot, connected to it.
    pub fn robot(&self, goal: &GoalFiles, world: &World, track: Track, pace: Pace) -> FrankaRobot {
        FrankaRobot::connect(&self.connection(pace), &goal.arm, &settings(world), track).unwrap()
    }

    /// Ends it, as a program that is killed. Returns the referee's verdict.
    pub fn end(mut self) -> Verdict {
        self.over.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
    }
}
