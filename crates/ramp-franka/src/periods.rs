//! The thread that keeps the arm's time, and what it shares with the agent's.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use ramp_control::ControllerSettings;
use ramp_robot::arm::ArmModel;
use ramp_robot::{Command, Observation, Pose, RobotError};

use crate::connection::{Connection, Pace, Statistics};
use crate::error::FrankaError;
use crate::gripper::Gripper;
use crate::link::Link;

/// Time that an agent which stepped in the last period has to step again. Chosen: half of a period; the rest
/// is for the torques to arrive in time.
const PATIENCE: Duration = Duration::from_micros(500);
/// Time after which a silent arm counts as dead: in real time, and in lock-step, where it may draw images.
const SILENCE: Duration = Duration::from_millis(150);
const SILENCE_IN_LOCK_STEP: Duration = Duration::from_secs(10);
/// States that are remembered for the time and the pose of images. Chosen: five seconds.
const REMEMBERED: usize = 5000;
/// Difference from a millisecond at which a state counts as missing, s.
const GAP: f64 = 1e-4;

/// The state that both threads share.
struct Slot {
    /// The newest command, until it is taken.
    command: Option<Command>,
    /// Periods to do without a command, in lock-step.
    waits: u64,
    /// What the arm reported last; `None` before the first time.
    seen: Option<Observation>,
    /// The last states: when each came, the arm's time then (s), and the tip in the world.
    past: VecDeque<(Instant, f64, Pose)>,
    /// Commands and waits that are done.
    done: u64,
    refused: Option<RobotError>,
    failed: Option<RobotError>,
    over: bool,
    first_message: u64,
    statistics: Statistics,
}

/// The agent's side.
pub(crate) struct Periods {
    shared: Arc<Shared>,
    pace: Pace,
    address: String,
    thread: Option<std::thread::JoinHandle<()>>,
}

struct Shared {
    slot: Mutex<Slot>,
    /// Something was commanded.
    commanded: Condvar,
    /// A period is done.
    done: Condvar,
}

impl Shared {
    /// A panic of the other thread leaves plain numbers that are whole.
    fn lock(&self) -> MutexGuard<'_, Slot> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Periods {
    /// Connects in a thread of its own, and waits for the first state.
    ///
    /// The client library sets real-time priority on the thread that connects, and threads started from it
    /// inherit that: so the connecting thread is the one that keeps the time.
    pub fn begin(
        connection: &Connection,
        arm: &ArmModel,
        settings: &ControllerSettings,
    ) -> Result<Periods, FrankaError> {
        let slot = Slot {
            command: None,
            waits: 0,
            seen: None,
            past: VecDeque::with_capacity(REMEMBERED),
            done: 0,
            refused: None,
            failed: None,
            over: false,
            first_message: 0,
            statistics: Statistics::default(),
        };
        let shared =
            Arc::new(Shared { slot: Mutex::new(slot), commanded: Condvar::new(), done: Condvar::new() });
        let (theirs, connection, arm) = (Arc::clone(&shared), connection.clone(), arm.clone());
        let (settings, pace, address) = (settings.clone(), connection.pace, connection.arm.clone());
        let thread = std::thread::spawn(move || {
            if let Err(error) = keep(&theirs, &connection, &arm, &settings) {
                theirs.lock().failed = Some(error.into());
            }
            theirs.done.notify_all();
        });
        let periods = Periods { shared, pace, address, thread: Some(thread) };
        let slot = periods.shared.lock();
        let slot = periods
            .shared
            .done
            .wait_while(slot, |slot| slot.seen.is_none() && slot.failed.is_none())
            .unwrap_or_else(PoisonError::into_inner);
        let failed = slot.failed.clone();
        drop(slot);
        match failed {
            Some(RobotError::Arm { what }) => Err(FrankaError::Arm(what)),
            Some(error) => Err(error.into()),
            None => Ok(periods),
        }
    }

    /// A period under a command.
    pub fn step(&self, command: &Command) -> Result<Observation, RobotError> {
        let mut slot = self.shared.lock();
        slot.command = Some(command.clone());
        self.wait_for(slot, 1)
    }

    /// In lock-step: so many periods under the last command.
    pub fn wait(&self, periods: u64) -> Result<Observation, RobotError> {
        let mut slot = self.shared.lock();
        slot.waits = periods;
        self.wait_for(slot, periods)
    }

    fn wait_for(&self, mut slot: MutexGuard<'_, Slot>, count: u64) -> Result<Observation, RobotError> {
        let until = slot.done + count;
        self.shared.commanded.notify_one();
        let silence = match self.pace {
            Pace::RealTime => SILENCE,
            Pace::LockStep => SILENCE_IN_LOCK_STEP,
        };
        let mut heard = Instant::now();
        loop {
            if let Some(error) = slot.failed.clone().or_else(|| slot.refused.take()) {
                return Err(error);
            }
            if slot.done >= until {
                return self.seen(&slot);
            }
            let before = slot.statistics.periods;
            slot = self.shared.done.wait_timeout(slot, silence).unwrap_or_else(PoisonError::into_inner).0;
            if slot.statistics.periods != before {
                heard = Instant::now();
            } else if heard.elapsed() >= silence {
                let seconds = silence.as_secs_f64();
                let error: RobotError = FrankaError::Silent { address: self.address.clone(), seconds }.into();
                slot.failed = Some(error.clone());
                return Err(error);
            }
        }
    }

    /// What the arm reported last.
    pub fn observe(&self) -> Result<Observation, RobotError> {
        self.seen(&self.shared.lock())
    }

    fn seen(&self, slot: &Slot) -> Result<Observation, RobotError> {
        slot.seen
            .clone()
            .ok_or_else(|| FrankaError::Silent { address: self.address.clone(), seconds: 0.0 }.into())
    }

    /// The arm's time (s) and the tip in the world at a moment of this computer, as far as it is remembered.
    pub fn at(&self, moment: Instant) -> Option<(f64, Pose)> {
        let slot = self.shared.lock();
        let next = slot.past.partition_point(|(came, ..)| *came < moment);
        // The state that came last before it, or the newest.
        let (_, time, x_wt) = slot.past.get(next.checked_sub(1)?)?;
        Some((*time, *x_wt))
    }

    /// How time passes.
    pub fn pace(&self) -> Pace {
        self.pace
    }

    /// The number of the arm's state with which the motion began.
    pub fn first_message(&self) -> u64 {
        self.shared.lock().first_message
    }

    /// Numbers of the connection so far.
    pub fn statistics(&self) -> Statistics {
        self.shared.lock().statistics
    }
}

impl Drop for Periods {
    fn drop(&mut self) {
        self.shared.lock().over = true;
        self.shared.commanded.notify_all();
        if let Some(thread) = self.thread.take() {
            // It reports its errors by the slot.
            let _ = thread.join();
        }
    }
}

/// The thread: one period after another until the agent is done.
fn keep(
    shared: &Shared,
    connection: &Connection,
    arm: &ArmModel,
    settings: &ControllerSettings,
) -> Result<(), FrankaError> {
    let robot = franka::Robot::new(&connection.arm, franka::RealtimeConfig::Ignore)?;
    let [force, torque] = [connection.reflex_force, connection.reflex_torque];
    robot.set_collision_behavior_simple([torque; 7], [torque; 7], [force; 6], [force; 6])?;
    let gripper = Gripper::connect(&connection.gripper)?;
    let patience = match connection.pace {
        Pace::RealTime => 1,
        Pace::LockStep => SILENCE_IN_LOCK_STEP.as_secs() as u32,
    };
    let mut link = Link::begin(&robot, gripper, arm, settings, patience)?;
    {
        let mut slot = shared.lock();
        slot.seen = Some(link.observe());
    }
    shared.done.notify_all();
    let mut expected = false;
    let mut row = 0;
    loop {
        let Some((command, waits)) = next(shared, connection.pace, expected) else { return link.end() };
        expected = command.is_some();
        let before = link.observe().time;
        let outcome = link.period(command.as_ref());
        let mut slot = shared.lock();
        match outcome {
            Err(FrankaError::Command(error)) => {
                slot.refused = Some(error);
                drop(slot);
                shared.done.notify_all();
                continue;
            }
            Err(error) => return Err(error),
            Ok(()) => {}
        }
        let seen = link.observe();
        row = if command.is_some() || waits { 0 } else { row + 1 };
        slot.first_message = link.first_message();
        let statistics = &mut slot.statistics;
        statistics.periods += 1;
        statistics.late += u64::from(row > 0);
        statistics.longest = statistics.longest.max(row);
        statistics.gaps += u64::from((seen.time - before - ramp_robot::PERIOD).abs() > GAP);
        slot.done += u64::from(command.is_some() || waits);
        if slot.past.len() == REMEMBERED {
            slot.past.pop_front();
        }
        slot.past.push_back((Instant::now(), seen.time, seen.x_wt));
        slot.seen = Some(seen);
        drop(slot);
        shared.done.notify_all();
    }
}

/// The next command, and whether a period without one was asked for; `None` when the agent is done.
fn next(shared: &Shared, pace: Pace, expected: bool) -> Option<(Option<Command>, bool)> {
    let idle = |slot: &mut Slot| slot.command.is_none() && slot.waits == 0 && !slot.over;
    let slot = shared.lock();
    let mut slot = match pace {
        Pace::LockStep => shared.commanded.wait_while(slot, idle).unwrap_or_else(PoisonError::into_inner),
        // An agent that has just stepped is likely to step again at once. One that thinks is not waited for.
        Pace::RealTime if expected => {
            let waited = shared.commanded.wait_timeout_while(slot, PATIENCE, idle);
            waited.unwrap_or_else(PoisonError::into_inner).0
        }
        Pace::RealTime => slot,
    };
    if slot.over {
        return None;
    }
    let command = slot.command.take();
    let waits = command.is_none() && slot.waits > 0;
    slot.waits -= u64::from(waits);
    Some((command, waits))
}
