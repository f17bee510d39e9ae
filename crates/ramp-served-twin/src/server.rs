//! The server: one thread, sockets that do not block, and the twin.
//!
//! In each cycle it hears what clients ask, takes the newest command that answers the last state, lets the
//! arm do a millisecond, and sends the next state.

use std::net::{IpAddr, SocketAddr, TcpListener, UdpSocket};
use std::time::{Duration, Instant};

use franka::wire::HeaderLayout;
use franka::{Errors, FciVersion, MoveStatus};
use ramp_assembly::Assembly;
use ramp_referee::{REST, Referee};
use ramp_robot::arm::ArmModel;
use ramp_robot::{PERIOD, RobotError};
use ramp_twin::Twin;

use crate::cell::Cell;
use crate::gripper::{Gripper, REPORT_EVERY};
use crate::motion::{CONTROLLER_OTHER, Cycle, Doing, robot_mode, status};
use crate::plant::Plant;
use crate::session::{Message, Session};
use crate::state::{Commanded, ERRORS, IDENTITY, State};
use crate::urdf::urdf;

/// Control periods between two looks of the referee.
const WATCH_EVERY: u64 = 10;
/// Interval of the states before the first command of a motion in lock-step. Chosen: a client needs less to
/// answer. At the pace of a motion, the first command would come after the next state.
const SLOW: Duration = Duration::from_millis(20);
/// Time for which a wait in lock-step spins before it naps, and the length of a nap.
const SPIN: Duration = Duration::from_micros(200);
const NAP: Duration = Duration::from_micros(50);

/// How time passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// A millisecond takes a millisecond.
    RealTime,
    /// In a motion the arm waits for each command. Outside of one, the physics stand still while no gripper
    /// moves. Two runs give the same result.
    LockStep,
}

/// How a twin is served.
#[derive(Clone, Debug)]
pub struct Options {
    /// The address of the arm's service. The gripper is at the next port, the cell at the one after it.
    pub address: SocketAddr,
    /// The version of Franka's protocol: 10 is an FR3's, 5 a Panda's.
    pub version: FciVersion,
    /// How time passes.
    pub pace: Pace,
    /// Time that a recovery after an error takes, s. 0.7 to 7.3 s were measured (franka_ros issue 317).
    pub recovery: f64,
    /// The shared library of the arm's model that clients of version 5 load; without it they are told that
    /// there is none.
    pub model_library: Option<Vec<u8>>,
}

/// Numbers of a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Cycles of motions.
    pub cycles: u64,
    /// Those that had no command in time.
    pub missed: u64,
    /// Cycles that began late by the clock.
    pub late: u64,
    /// The longest cycle's work.
    pub longest: Duration,
}

/// The referee's verdict at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// Pegs that count.
    pub seated: usize,
    /// Pegs of the goal.
    pub pegs: usize,
    /// Time of the twin, s.
    pub time: f64,
    /// Largest force of the hand, N.
    pub largest_force: f64,
    /// Hash of the twin's state.
    pub state: u64,
}

/// A twin behind Franka's protocol.
pub struct Server {
    pub(crate) options: Options,
    robot_port: TcpListener,
    gripper_port: TcpListener,
    cell_port: TcpListener,
    robot_states: UdpSocket,
    gripper_states: UdpSocket,
    pub(crate) client: Option<Session>,
    gripper: Gripper,
    cell: Cell,
    pub(crate) plant: Plant,
    referee: Referee,
    /// Control periods of the twin so far.
    periods: u64,
    pub(crate) model: String,
    pub(crate) state: State,
    pub(crate) doing: Doing,
    pub(crate) most_torque: [f64; ramp_robot::DOF],
    pub(crate) most_force: [f64; 6],
    statistics: Statistics,
    listener: Box<Listener>,
}

/// Gets a line for each error of the arm and for each refused motion.
pub type Listener = dyn FnMut(&str) + Send;

/// How a wait for a command ended.
enum Waited {
    Came(Commanded),
    Asked,
    Silent,
}

/// Position of an error in a state's flags.
pub(crate) fn index(name: &str) -> usize {
    Errors::index_of(name).unwrap_or(0)
}

impl Server {
    /// Opens the ports for a twin of this goal and arm.
    ///
    /// # Errors
    /// If a port cannot be had.
    pub fn new(
        options: Options,
        mut twin: Twin,
        assembly: &Assembly,
        arm: &ArmModel,
    ) -> std::io::Result<Server> {
        let tcp = |offset: u16| -> std::io::Result<TcpListener> {
            let port = options.address.port().checked_add(offset).ok_or(std::io::ErrorKind::InvalidInput)?;
            let listener = TcpListener::bind(SocketAddr::new(options.address.ip(), port))?;
            listener.set_nonblocking(true)?;
            Ok(listener)
        };
        let udp = |ip: IpAddr| -> std::io::Result<UdpSocket> {
            let socket = UdpSocket::bind(SocketAddr::new(ip, 0))?;
            socket.set_nonblocking(true)?;
            Ok(socket)
        };
        let ip = options.address.ip();
        let referee = Referee::new(assembly, twin.part_names());
        twin.record_moments(WATCH_EVERY);
        let plant = Plant::new(twin, arm);
        let state = begin_state(&plant);
        Ok(Server {
            robot_port: tcp(0)?,
            gripper_port: tcp(1)?,
            cell_port: tcp(2)?,
            robot_states: udp(ip)?,
            gripper_states: udp(ip)?,
            options,
            client: None,
            gripper: Gripper::default(),
            cell: Cell::new(),
            referee,
            periods: 0,
            model: urdf(arm),
            doing: Doing::Rest,
            most_torque: arm.joints.each_ref().map(|joint| joint.torque),
            most_force: [100.0; 6],
            statistics: Statistics::default(),
            listener: Box::new(|_| {}),
            plant,
            state,
        })
    }

    /// The same, with `listener` for what goes wrong.
    #[must_use]
    pub fn with_listener(self, listener: Box<Listener>) -> Server {
        Server { listener, ..self }
    }

    pub(crate) fn say(&mut self, line: &str) {
        (self.listener)(line);
    }

    /// Numbers of the session so far.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// The referee's last verdict, after it has seen how the parts rest without the arm.
    pub fn end(mut self) -> Verdict {
        let last = self.plant.twin.moment();
        self.referee.penetrated(&last.truth, &last.penetrations);
        self.referee.watch(&last.truth, 0.0);
        for moment in self.plant.twin.without_arm(REST, WATCH_EVERY) {
            self.referee.rested(&moment.truth, &moment.penetrations);
        }
        let verdict = self.referee.verdict();
        Verdict {
            seated: verdict.iter().flatten().count(),
            pegs: verdict.len(),
            time: self.plant.twin.time(),
            largest_force: self.plant.twin.largest_force(),
            state: self.plant.twin.state_hash(),
        }
    }

    /// Serves until `over` says so. It is asked once in each cycle.
    pub fn run(&mut self, mut over: impl FnMut() -> bool) {
        let mut next = Instant::now();
        while !over() {
            // A client that has gone makes room for the next one.
            self.listen();
            self.accept();
            let command = match &self.doing {
                Doing::Move(motion) if self.options.pace == Pace::LockStep && self.client.is_some() => {
                    let patience = (!motion.begun).then_some(SLOW);
                    next = Instant::now();
                    match self.wait_for_command(patience, &mut over) {
                        Waited::Came(command) => Some(command),
                        Waited::Silent => None,
                        // A request came, or the client went: that is looked at first.
                        Waited::Asked => continue,
                    }
                }
                _ => {
                    next += Duration::from_secs_f64(PERIOD);
                    let now = Instant::now();
                    if next > now {
                        std::thread::sleep(next - now);
                    } else {
                        // Time that was lost is not made up for.
                        self.statistics.late += 1;
                        next = now;
                    }
                    self.listen();
                    self.received()
                }
            };
            self.cycle(command);
        }
    }

    /// Takes clients that wait: one for the arm, one for the gripper, one for the cell. A second one is
    /// refused.
    fn accept(&mut self) {
        if let Some(session) = Session::accept(&self.robot_port, HeaderLayout::Robot)
            && self.client.is_none()
        {
            self.client = Some(session);
        }
        if let Some(session) = Session::accept(&self.gripper_port, HeaderLayout::Gripper) {
            self.gripper.connect(session);
        }
        self.cell.accept(&self.cell_port);
    }

    /// Hears the clients of cell and gripper, and answers the arm's. Returns whether the arm's or the
    /// gripper's asked anything.
    fn listen(&mut self) -> bool {
        self.cell.listen(&mut self.plant, self.state.message);
        let mut any = self.gripper.listen(&mut self.plant);
        while let Some(client) = &mut self.client {
            match client.next() {
                Message::Request(request) => {
                    any = true;
                    self.request(&request);
                }
                Message::Nothing => break,
                Message::Closed => {
                    self.client = None;
                    if matches!(self.doing, Doing::Move(_)) {
                        self.state.errors[index("communication_constraints_violation")] = 1;
                        self.rest(Doing::Stopped, robot_mode::REFLEX);
                    }
                    return true;
                }
            }
        }
        any
    }

    /// The newest command of the client that answers the last state.
    fn received(&mut self) -> Option<Commanded> {
        let client = self.client.as_ref().and_then(|client| client.states).map(|states| states.ip());
        let mut buffer = [0; 4096];
        let mut found = None;
        while let Ok((count, sender)) = self.robot_states.recv_from(&mut buffer) {
            if Some(sender.ip()) != client {
                continue;
            }
            let command = Commanded::read(self.options.version, &buffer[..count]);
            found = command.filter(|command| command.message == self.state.message).or(found);
        }
        found
    }

    /// Lock-step: waits for the command, a request or the client's end.
    fn wait_for_command(&mut self, patience: Option<Duration>, over: &mut impl FnMut() -> bool) -> Waited {
        let begin = Instant::now();
        loop {
            if let Some(command) = self.received() {
                // What was said before the command is heard before it.
                self.listen();
                return Waited::Came(command);
            }
            if self.listen() || over() {
                return Waited::Asked;
            }
            self.accept();
            if patience.is_some_and(|patience| begin.elapsed() > patience) {
                return Waited::Silent;
            }
            if begin.elapsed() > SPIN {
                std::thread::sleep(NAP);
            } else {
                std::thread::yield_now();
            }
        }
    }

    /// The arm stays where it is.
    pub(crate) fn rest(&mut self, doing: Doing, mode: u8) {
        self.plant.twin.stand();
        self.doing = doing;
        self.state.motion = 0;
        self.state.controller = CONTROLLER_OTHER;
        self.state.robot = mode;
        self.state.tau_j_d = [0.0; ramp_robot::DOF];
    }

    /// Stops a motion with the error of this name. At rest an error is only kept.
    fn stop(&mut self, name: &str) {
        let known = std::mem::replace(&mut self.state.errors[index(name)], 1) == 1;
        self.state.reflex = [0; ERRORS];
        self.state.reflex[index(name)] = 1;
        let motion = match &self.doing {
            Doing::Move(motion) => Some((motion.command, motion.id)),
            _ => None,
        };
        if !known {
            self.say(&format!("the arm stopped: {name}"));
        }
        self.rest(Doing::Stopped, robot_mode::REFLEX);
        if let Some((command, id)) = motion {
            let aborted = status(self.options.version, MoveStatus::ReflexAborted);
            self.answer(command, id, &[aborted]);
        }
    }

    /// Answers a request of the arm's client.
    pub(crate) fn answer(&mut self, command: u32, id: u32, payload: &[u8]) {
        if let Some(client) = &mut self.client {
            client.answer(command, id, payload);
        }
    }

    /// One cycle: the command, a millisecond of the arm, and the next state.
    fn cycle(&mut self, command: Option<Commanded>) {
        let torques = self.obey(command);
        let recovered = self.recover();
        let begun = matches!(&self.doing, Doing::Move(motion) if motion.begun);
        let still = self.options.pace == Pace::LockStep && !begun && !self.gripper.is_busy();
        if !still {
            let begin = Instant::now();
            self.period(torques);
            self.statistics.longest = self.statistics.longest.max(begin.elapsed());
        }
        self.state.message += 1;
        // Before the arm's state: who has read that finds what the gripper reports.
        let count = if begun { self.periods } else { self.state.message };
        if count.is_multiple_of(REPORT_EVERY) {
            self.gripper.report(&self.plant, &self.gripper_states);
        }
        self.cell.deliver(&mut self.plant, self.state.message);
        if let Some(to) = self.client.as_ref().and_then(|client| client.states) {
            // A client that has gone is noticed by its connection.
            let _ = self.robot_states.send_to(&self.state.bytes(self.options.version), to);
        }
        // Whoever reads a state after the answer finds the arm ready.
        if let Some((command, id)) = recovered {
            self.answer(command, id, &[0]);
        }
    }

    /// The torques of this cycle; `None` at rest.
    fn obey(&mut self, command: Option<Commanded>) -> Option<[f64; ramp_robot::DOF]> {
        let received = self.state.tau_j_d;
        let Doing::Move(motion) = &mut self.doing else { return None };
        let came = command.is_some();
        let cycle = motion.next(command, &received);
        let (request, id) = (motion.command, motion.id);
        if motion.begun {
            self.statistics.cycles += 1;
            self.statistics.missed += u64::from(!came);
            self.state.success = motion.success_rate();
        }
        match cycle {
            Cycle::Waits => None,
            Cycle::Acts(torques) => Some(torques),
            Cycle::Ends => {
                self.rest(Doing::Rest, robot_mode::IDLE);
                self.answer(request, id, &[MoveStatus::Success.to_u8()]);
                None
            }
            Cycle::Stops(name) => {
                self.stop(name);
                None
            }
        }
    }

    /// Goes on with a recovery. Returns the request to answer when it has ended.
    fn recover(&mut self) -> Option<(u32, u32)> {
        let Doing::Recover { cycles, command, id } = &mut self.doing else { return None };
        *cycles = cycles.saturating_sub(1);
        if *cycles > 0 {
            return None;
        }
        let request = (*command, *id);
        self.state.errors = [0; ERRORS];
        self.state.robot = robot_mode::IDLE;
        self.doing = Doing::Rest;
        Some(request)
    }

    /// A millisecond of the arm.
    fn period(&mut self, torques: Option<[f64; ramp_robot::DOF]>) {
        let outcome = self.plant.step(torques.as_ref());
        self.periods += 1;
        self.cell.passed();
        for moment in self.plant.twin.moments() {
            self.referee.penetrated(&moment.truth, &moment.penetrations);
            self.referee.watch(&moment.truth, 0.0);
        }
        self.plant.tell(&mut self.state);
        if torques.is_some() {
            self.state.tau_j_d = self.plant.twin.joint_report().received;
        }
        if let Err(error) = outcome {
            self.stop(name_of(&error));
        } else if self.plant.twin.has_lost_the_line() {
            self.stop("communication_constraints_violation");
        } else {
            self.check_contact();
        }
        self.gripper.moved(&self.plant.seen());
    }

    /// Stops by reflex.
    fn check_contact(&mut self) {
        let beyond = |value: f64, most: f64| f64::from(value.abs() > most);
        self.state.joint_collision =
            std::array::from_fn(|joint| beyond(self.state.tau_ext[joint], self.most_torque[joint]));
        self.state.cartesian_collision =
            std::array::from_fn(|axis| beyond(self.state.o_f_ext[axis], self.most_force[axis]));
        if !matches!(self.doing, Doing::Move(_)) {
            return;
        }
        if self.state.cartesian_collision.contains(&1.0) {
            self.stop("cartesian_reflex");
        } else if self.state.joint_collision.contains(&1.0) {
            self.stop("joint_reflex");
        }
    }
}

/// Franka's name of an error.
fn name_of(error: &RobotError) -> &'static str {
    match error {
        RobotError::JointPosition { .. } => "joint_position_limits_violation",
        RobotError::JointVelocity { .. } => "joint_velocity_violation",
        RobotError::Reflex { unit: "N", .. } => "cartesian_reflex",
        RobotError::Reflex { .. } => "joint_reflex",
        _ => "instability_detected",
    }
}

fn begin_state(plant: &Plant) -> State {
    let f_t_ne = plant.f_t_tip();
    let hand = plant.end_effector();
    let mut i_ee = [0.0; 9];
    i_ee.copy_from_slice(hand.moment.as_slice());
    let mut state = State {
        message: 1,
        o_t_ee: IDENTITY,
        f_t_ee: f_t_ne,
        f_t_ne,
        ne_t_ee: IDENTITY,
        ee_t_k: IDENTITY,
        m_ee: hand.mass,
        f_x_cee: hand.centre.into(),
        i_ee,
        m_load: 0.0,
        f_x_cload: [0.0; 3],
        i_load: [0.0; 9],
        tau_j: [0.0; 7],
        tau_j_d: [0.0; 7],
        dtau_j: [0.0; 7],
        q: [0.0; 7],
        q_d: [0.0; 7],
        dq: [0.0; 7],
        tau_ext: [0.0; 7],
        o_f_ext: [0.0; 6],
        k_f_ext: [0.0; 6],
        joint_collision: [0.0; 7],
        cartesian_collision: [0.0; 6],
        motion: 0,
        controller: CONTROLLER_OTHER,
        robot: robot_mode::IDLE,
        errors: [0; ERRORS],
        reflex: [0; ERRORS],
        success: 0.0,
    };
    plant.tell(&mut state);
    state
}
