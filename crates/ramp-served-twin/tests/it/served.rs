//! A twin that is served in a thread of its own.

use std::net::{Ipv4Addr, SocketAddr};
use std::sync::atomic::{AtomicBool, AtomicU16, AtomicU64, Ordering};
use std::sync::mpsc;
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;
use std::time::Duration;

use ramp_control::ControllerSettings;
use ramp_franka::{Connection, FrankaRobot};
use ramp_robot::Track;
use ramp_robot::arm::ArmModel;
use ramp_served_twin::{FciVersion, Options, Pace, Server, Verdict};
use ramp_testing::{GoalFiles, data};
use ramp_twin::{Setup, Twin, World, controller_settings};

/// The seed of all twins here.
pub const SEED: u64 = 3;

/// How long a waiting side sleeps before it looks again.
const NAP: Duration = Duration::from_micros(20);

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

/// The library of the arm's model, which cargo puts beside the tests.
pub fn model_library() -> Vec<u8> {
    use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
    let name = format!("{DLL_PREFIX}ramp_franka_model{DLL_SUFFIX}");
    std::fs::read(std::env::current_exe().unwrap().with_file_name(name)).unwrap()
}

/// Lets a server do one cycle after another, so that a test can decide which commands come in time.
#[derive(Default)]
pub struct Gate {
    over: AtomicBool,
    closed: AtomicBool,
    /// Cycles that may be done while it is closed.
    allowed: AtomicU64,
    /// Cycles that are done.
    done: AtomicU64,
    /// Whether the server waits at the closed gate.
    waits: AtomicBool,
}

impl Gate {
    /// Waits until the server may go on. Returns whether it is over.
    fn pass(&self) -> bool {
        while self.closed.load(Ordering::SeqCst) && self.allowed.load(Ordering::SeqCst) == 0 {
            if self.over.load(Ordering::SeqCst) {
                return true;
            }
            self.waits.store(true, Ordering::SeqCst);
            std::thread::sleep(NAP);
        }
        self.waits.store(false, Ordering::SeqCst);
        if self.closed.load(Ordering::SeqCst) {
            self.allowed.fetch_sub(1, Ordering::SeqCst);
        }
        self.done.fetch_add(1, Ordering::SeqCst);
        self.over.load(Ordering::SeqCst)
    }

    /// Stops the server before its next cycle. Returns the number of the state that it sent last.
    pub fn close(&self) -> u64 {
        self.closed.store(true, Ordering::SeqCst);
        while !self.waits.load(Ordering::SeqCst) {
            std::thread::sleep(NAP);
        }
        // The state before the first cycle has the number one.
        self.done.load(Ordering::SeqCst) + 1
    }

    /// Lets the server do one cycle.
    pub fn step(&self) {
        self.allowed.fetch_add(1, Ordering::SeqCst);
    }

    /// Lets the server run again.
    pub fn open(&self) {
        self.closed.store(false, Ordering::SeqCst);
    }
}

/// A running server.
pub struct Served {
    pub address: SocketAddr,
    pub gate: Arc<Gate>,
    thread: Option<JoinHandle<Verdict>>,
    /// What the server said of errors.
    pub said: mpsc::Receiver<String>,
}

impl Served {
    /// At a free port.
    pub fn new(version: FciVersion, world: &'static World, track: Track, pace: Pace) -> Served {
        let begin = 20_000 + (std::process::id() % 8_000) as u16;
        let ports = std::iter::repeat_with(move || begin + 3 * PORT.fetch_add(1, Ordering::Relaxed));
        let addresses = ports.map(|port| SocketAddr::from((Ipv4Addr::LOCALHOST, port)));
        Served::at(addresses, version, world, track, pace)
    }

    /// At the first of these addresses that is free.
    pub fn at(
        addresses: impl Iterator<Item = SocketAddr> + Send + 'static,
        version: FciVersion,
        world: &'static World,
        track: Track,
        pace: Pace,
    ) -> Served {
        let gate = Arc::new(Gate::default());
        let theirs = Arc::clone(&gate);
        let (send, ready) = mpsc::channel();
        let (tell, said) = mpsc::channel();
        let thread = std::thread::spawn(move || {
            let goal = goal_for(version, "easy-1");
            let opened = |address| {
                let model_library = Some(model_library());
                let options = Options { address, version, pace, recovery: 0.7, model_library };
                let server =
                    Server::new(options, twin(&goal, world, track), &goal.assembly, &goal.arm).ok()?;
                send.send(address).unwrap();
                Some(server)
            };
            let mut server = { addresses }.find_map(opened).unwrap().with_listener(Box::new(move |line| {
                // A test that is over does not listen any more.
                let _ = tell.send(line.to_string());
            }));
            server.run(|| theirs.pass());
            server.end()
        });
        Served { address: ready.recv().unwrap(), gate, thread: Some(thread), said }
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
        self.gate.over.store(true, Ordering::SeqCst);
        self.thread.take().unwrap().join().unwrap()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.gate.over.store(true, Ordering::SeqCst);
    }
}
